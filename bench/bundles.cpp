// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Bundle adjustments as large as real ones: eight cameras round a tank, from a crude start.
#include "bundles.hpp"
#include "measure.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/refract.hpp>

#include <cstdio>
#include <random>
#include <sys/resource.h>

using namespace cv;
using namespace cv::refract;

namespace bench {

namespace {

const int CAMERAS = 8;

struct Tank
{
    std::vector<Ptr<RefractiveCamera> > cameras;
    std::vector<Mat> Rs, Ts, rvecs, tvecs;
    std::vector<std::vector<Mat> > images;
    std::vector<Vec4d> lengths;
};

Vec3d randomVector(std::mt19937_64& engine, double size)
{
    std::uniform_real_distribution<double> side(-size, size);
    return Vec3d(side(engine), side(engine), side(engine));
}

/** Cameras 15 degrees apart look at the middle of the tank.
@param off how crude, in degrees and parts of a hundred of the range; 0: the truth */
Tank makeTank(double off, int views)
{
    std::mt19937_64 engine(5);
    const double RANGE = 800;
    Tank tank;
    for (int c = 0; c < CAMERAS; c++)
    {
        const Vec3d tilt(0.1 - 0.02*c, 0.05*(c % 3), 1);
        const GlassWindow window(off > 0 ? Vec3d(0, 0, 1) : tilt, 10, 1.49, off > 0 ? 55 : 50 + c, 1.333);
        tank.cameras.push_back(RefractiveCamera::create(Matx33d(1500, 0, 640, 0, 1500, 512, 0, 0, 1),
                                                        std::vector<double>{ -0.1, 0.05, 0, 0 }, window));
        const Vec3d rvec(0, 15*c*CV_PI/180, 0.02*c), middle(0, 0, RANGE), crude = off*randomVector(engine, CV_PI/180);
        Matx33d R, crudeR;
        Rodrigues(rvec, R);
        Rodrigues(rvec + (c > 0 ? 1 : 0)*crude, crudeR);
        tank.Rs.push_back(Mat(crudeR, true));
        tank.Ts.push_back(Mat(Vec3d(middle - R*middle + (c > 0 ? off : 0)*randomVector(engine, RANGE/100)), true));
    }
    for (int view = 0; view < views; view++)
    {
        const Vec3d rvec = randomVector(engine, 0.3), tvec = Vec3d(0, 0, RANGE) + randomVector(engine, 20);
        const double o = view > 0 ? off : 0;
        tank.rvecs.push_back(Mat(rvec + o*randomVector(engine, CV_PI/180), true));
        tank.tvecs.push_back(Mat(tvec + o*randomVector(engine, RANGE/100), true));
    }
    return tank;
}

//! Every camera sees every point, but for one in ten; lengths between the points of each pair.
void look(Tank& truth, int points, int lengths, Tank& start)
{
    const double SIGMA = 0.1, LENGTH_SIGMA = 0.05;
    std::mt19937_64 engine(6);
    std::normal_distribution<double> noise(0, 1);
    const bool stands = truth.rvecs.size() == 1;
    std::vector<Point3d> scene;
    Matx33d R1;
    Rodrigues(truth.rvecs[0], R1);
    for (int i = 0; i < points; i++)
    {
        scene.push_back(Point3d(randomVector(engine, 150)));
        if (stands)     // in pairs, 200 mm apart
            scene.back() = i % 2 == 0 ? scene.back() : scene[i - 1] + Point3d(200*normalize(randomVector(engine, 1)));
    }
    for (int i = 0; i < lengths; i++)
    {
        const double length = norm(scene[2*i] - scene[2*i + 1]);
        start.lengths.push_back(Vec4d(2*i, 2*i + 1, length + LENGTH_SIGMA*noise(engine), LENGTH_SIGMA));
    }
    for (int c = 0; c < CAMERAS; c++)
    {
        start.images.push_back(std::vector<Mat>());
        for (size_t view = 0; view < truth.rvecs.size(); view++)
        {
            Matx33d R;
            Rodrigues(truth.rvecs[view], R);
            const Mat both = truth.Rs[c]*Mat(R), t = truth.Rs[c]*truth.tvecs[view] + truth.Ts[c];
            Mat_<Vec2d> pixels;
            refractiveProjectPoints(scene, both, t, truth.cameras[c], pixels);
            for (Vec2d& p : pixels)
                p = engine() % 10 == 0 ? Vec2d::all(NAN) : p + SIGMA*Vec2d(noise(engine), noise(engine));
            start.images[c].push_back(pixels);
        }
    }
}

void run(const char* what, int views, int points, int lengths)
{
    Tank truth = makeTank(0, views), start = makeTank(1, views);
    look(truth, points, lengths, start);
    std::vector<Point3d> points3D;
    BundleAdjustOptions options(GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE);
    options.computeViewCovariances = false;
    const double begin = processorSeconds(), clock = (double)getTickCount();
    const BundleAdjustResult found = refractiveBundleAdjust(start.images, start.cameras, std::vector<int>(), start.Rs, start.Ts,
                                                            start.rvecs, start.tvecs, points3D, start.lengths, options);
    const double seconds = processorSeconds() - begin, elapsed = ((double)getTickCount() - clock)/getTickFrequency();
    double squares = 0;
    for (int c = 0; c < CAMERAS; c++)
    {
        const int distance = 16*c + 11;     // fx, fy, cx, cy, k1, k2, p1, p2, normal (3), distance
        squares += std::pow((start.cameras[c]->window().distance - truth.cameras[c]->window().distance)/
                            found.stdDeviations.at<double>(distance), 2)/CAMERAS;
    }
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    std::printf("%-44s%10d%10d%10.1f%10.1f%10ld%12.3f%12.2f\n", what, views, points, seconds, elapsed, usage.ru_maxrss/1024, found.rms,
                std::sqrt(squares));
    std::fflush(stdout);
}

} // namespace

void printBundles()
{
    std::printf("%-44s%10s%10s%10s%10s%10s%12s%12s\n", "8 cameras, windows, R, T from a crude start", "views", "points",
                "CPU, s", "clock, s", "MB so far", "RMS, px", "error/sigma");
    run("a wand at 500 moments", 1, 1000, 500);
    run("moving through a scene", 20, 500, 1);
    run("moving through a scene", 100, 500, 1);
    run("moving through a scene", 200, 500, 1);
    run("500 new points at 100 moments, 100 lengths", 1, 50000, 100);
}

} // namespace bench
