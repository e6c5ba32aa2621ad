// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Files of programs that know windows: rays as these programs trace them, by planes and spheres of their own frames.
#include "formats/foreign_files.hpp"

using cv::Point2d;
using cv::Vec3d;
using tools::ForeignRig;
using tools::readForeignRig;

namespace {

//! Directions all over an image, by x and y in the plane z = 1.
std::vector<Point2d> directions()
{
    std::vector<Point2d> all;
    for (double x = -0.3; x < 0.31; x += 0.1)
        for (double y = -0.2; y < 0.21; y += 0.1)
            all.push_back({x, y});
    return all;
}

Point2d seenBy(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const Vec3d& X)
{
    std::vector<Point2d> pixel;
    cv::refract::refractiveProjectPoints(std::vector<cv::Point3d>{X}, Vec3d(), Vec3d(), camera, pixel);
    return pixel[0];
}

//! A ray from inside through a sphere about S.
void refractAtSphere(const Vec3d& S, double radius, double before, double after, Vec3d& origin, Vec3d& direction)
{
    direction /= norm(direction);
    const Vec3d o = origin - S;
    const double b = o.dot(direction), along = -b + std::sqrt(b*b - o.dot(o) + radius*radius);
    const Vec3d n = (o + direction*along)/radius;
    refractAt(n, n.dot(origin + direction*along), before, after, origin, direction);
}

const std::string LENS = "model: OPENCV\n# fx, fy, cx, cy, k1, k2, p1, p2\nparameters: [1000, 900, 640, 480, -0.1, 0.05, 0.001, -0.002]\n";

//! What Calibmar computes, whose pixel (0, 0) is a corner.
void requireCalibmar(const ForeignRig& rig, const std::function<void(Vec3d& origin, Vec3d& direction)>& trace)
{
    REQUIRE(rig.cameras.size() == 1);
    for (const Point2d& d : directions())
    {
        const Point2d p = brown(-0.1, 0.05, 0.001, -0.002)(d.x, d.y);
        Vec3d origin, direction(d.x, d.y, 1);
        trace(origin, direction);
        CHECK(norm(seenBy(rig.cameras[0], origin + direction*777.) - Point2d(1000*p.x + 639.5, 900*p.y + 479.5)) < SAME);
    }
}

} // namespace

TEST_CASE("Calibmar's flat and dome ports are read, and those of COLMAP for cameras under water", "[foreign]")
{
    TemporaryFolder f;
    const Vec3d n = normalize(Vec3d(0.05, -0.03, 1)), S(1, -2, 3);
    const auto flat = [&](Vec3d& origin, Vec3d& direction) {
        refractAt(n, 20, 1.0003, 1.52, origin, direction);
        refractAt(n, 30, 1.52, 1.333, origin, direction);
    };
    const auto dome = [&](Vec3d& origin, Vec3d& direction) {
        refractAtSphere(S, 50, 1.0003, 1.49, origin, direction);
        refractAtSphere(S, 57, 1.49, 1.333, origin, direction);
    };
    const std::string flatPort = cv::format("%.17g, %.17g, %.17g, 20, 10, 1.0003, 1.52, 1.333", n[0], n[1], n[2]),
                      domePort = "1, -2, 3, 50, 7, 1.0003, 1.49, 1.333", size = "width: 1280\nheight: 960\n";
    requireCalibmar(rigOf(f, LENS + "non_svp_model: FLATPORT\nnon_svp_parameters: [" + flatPort + "]\n" + size), flat);
    requireCalibmar(rigOf(f, LENS + "non_svp_model: DOMEPORT\nnon_svp_parameters: [" + domePort + "]\n" + size), dome);
    requireCalibmar(rigOf(f, LENS + size + "non_svp_camera:\n  type: flatport\n  parameters: [" + flatPort + "]\n"), flat);
    requireCalibmar(rigOf(f, LENS + "non_svp_model: NONE\nnon_svp_parameters: []\n" + size), [](Vec3d&, Vec3d&) {});
    std::string words = flatPort;
    words.erase(std::remove(words.begin(), words.end(), ','), words.end());
    requireCalibmar(rigOf(f, "1 OPENCV 1280 960 1000 900 640 480 -0.1 0.05 0.001 -0.002 FLATPORT " + words + "\n"), flat);
    CHECK_THAT(refusal(saved(f, "x", LENS + "non_svp_model: FLATPORT\nnon_svp_parameters: [0, 0, 1]\n")),
               Catch::Contains("looks like Calibmar's calibration, but a port has 8 parameters, here are 3"));
    CHECK_THAT(refusal(saved(f, "x", LENS + "non_svp_model: CYLINDER\nnon_svp_parameters: [0]\n")),
               Catch::Contains("its port 'CYLINDER' is not known"));
}

TEST_CASE("OpenPTV's cameras are read, with their glass", "[foreign]")
{
    TemporaryFolder f;
    const cv::Matx33d dm = [] { cv::Matx33d R; cv::Rodrigues(Vec3d(0.1, -0.2, 0.3), R); return R; }();
    const Vec3d X0(40, -30, 600), glass(3, -4, 120);
    const double c = 60, xh = 0.4, yh = -0.2, pix = 0.012, n2 = 1.46, n3 = 1.33, d = 6, imx = 1280, imy = 1024;
    const auto ori = [&](double x, double y) {
        std::string text = cv::format("%.17g %.17g %.17g\n 0.1 0.2 0.3\n\n", X0[0], X0[1], X0[2]);
        for (int i = 0; i < 9; i++)
            text += cv::format("%.17g ", dm.val[i]);
        return text + cv::format("\n\n%.17g %.17g\n%.17g\n\n%.17g %.17g %.17g\n", x, y, c, glass[0], glass[1], glass[2]);
    };
    saved(f, "ptv.par", "1\nimg/cam1\ncal/cam1.tif\n1\n0\n1\n1280\n1024\n0.012\n0.012\n0\n1\n1.46\n1.33\n6\n");
    // By its formula: where q = dm^T (X - X0) is seen, in mm, then in pixels from the corner of the first.
    const auto requireSeen = [&](const ForeignRig& rig, double x0, double y0, double scale, const std::function<Point2d(double,
        double)>& distorted) {
        const Vec3d up = glass/norm(glass);
        for (const Point2d& at : directions())
        {
            const Point2d mm = distorted(-c*at.x/-1 + x0, -c*at.y/-1 + y0);
            Vec3d origin = X0, direction = dm*Vec3d(at.x, at.y, -1);
            refractAt(-up, -norm(glass) - d, 1, n2, origin, direction);
            refractAt(-up, -norm(glass), n2, n3, origin, direction);
            const Point2d theirs(scale*mm.x/pix + imx/2, imy/2 - mm.y/pix);
            // The frame of the camera that was read: x the same, y and z turned round.
            const Vec3d q = dm.t()*(origin + direction*300. - X0);
            CHECK(norm(seenBy(rig.cameras.at(0), Vec3d(q[0], -q[1], -q[2])) - (theirs - Point2d(0.5, 0.5))) < SAME);
        }
    };
    saved(f, "cam1.tif.addpar", "0 0 0 0 0 1.001 0\n");
    requireSeen(rigOf(f, ori(xh, yh), "cam1.tif.ori"), xh, yh, 1.001, [](double x, double y) { return Point2d(x, y); });
    saved(f, "cam1.tif.addpar", "1e-4 -2e-7 3e-10 0 2e-5 1.001 0\n");
    requireSeen(rigOf(f, ori(0, 0), "cam1.tif.ori"), 0, 0, 1.001, [](double x, double y) {
        const double r = std::hypot(x, y), bend = 1e-4*r*r - 2e-7*std::pow(r, 4) + 3e-10*std::pow(r, 6), p2 = 2e-5;
        return Point2d(x + x*bend + 2*p2*x*y, y + y*bend + p2*(r*r + 2*y*y));
    });
    CHECK_THAT(refusal(saved(f, "cam1.tif.ori", ori(xh, yh))), Catch::Contains("its principal point (xh, yh) is elsewhere"));
    saved(f, "cam1.tif.addpar", "0 0 0 0 0 1 0.01\n");
    CHECK_THAT(refusal(f/"cam1.tif.ori"), Catch::Contains("a shear (she)"));
    CHECK_THAT(refusal(saved(f, "cam1.tif.ori", ori(0, 0).substr(0, 200))), Catch::Contains("must have 18 numbers"));
    CHECK_THAT(refusal(saved(f, "cam2.tif.ori", ori(0, 0))), Catch::Contains("put 'cam2.tif.addpar' beside it"));
    std::filesystem::remove(f/"ptv.par");
    saved(f, "cam1.tif.addpar", "0 0 0 0 0 1 0\n");
    CHECK_THAT(refusal(saved(f, "cam1.tif.ori", ori(0, 0))), Catch::Contains("put ptv.par"));
}

TEST_CASE("A numbered name is that of all cameras of a program that has a file for each", "[foreign]")
{
    TemporaryFolder f;
    saved(f, "ptv.par", "2\nimg/cam1\ncal/cam1.tif\nimg/cam2\ncal/cam2.tif\n1\n0\n1\n1280\n1024\n0.012\n0.012\n0\n1\n1.46\n1.33\n6\n");
    for (int k : {1, 2})
    {
        saved(f, cv::format("cam%d.addpar", k), "0 0 0 0 0 1 0\n");
        saved(f, cv::format("cam%d.ori", k), cv::format("%d 0 600\n0 0 0\n1 0 0 0 1 0 0 0 1\n0 0\n60\n", 100*k));
    }
    const auto rig = readForeignRig(f/"cam%d.ori");
    REQUIRE(rig);
    REQUIRE(rig->cameras.size() == 2);
    CHECK(cv::norm(rig->Ts[1], cv::Mat(Vec3d(-100, 0, 0))) < 1e-12);
}

TEST_CASE("OpenLPT's cameras are read, behind a plate and not, also where y points up", "[foreign]")
{
    TemporaryFolder f;
    const cv::Matx33d R = [] { cv::Matx33d r; cv::Rodrigues(Vec3d(0.1, 2.2, -0.3), r); return r; }();
    const Vec3d t(5, -3, 400), n = R.t()*normalize(Vec3d(0.05, 0.02, 1)), centre = -(R.t()*t), face = centre + n*250. + R.t()*Vec3d(20,
                                                                                                                                    -1, 0);
    const double farthest = n.dot(face), w = 12.7;
    for (double fy : {-1900., 1900.})
        for (bool plate : {true, false})
        {
            std::string text = std::string("# Camera Model: (PINHOLE/POLYNOMIAL)\n") + (plate ? "PINPLATE" : "PINHOLE")
                + "\n# Camera Calibration "
                "Error: \nNone\n# Image Size: (n_row,n_col)\n1024,1280\n# Camera Matrix: \n"
                    + cv::format("2000,0.0,639.5\n0.0,%g,511.5\n0,0,1\n", fy)
                + "# Distortion Coefficients: \n-0.1,0.05,0.001,-0.002,0.01\n# Rotation Matrix: \n";
            for (int i = 0; i < 9; i++)
                text += cv::format(i % 3 == 2 ? "%.17g\n" : "%.17g,", R.val[i]);
            text += "# Translation Vector: \n5,-3,400\n";
            if (plate)
                text += cv::format("# Reference Point of Refractive Plate: \n%.17g,%.17g,%.17g\n# Normal Vector of Refractive Plate: \n"
                                   "%.17g,%.17g,%.17g\n", face[0], face[1], face[2], n[0], n[1], n[2])
                      + "# Refractive Index Array: \n1.33,1.49,1.0\n# Width of the Refractive Plate: (mm)\n12.7\n"
                        "# Projection Tolerance: \n1e-8\n";
            const ForeignRig rig = rigOf(f, text);
            CHECK(rig.cameras.at(0)->imageSize() == cv::Size(1280, 1024));
            const double up = fy < 0 ? -1 : 1;
            for (const Point2d& at : directions())
            {
                const Point2d p = brown(-0.1, 0.05, 0.001, -0.002, 0.01)(at.x, at.y);
                Vec3d origin = centre, direction = R.t()*Vec3d(at.x, at.y, 1);
                if (plate)
                {
                    refractAt(n, farthest - w, 1, 1.49, origin, direction);
                    refractAt(n, farthest, 1.49, 1.33, origin, direction);
                }
                const Vec3d q = R*(origin + direction*300.) + t;
                CHECK(norm(seenBy(rig.cameras[0], Vec3d(q[0], up*q[1], q[2])) - Point2d(2000*p.x + 639.5, fy*p.y + 511.5)) < SAME);
            }
        }
    CHECK_THAT(refusal(saved(f, "x", "# Camera Model: (PINHOLE/POLYNOMIAL)\nPOLYNOMIAL\n")),
               Catch::Contains("its model POLYNOMIAL has no equal"));
    CHECK_THAT(refusal(saved(f, "x", "# Camera Model: (PINHOLE/POLYNOMIAL)\nPINPLATE\n# Image Size: (n_row,n_col)\n1024,1024\n")),
               Catch::Contains("looks like OpenLPT's camera, but '# Camera Matrix:' is missing"));
}
