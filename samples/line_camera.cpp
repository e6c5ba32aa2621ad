// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A line camera behind a window, and a target that a belt carries past it. Its v is 0, always; a mark is seen at the moment when it
// crosses the line, so where the belt was then (its encoder) goes into the mark's position, and the encoder's error into the covariance
// of v. Of bars across the belt the line tells the moment and no u: (NaN, 0). The pose of the camera to the belt comes of all of them.
//
//   line_camera [--seed=1]

#include <opencv2/calib3d.hpp>
#include <opencv2/refract.hpp>
#include <iostream>
#include <limits>

using namespace cv;
using namespace cv::refract;

static const Vec3d BELT(0, 1, 0);           // its motion in the target's frame, mm per step of the encoder

//! How far the belt has moved when the camera sees a mark.
static double crossing(const Ptr<RefractiveCamera>& camera, const Vec3d& rvec, const Vec3d& tvec, const Vec3d& mark, Point2d& pixel)
{
    double low = -400, high = 400;
    for (int i = 0; i < 60; i++)
    {
        const double middle = 0.5*(low + high);
        std::vector<Point2d> pixels;
        refractiveProjectPoints(std::vector<Vec3d>(1, mark + middle*BELT), rvec, tvec, camera, pixels);
        pixel = pixels[0];
        (pixel.y > 0 ? high : low) = middle;
    }
    return low;
}

static double angle(const Vec3d& a, const Vec3d& b)
{
    Mat R, S;
    Vec3d difference;
    Rodrigues(a, R);
    Rodrigues(b, S);
    Rodrigues(Mat(R*S.t()), difference);
    return norm(difference)*180/CV_PI;
}

int main(int argc, char** argv)
{
    const CommandLineParser args(argc, argv, "{seed | 1 | of the noise}");
    const uint64 seed = 7654321*(uint64)args.get<int>("seed");      // small numbers start the generator alike
    const GlassWindow window(Vec3d(0.1, 0.2, 1), 12, 1.52, 60, 1.333);
    // 2048 pixels in a line: v = 0 is it.
    const Matx33d K(2500, 0, 1024, 0, 2500, 0, 0, 0, 1);
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, std::vector<double>{-0.1, 0.03, 0, 0}, window);
    const Vec3d rvec(0.05, -0.08, 0.03), tvec(-20, -15, 620);       // belt -> camera

    // Marks on three levels of the target, and bars; noise of u 0.1 px, of the encoder 0.05 mm, and 0.5 mm where the belt was fast.
    const double U_NOISE = 0.1, MM_PER_PIXEL = 0.2, NaN = std::numeric_limits<double>::quiet_NaN();
    RNG rng(seed);
    std::vector<Vec3d> marks;
    std::vector<Point2d> pixels;
    std::vector<Vec3d> covariances;             // uu, uv, vv
    for (int i = 0; i < 90; i++)
    {
        const Vec3d mark(rng.uniform(-120., 120.), rng.uniform(-80., 80.), 30.*(i % 3));
        Point2d pixel;
        const double moved = crossing(camera, rvec, tvec, mark, pixel);
        const bool isBar = i % 5 == 0;
        const double encoder = i % 2 ? 0.05 : 0.5;
        marks.push_back(mark + (moved + rng.gaussian(encoder))*BELT);
        pixels.push_back(Point2d(isBar ? NaN : pixel.x + rng.gaussian(U_NOISE), 0));
        covariances.push_back(Vec3d(U_NOISE*U_NOISE, 0, encoder*encoder/(MM_PER_PIXEL*MM_PER_PIXEL)));
    }

    const Vec3d about(0, 0, 0), start(0, 0, 600);       // from the drawing
    struct { const char* name; Ptr<RefractiveCamera> camera; bool weighted; } const ways[] = {
        { "window ignored", RefractiveCamera::create(K, camera->distCoeffs()), true },
        { "encoder's errors ignored", camera, false },
        { "both in account", camera, true } };
    for (const auto& way : ways)
    {
        Vec3d r = about, t = start;
        Mat covariance;
        const bool found = refractiveSolvePnP(marks, pixels, way.camera, r, t, true, noArray(), covariance, way.weighted ? 1. : 0.,
                                              noArray(), way.weighted ? Mat(covariances) : Mat());
        if (!found)
            CV_Error(Error::StsError, "no pose found");
        std::cout << format("%-25s pose off by %.3f deg, %.3f mm; stated +- %.3f mm", way.name, angle(r, rvec), norm(t - tvec),
                            std::sqrt(covariance.at<double>(3, 3) + covariance.at<double>(4, 4) + covariance.at<double>(5, 5)))
                  << std::endl;
    }
    return 0;
}
