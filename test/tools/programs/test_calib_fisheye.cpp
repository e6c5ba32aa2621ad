// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_calib --lens=fisheye as a user runs it: a wide lens that the images determine, behind a pane in air and in water.
#include "run_tool.hpp"
#include "scenes.hpp"
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <cmath>
#include <iostream>

using namespace cv;
using namespace cv::refract;

namespace {

const double SIGMA = 0.05, SQUARE = 25.;
const Size IMAGE(1280, 1024), BOARD(9, 6);

struct WideCamera
{
    Ptr<RefractiveCamera> through, bare;

    //! @param focal in pixels: 450 sees 170 degrees across the diagonal
    WideCamera(double focal, double outerIndex)
    {
        const Matx33d K(focal, 0, 645.3, 0, focal*1.001, 508.7, 0, 0, 1);
        const Vec4d bend(0.031, -0.0065, 0.0012, -0.0003);
        const GlassWindow window(normalize(Vec3d(0.06, -0.04, 1)), 15., 1.52, 20., outerIndex);
        through = RefractiveCamera::createFisheye(K, bend, window);
        bare = RefractiveCamera::createFisheye(K, bend);
    }
};

std::vector<Point3d> board()
{
    std::vector<Point3d> points;
    for (int row = 0; row < BOARD.height; row++)
        for (int column = 0; column < BOARD.width; column++)
            points.emplace_back(SQUARE*column, SQUARE*row, 0);
    return points;
}

//! All of the board in the image, or nothing.
std::vector<Point2d> see(const Ptr<RefractiveCamera>& camera, const Vec3d& rvec, const Vec3d& tvec)
{
    std::vector<Point2d> pixels;
    refractiveProjectPoints(board(), rvec, tvec, camera, pixels);
    for (const Point2d& p : pixels)
        if (!Rect2d(5, 5, IMAGE.width - 10, IMAGE.height - 10).contains(p))        // NaN is in no image
            return {};
    return pixels;
}

void writeView(std::ostream& out, const std::string& name, const std::vector<Point2d>& pixels, scenes::Random& random)
{
    const std::vector<Point3d> points = board();
    for (size_t i = 0; i < points.size(); i++)
        out << format("%s,%g,%g,0,%.5f,%.5f\n", name.c_str(), points[i].x, points[i].y, pixels[i].x + random.normal(SIGMA),
                      pixels[i].y + random.normal(SIGMA));
}

//! direct.csv and glass.csv: boards all over the image, square to the line of sight within 35 degrees.
void writeViews(const WideCamera& camera, const TemporaryFolder& folder, int directs, int pairs, scenes::Random& random)
{
    std::ofstream direct(folder / "direct.csv"), glass(folder / "glass.csv");
    for (std::ofstream* file : {&direct, &glass})
        *file << "view,x,y,z,u,v\n";
    for (int view = 0; view < directs; )
    {
        const double angle = random.uniform(0, 70)*CV_PI/180, round = random.uniform(0, 2*CV_PI);
        const Vec3d sight(std::sin(angle)*std::cos(round), std::sin(angle)*std::sin(round), std::cos(angle));
        const Vec3d axis(-std::sin(round), std::cos(round), 0);
        Matx33d face, tilt, R;
        Rodrigues(angle*axis, face);
        Rodrigues(0.6*random.vector(1.), tilt);
        R = face*tilt;
        Vec3d rvec;
        Rodrigues(R, rvec);
        const Vec3d middle(0.5*SQUARE*(BOARD.width - 1), 0.5*SQUARE*(BOARD.height - 1), 0);
        const Vec3d tvec = random.uniform(220, 450)*sight - R*middle;
        const std::vector<Point2d> without = see(camera.bare, rvec, tvec), with = see(camera.through, rvec, tvec);
        if (without.empty() || with.empty())
            continue;
        const std::string name = format("v%02d", view);
        writeView(direct, name, without, random);
        if (view < pairs)
            writeView(glass, name, with, random);
        view++;
    }
}

} // namespace

TEST_CASE("refract_calib finds a fisheye lens and its window, and how well", "[tools][calib][fisheye]")
{
    scenes::Random random;
    for (const double outerIndex : {1., 1.333})
        for (const double focal : {300., 450., 900.})
        {
            const TemporaryFolder folder;
            const WideCamera camera(focal, outerIndex);
            writeViews(camera, folder, 16, 4, random);
            const ToolResult result = runTool("refract_calib --lens=fisheye --image-size=1280x1024 --thickness=15 --index=1.52 --exact"
                + format(" --outer-index=%g", outerIndex) + " --direct=" + (folder / "direct.csv") + " --glass=" + (folder / "glass.csv")
                + " --summary=" + (folder / "s.json") + " --out=" + (folder / "calib.yml"));
            CAPTURE(outerIndex, focal, result.out, result.err);
            REQUIRE(result.code == 0);
            const auto found = RefractiveCamera::read(folder / "calib.yml");
            REQUIRE(found->lensModel() == "fisheye");
            const FileStorage file(folder / "calib.yml", FileStorage::READ);
            CHECK((double)file["rms"] < 1.2*SIGMA*std::sqrt(2.));

            Mat covariance;
            file["covariance"] >> covariance;
            const Mat error = found->lensParameters() - camera.through->lensParameters();
            REQUIRE(covariance.rows > error.rows);
            const Mat ofLens = covariance(Rect(0, 0, error.rows, error.rows));
            const double chi2 = Mat(error.t()*ofLens.inv(DECOMP_SVD)*error).at<double>(0);
            CHECK(chi2 > 0.5);                      // of 8: 1 in 10000 each way
            CHECK(chi2 < 32);
            CHECK(std::sqrt(ofLens.at<double>(0, 0)) < 0.5);

            const auto summary = nlohmann::json::parse(readFile(folder / "s.json"));
            const auto std = summary["cameras"][0]["window"]["normal_std_deg"].get<std::vector<double>>();
            const Vec3d a = found->window().normal, b = camera.through->window().normal;
            const double degrees = std::atan2(norm(a.cross(b)), a.dot(b))*180/CV_PI;
            CHECK(degrees < 4*std::max(std[0], std[1]));
            CHECK(std::max(std[0], std[1]) < 0.2);
            CHECK(summary["cameras"][0]["lens"]["model"] == "fisheye");
            std::cout << "[numbers] fisheye of " << focal << " px, index outside " << outerIndex << ": lens chi2 " << chi2
                      << " of 8, normal off by " << degrees << ", stated " << std::max(std[0], std[1]) << " deg\n";
        }
}

TEST_CASE("A fisheye lens needs flat targets to start from", "[tools][calib][fisheye]")
{
    const TemporaryFolder folder;
    for (const std::string name : {"direct", "glass"})
    {
        std::ofstream out(folder / (name + ".csv"));
        out << "view,x,y,z,u,v\n";
        for (int view = 0; view < 3; view++)
            for (int i = 0; i < 27; i++)
                out << view << "," << 10*(i % 3) << "," << 10*(i/3 % 3) << "," << 10*(i/9) << "," << 500 + 40*(i % 3) + 7*(i/9) + view
                    << "," << 400 + 40*(i/3 % 3) + 3*(i/9) + (name == "glass") << "\n";
    }
    const ToolResult result = runTool("refract_calib --lens=fisheye --image-size=1280x1024 --thickness=15 --index=1.52 --direct="
                                      + (folder / "direct.csv") + " --glass=" + (folder / "glass.csv") + " --out=" + (folder / "c.yml"));
    CHECK(result.code == 1);
    CAPTURE(result.err);
    CHECK(mentions(result.err, "flat targets"));
}
