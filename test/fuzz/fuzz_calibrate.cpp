// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "harness.hpp"
#include "scenes.hpp"

// The calibrators. Each is called in one function, with the arguments of its scene.

using namespace cv::refract;
using namespace fuzz;
using cv::Mat;

namespace {

void checkCameras(const Scene& scene)
{
    for (const cv::Ptr<RefractiveCamera>& camera : scene.cameras)
    {
        camera->window().check();
        promise(cv::checkRange(camera->lensParameters()), "a calibrated lens is finite");
    }
}

void checkPoses(const std::vector<Mat>& rvecs, const std::vector<Mat>& tvecs, size_t views)
{
    promise(rvecs.size() == views && tvecs.size() == views, "one pose for each view");
}

void tryNormal(Bytes& bytes)
{
    const Scene scene(bytes);
    Mat normal, centre, covariance;
    double rms;
    if (bytes.maybe())
    {
        const Lens lens(bytes);
        rms = calibrateGlassNormal(arraysOf(bytes, scene.direct[0]), arraysOf(bytes, scene.refracted[0]), lens.cameraMatrix,
                                   lens.distCoeffs, normal, centre, covariance);
    }
    else
        rms = calibrateGlassNormal(arraysOf(bytes, scene.direct[0]), arraysOf(bytes, scene.refracted[0]), scene.cameras[0],
                                   normal, centre, covariance);
    promise(rms >= 0 && std::isfinite(rms), "the RMS is a number");
    promise(cv::checkRange(normal) && std::abs(cv::norm(normal) - 1) < 1e-9 && normal.at<double>(2) > 0,
            "the normal has unit length and points to the scene");
    promise(cv::checkRange(covariance), "the normal's covariance is finite");
}

void tryGlass(Bytes& bytes)
{
    const Scene scene(bytes);
    const std::vector<Mat> objects = arraysOf(bytes, scene.objectPoints), through = arraysOf(bytes, scene.refracted[0]);
    const std::vector<Mat> direct = bytes.maybe() ? arraysOf(bytes, scene.direct[0]) : std::vector<Mat>();
    const int flags = flagsOf(bytes);
    const cv::TermCriteria criteria = criteriaOf(bytes);
    std::vector<Mat> rvecs, tvecs;
    double rms;
    switch (bytes.below(3))
    {
    case 0:
        rms = calibrateGlass(objects, direct, through, scene.cameras[0], rvecs, tvecs, flags, criteria);
        checkCameras(scene);
        break;
    case 1:
    {
        const Lens lens(bytes);
        GlassWindow window = scene.cameras[0]->window();
        rms = calibrateGlass(objects, direct, through, lens.cameraMatrix, lens.distCoeffs, window, rvecs, tvecs, flags, criteria);
        window.check();
        break;
    }
    default:
    {
        Mat deviations, covariance, errors, jacobian;
        rms = calibrateGlass(objects, direct, through, scene.cameras[0], rvecs, tvecs, deviations, covariance, errors, jacobian,
                             flags, criteria);
        checkCameras(scene);
        promise(cv::checkRange(deviations) && cv::checkRange(covariance), "uncertainties are finite");
        promise(deviations.total() == (size_t)covariance.rows, "one deviation for each parameter");
    }
    }
    promise(rms >= 0 && std::isfinite(rms), "the RMS is a number");
    checkPoses(rvecs, tvecs, objects.size());
}

void tryStereo(Bytes& bytes)
{
    Scene scene(bytes, 2);
    std::vector<Mat> rvecs, tvecs;
    Mat &R = scene.Rs[1], &T = scene.Ts[1];
    const std::vector<Mat> objects = arraysOf(bytes, scene.objectPoints);
    const std::vector<Mat> through1 = arraysOf(bytes, scene.refracted[0]), through2 = arraysOf(bytes, scene.refracted[1]);
    std::vector<Mat> direct1, direct2;
    if (bytes.maybe())
    {
        direct1 = arraysOf(bytes, scene.direct[0]);
        direct2 = arraysOf(bytes, scene.direct[1]);
    }
    GlassRigOptions options(flagsOf(bytes));
    options.criteria = criteriaOf(bytes);
    const double rms = stereoCalibrateGlass(objects, direct1, through1, direct2, through2, scene.cameras[0], scene.cameras[1], R, T,
                                            rvecs, tvecs, options).rms;
    promise(rms >= 0 && std::isfinite(rms), "the RMS is a number");
    checkPoses(rvecs, tvecs, objects.size());
    checkCameras(scene);
}

void tryRig(Bytes& bytes)
{
    Scene scene(bytes, 1 + bytes.below(3));
    const std::vector<Mat> objects = arraysOf(bytes, scene.objectPoints);
    std::vector<std::vector<Mat>> through, direct;
    const bool pairs = bytes.maybe();
    std::vector<int> windows;
    for (size_t c = 0; c < scene.cameras.size(); c++)
    {
        through.push_back(arraysOf(bytes, scene.refracted[c]));
        if (pairs)
            direct.push_back(arraysOf(bytes, scene.direct[c]));
        windows.push_back(bytes.rarely() ? bytes.below(256) - 3 : bytes.below(2));
    }
    GlassRigOptions options(flagsOf(bytes));
    if (bytes.maybe())
    {
        options.flags |= GLASS_USE_POSES;
        for (size_t v = 0; v < objects.size(); v++)
            options.poseCovariances.push_back(bytes.maybe() ? Mat(Mat::eye(6, 6, CV_64F)*bytes.about(0, 1e-2)) : Mat());
    }
    if (bytes.rarely())
        scene.cameras[0].release();
    options.criteria = criteriaOf(bytes);
    const double rms = calibrateGlassRig(objects, direct, through, scene.cameras, windows, scene.Rs, scene.Ts, scene.rvecs,
                                         scene.tvecs, options).rms;
    promise(rms >= 0 && std::isfinite(rms), "the RMS is a number");
    checkPoses(scene.rvecs, scene.tvecs, objects.size());
    checkCameras(scene);
}

} // namespace

void fuzz::tryInput(Bytes& bytes)
{
    tryOneOf(bytes, {tryNormal, tryGlass, tryStereo, tryRig});
}
