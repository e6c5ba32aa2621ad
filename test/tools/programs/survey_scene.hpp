// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_SURVEY_SCENE_HPP
#define REFRACT_TEST_SURVEY_SCENE_HPP

#include "run_tool.hpp"
#include "scenes.hpp"
#include <catch2/catch.hpp>
#include <opencv2/calib3d.hpp>
#include <cmath>
#include <map>

/* A camera, or two, that moved over a relief behind flat ports in water, what COLMAP makes of it, and what refract_bundle reads of it. */
namespace survey_scene {

using namespace cv;
using namespace cv::refract;

const Size SIZE(640, 480);
const Vec3d FAR(5000, 70000, -300);             // survey coordinates of positions.csv
const double SIGMA = 0.3, POSITION_STD = 5, BASE = 90;

struct Image
{
    std::string name;
    int camera;
    Matx33d R;                                  // scene -> camera
    Vec3d t;
    std::vector<std::pair<Point2d, int>> pixels;
};

inline Matx33d matrixOf(const Vec3d& rvec)
{
    Matx33d R;
    Rodrigues(rvec, R);
    return R;
}

inline std::string numbers(const std::vector<double>& list)
{
    std::string text;
    for (double x : list)
        text += format(" %.17g", x);
    return text;
}

//! One camera, two or three beside each other, over a relief; and what COLMAP makes of it: bent, smaller, turned.
struct Network
{
    //! @param lost a view that COLMAP registered wrongly; -1: none. @param window its size
    explicit Network(unsigned salt, int cameras = 1, double wrong = 0., int lost = -1, double window = 1.) : random(salt)
    {
        const Matx33d K(800, 0, 319.5, 0, 800, 239.5, 0, 0, 1);
        for (int c = 0; c < cameras; c++)
        {
            GlassWindow thought(Vec3d(0.03 - 0.05*c, -0.02, 1), 10*window, 1.49, 40*window, 1.333), real = thought;
            real.normal = normalize(real.normal + Vec3d(random.normal(0.02), random.normal(0.02), 0));
            real.distance += random.normal(1)*window;
            real.thickness[0] += random.normal(0.1)*window;
            real.index[0] += random.normal(0.001);
            real.outerIndex += random.normal(0.001);
            real.wedge = {Vec2d(random.normal(CV_PI/10800), random.normal(CV_PI/10800))};
            truth.push_back(RefractiveCamera::create(K, noArray(), real));
            start.push_back(RefractiveCamera::create(K, noArray(), thought));
            truth.back()->setImageSize(SIZE);
            start.back()->setImageSize(SIZE);
            Rs.push_back(Mat(Matx33d(matrixOf(Vec3d(0.01, 0.04, -0.02)*c)), true));
            Ts.push_back(Mat(Vec3d(-BASE*c, 2*c, 3*c), true));
        }
        for (int i = 0; i < 420; i++)
            points.push_back({random.uniform(-460, 460), random.uniform(-330, 330), random.uniform(-40, 40)});
        for (int view = 0; view < 18; view++)
            look(view, view == lost ? 1. : wrong);
    }

    void look(int view, double wrong)
    {
        const int row = view/6;
        const Vec3d centre(-375 + 150*(view % 6) + random.normal(15), -200 + 200*row + random.normal(15), -600 + random.normal(15));
        const Matx33d R = matrixOf(Vec3d(random.normal(0.12), random.normal(0.12), random.normal(0.12)))
            *matrixOf(Vec3d(0, 0, row == 1 ? 2 : 0));
        centres.push_back(centre);
        for (size_t c = 0; c < truth.size(); c++)
        {
            static const char* const NAMES[] = {"left", "right", "third"};
            Image image = {format("%s/%03d.png", NAMES[c], view), (int)c, Matx33d(Rs[c].ptr<double>())*R, {}, {}};
            image.t = Matx33d(Rs[c].ptr<double>())*(-(R*centre)) + Vec3d(Ts[c].ptr<double>());
            std::vector<Point2d> pixels;
            Vec3d rvec;
            Rodrigues(image.R, rvec);
            refractiveProjectPoints(points, rvec, image.t, truth[c], pixels);
            for (size_t i = 0; i < pixels.size(); i++)
            {
                const bool isWrong = random.uniform(0, 1) < wrong;
                const double off = isWrong ? 15 : SIGMA;
                const Point2d pixel = pixels[i] + Point2d(random.normal(off), random.normal(off));
                if (pixel.x > 0 && pixel.y > 0 && pixel.x < SIZE.width - 1 && pixel.y < SIZE.height - 1)
                {
                    image.pixels.push_back({pixel, (int)i});
                    good += !isWrong;
                }
            }
            images.push_back(image);
        }
    }

    //! Text; a point of id i + 1 where at least two images show it.
    void write(const TemporaryFolder& f)
    {
        const double scale = 1/137.;
        const Matx33d A = matrixOf(Vec3d(0.3, -0.5, 0.8));
        writeRig(f / "calib.yml", start, Rs, Ts);
        std::filesystem::create_directory(f.path()/"sparse");
        std::vector<std::string> tracks(points.size());
        std::vector<int> counts(points.size(), 0);
        for (const Image& image : images)
            for (const auto& pixel : image.pixels)
                counts[pixel.second]++;
        std::string text, cameras;
        for (size_t c = 0; c < truth.size(); c++)
            cameras += format("%d SIMPLE_RADIAL 640 480 1064 320 240 0.02\n", (int)c + 1);
        for (size_t k = 0; k < images.size(); k++)
        {
            const Image& image = images[k];
            const Vec3d centre = image.R.t()*(-image.t) + Vec3d(random.normal(4), random.normal(4), random.normal(4));
            const Matx33d R = matrixOf(Vec3d(random.normal(0.01), random.normal(0.01), random.normal(0.01)))*image.R*A.t();
            const Vec3d t = -(R*(A*centre*scale));
            Vec3d rvec;
            Rodrigues(R, rvec);
            const double angle = norm(rvec), part = std::sin(angle/2)/angle;
            text += format("%d", (int)k + 1) + numbers({std::cos(angle/2), part*rvec[0], part*rvec[1], part*rvec[2], t[0], t[1], t[2]})
                + format(" %d ", image.camera + 1) + image.name + "\n";
            for (size_t i = 0; i < image.pixels.size(); i++)
            {
                const Point2d p = image.pixels[i].first;
                const int point = image.pixels[i].second;
                text += format("%.6f %.6f %d ", p.x + 0.5, p.y + 0.5, counts[point] > 1 ? point + 1 : -1);
                tracks[point] += format(" %d %d", (int)k + 1, (int)i);
            }
            text += "\n";
        }
        std::string ofPoints;
        for (size_t i = 0; i < points.size(); i++)
        {
            const Point3d& X = points[i];
            const Vec3d bent(X.x + random.normal(1), X.y + random.normal(1), X.z + 2e-5*(X.x*X.x + X.y*X.y) + random.normal(1));
            const Vec3d there = A*bent*scale;
            if (counts[i] > 1)
                ofPoints += format("%d", (int)i + 1) + numbers({there[0], there[1], there[2]}) + " 9 9 9 0.5" + tracks[i] + "\n";
        }
        writeFile(f / "sparse/cameras.txt", cameras);
        writeFile(f / "sparse/images.txt", text);
        writeFile(f / "sparse/points3D.txt", ofPoints);
        writeTables(f, counts);
    }

    void writeTables(const TemporaryFolder& f, const std::vector<int>& counts)
    {
        std::string lengths = "id1,id2,length,std\n", positions = "image,x,y,z,std\n";
        std::vector<int> seen;
        for (size_t i = 0; i < points.size(); i++)
            if (counts[i] > 2)
                seen.push_back((int)i);
        for (size_t k = 0; k + 1 < seen.size() && k < 12; k += 2)
            lengths += format("%d,%d,%.6f,0.5\n", seen[k] + 1, seen[k + 1] + 1, norm(points[seen[k]] - points[seen[k + 1]])
                              + random.normal(0.5));
        for (size_t view = 0; view < centres.size(); view++)
        {
            const Vec3d off(random.normal(POSITION_STD), random.normal(POSITION_STD), random.normal(POSITION_STD));
            const Vec3d c = centres[view] + FAR + off;
            positions += format("left/%03d.png,%.6f,%.6f,%.6f,%g\n", (int)view, c[0], c[1], c[2], POSITION_STD);
        }
        writeFile(f / "lengths.csv", lengths);
        writeFile(f / "positions.csv", positions);
    }

    scenes::Random random;
    std::vector<Ptr<RefractiveCamera>> truth, start;
    std::vector<Mat> Rs, Ts;
    std::vector<Point3d> points;
    std::vector<Vec3d> centres;
    std::vector<Image> images;
    int good = 0;
};

inline ToolResult survey(const TemporaryFolder& f, const std::string& options, const std::string& model = "sparse")
{
    return runTool("refract_bundle " + f / "calib.yml" + " --colmap=" + f / model + " --out=" + f / "again.yml" + " --points-out="
                   + f / "points.csv" + " --poses-out=" + f / "poses.csv" + " --summary=" + f / "summary.json" + " " + options);
}

//! By the first cell: all numbers after it.
inline std::map<std::string, std::vector<double>> tableOf(const std::string& file)
{
    std::map<std::string, std::vector<double>> table;
    std::istringstream in(readFile(file));
    std::string line, cell, name;
    std::getline(in, line);
    while (std::getline(in, line))
    {
        std::istringstream cells(line);
        std::getline(cells, name, ',');
        while (std::getline(cells, cell, ','))
            table[name].push_back(std::atof(cell.c_str()));
    }
    return table;
}

//! Errors over their stated standard deviations.
struct Ratio
{
    void add(double error, double std)
    {
        squares += error*error/(std*std);
        count++;
    }
    double value() const { return std::sqrt(squares/count); }
    double squares = 0;
    int count = 0;
};

inline void addErrors(const Network& network, const TemporaryFolder& f, Ratio& ofPoints, Ratio& ofPoses)
{
    for (const auto& row : tableOf(f / "points.csv"))
    {
        const std::vector<double>& n = row.second;
        const Vec3d error = Vec3d(n[0], n[1], n[2]) - FAR - Vec3d(network.points[std::atoi(row.first.c_str()) - 1]);
        for (int k = 0; k < 3 && n[8] == 0; k++)
            ofPoints.add(error[k], n[3 + k]);
    }
    for (const auto& row : tableOf(f / "poses.csv"))
    {
        const size_t at = row.first.find('/');
        const Vec3d truth = network.centres[std::atoi(row.first.substr(at == std::string::npos ? 0 : at + 1).c_str())];
        for (int k = 0; k < 3; k++)
            ofPoses.add(row.second[12 + k] - FAR[k] - truth[k], row.second[15 + k]);
    }
}

} // namespace survey_scene

#endif // REFRACT_TEST_SURVEY_SCENE_HPP
