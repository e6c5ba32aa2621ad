// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Three cameras behind the windows of a tank, calibrated by nothing but a wand of known length that is waved through the water:
// no board, no image without the window. The wand is simulated; put your own pixels in place of waveWand().

#include <opencv2/calib3d.hpp>
#include <opencv2/refract.hpp>
#include <iostream>

using namespace cv;

const double WAND = 200, WAND_SIGMA = 0.02, PIXEL_SIGMA = 0.1;      // mm, mm, px
const int MOMENTS = 150;

struct Rig
{
    std::vector<Ptr<refract::RefractiveCamera> > cameras;
    std::vector<Mat> Rs, Ts;        // camera 1 -> camera
};

//! Cameras on an arc, turned towards the middle of the tank 700 mm before the first; the lenses are known.
static Rig makeRig(const Vec3d& normal, double distance, double turned, double moved)
{
    const Matx33d K(1600, 0, 640, 0, 1600, 512, 0, 0, 1);
    Rig rig;
    for (int c = 0; c < 3; c++)
    {
        const refract::GlassWindow window(normal + Vec3d(0.05*c, -0.04*c, 0), 10, 1.49, distance + 5*c, 1.333);
        rig.cameras.push_back(refract::RefractiveCamera::create(K, std::vector<double>{ -0.1, 0.05, 0, 0 }, window));
        Matx33d R;
        Rodrigues(Vec3d(0.02*c, 0.35*c + turned*(c > 0), 0.01*c), R);
        const Vec3d middle(0, 0, 700);
        rig.Rs.push_back(Mat(R));
        rig.Ts.push_back(Mat(Vec3d(middle - R*middle + Vec3d(moved, 2*moved, -moved)*(c > 0))));
    }
    return rig;
}

//! The pixels of the wand's two ends at all moments, an array per camera; NaN where it is not in the image.
static std::vector<Mat> waveWand(const Rig& rig, RNG& random)
{
    std::vector<Point3d> ends;
    for (int moment = 0; moment < MOMENTS; moment++)
    {
        const Vec3d middle(random.uniform(-100., 100.), random.uniform(-80., 80.), random.uniform(620., 780.));
        const Vec3d along(random.gaussian(1), random.gaussian(1), random.gaussian(1));
        ends.push_back(Point3d(middle + WAND/2*normalize(along)));
        ends.push_back(Point3d(middle - WAND/2*normalize(along)));
    }
    std::vector<Mat> images;
    for (size_t c = 0; c < rig.cameras.size(); c++)
    {
        Mat_<Vec2d> pixels;
        refract::refractiveProjectPoints(ends, rig.Rs[c], rig.Ts[c], rig.cameras[c], pixels);
        for (Vec2d& p : pixels)
            if (p[0] > 0 && p[1] > 0 && p[0] < 1280 && p[1] < 1024)
                p += Vec2d(random.gaussian(PIXEL_SIGMA), random.gaussian(PIXEL_SIGMA));
            else
                p = Vec2d::all(std::numeric_limits<double>::quiet_NaN());
        images.push_back(pixels);
    }
    return images;
}

//! Prints truth and result; false if they are more than four standard deviations apart.
static bool compare(const String& what, double truth, double found, double sigma)
{
    std::cout << format("%-22s %9.4f  found %9.4f +- %.4f\n", what.c_str(), truth, found, sigma);
    return std::abs(found - truth) < 4*sigma;
}

int main()
{
    RNG random(1);
    const Rig truth = makeRig(Vec3d(-0.1, 0.15, 1), 40, 0, 0);
    const std::vector<Mat> pixels = waveWand(truth, random);

    // The start: windows thought to be straight ahead, cameras where a tape measure has them.
    Rig rig = makeRig(Vec3d(0, 0, 1), 45, 0.03, 8);
    std::vector<Vec4d> lengths;
    for (int moment = 0; moment < MOMENTS; moment++)
        lengths.push_back(Vec4d(2*moment, 2*moment + 1, WAND, WAND_SIGMA));
    std::vector<std::vector<Mat> > images;      // per camera one view: the rig stands still
    for (const Mat& ofCamera : pixels)
        images.push_back(std::vector<Mat>(1, ofCamera));
    std::vector<Point3d> points;
    const refract::BundleAdjustOptions options(refract::GLASS_FREE_EXTRINSICS | refract::GLASS_FREE_DISTANCE);
    const refract::BundleAdjustResult result = refract::refractiveBundleAdjust(
        images, rig.cameras, std::vector<int>(), rig.Rs, rig.Ts, noArray(), noArray(), points, lengths, options);
    const Mat& deviations = result.stdDeviations;

    std::cout << format("%d moments of a wand, %.3f px RMS; truth and result, with one standard deviation:\n", MOMENTS, result.rms);
    bool isGood = true;
    int row = 0;        // of the deviations: each camera's parameters, then rvec and T of each camera but the first
    for (size_t c = 0; c < rig.cameras.size(); c++)
    {
        const std::vector<String> names = rig.cameras[c]->parameterNames();
        const int normal = row + (int)(std::find(names.begin(), names.end(), "normal[0]") - names.begin());
        const refract::GlassWindow expected = truth.cameras[c]->window(), found = rig.cameras[c]->window();
        for (int i = 0; i < 2; i++)
            isGood &= compare(format("camera %d, normal[%d]", (int)c + 1, i), expected.normal[i], found.normal[i],
                              deviations.at<double>(normal + i));
        isGood &= compare(format("camera %d, distance, mm", (int)c + 1), expected.distance, found.distance,
                          deviations.at<double>(normal + 3));
        row += (int)names.size();
    }
    for (size_t c = 1; c < rig.cameras.size(); c++, row += 6)
        for (int i = 0; i < 3; i++)
            isGood &= compare(format("camera %d, T[%d], mm", (int)c + 1, i), truth.Ts[c].at<double>(i), rig.Ts[c].at<double>(i),
                              deviations.at<double>(row + 3 + i));
    return isGood ? 0 : 1;
}
