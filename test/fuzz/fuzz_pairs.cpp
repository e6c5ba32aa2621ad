// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "harness.hpp"

// Two cameras: epipolar curves and triangulation.

using namespace cv::refract;
using namespace fuzz;

namespace {

struct Pose
{
    explicit Pose(Bytes& bytes) : R(rotation(bytes, 0.3)), T(translation(bytes, 300, 0)) {}
    Input R, T;
};

void tryEpilines(Bytes& bytes)
{
    const Input points = pixels(bytes, bytes.below(5));
    const Pose pose(bytes);
    const int image = bytes.rarely() ? bytes.below(4) : 1 + bytes.below(2);
    cv::Vec2d depths(bytes.about(100, 1000), bytes.about(1000, 3000));
    if (bytes.maybe())
        depths[1] = std::numeric_limits<double>::infinity();
    const double tolerance = bytes.maybe() ? 0.01 : bytes.about(0.001, 1.);
    std::vector<cv::Mat> lines;
    cv::Mat status;
    if (bytes.maybe())
    {
        const Lens lens1(bytes), lens2(bytes);
        computeRefractiveEpilines(points, image, lens1.cameraMatrix, lens1.distCoeffs, lens1.window, lens2.cameraMatrix,
                                  lens2.distCoeffs, lens2.window, pose.R, pose.T, depths, lines, tolerance, status);
    }
    else
    {
        const cv::Ptr<RefractiveCamera> camera1 = cameraOf(bytes), camera2 = cameraOf(bytes);
        computeRefractiveEpilines(points, image, camera1, camera2, pose.R, pose.T, depths, lines, tolerance, status);
    }
    promise(lines.size() == status.total(), "one line and one status for each point");
    for (size_t i = 0; i < lines.size(); i++)
    {
        promise(lines[i].empty() == (status.at<uchar>((int)i) != REFRACT_OK), "status 0: the line is not empty");
        promise(lines[i].empty() || countNaN(lines[i], 0, lines[i].rows) == 0, "a line holds no NaN");
    }
}

void tryTriangulate(Bytes& bytes)
{
    const int count = countOf(bytes);
    const Input points1 = pixels(bytes, count), points2 = pixels(bytes, bytes.rarely() ? countOf(bytes) : count);
    const Pose pose(bytes);
    const int flags = bytes.rarely() ? bytes.below(9) - 3 : bytes.below(2);
    Output points3D(bytes, 3, points1.mat()), status(bytes, 1);
    if (bytes.maybe())
    {
        const Lens lens1(bytes), lens2(bytes);
        triangulateRefractive(lens1.cameraMatrix, lens1.distCoeffs, lens1.window, lens2.cameraMatrix, lens2.distCoeffs,
                              lens2.window, pose.R, pose.T, points1, points2, points3D, status, flags);
    }
    else
    {
        const cv::Ptr<RefractiveCamera> camera1 = cameraOf(bytes), camera2 = cameraOf(bytes);
        triangulateRefractive(camera1, camera2, pose.R, pose.T, points1, points2, points3D, status, flags);
    }
    checkAnswer(points3D.mat(), status.mat());
}

void tryCovariance(Bytes& bytes)
{
    const int count = countOf(bytes);
    const Input points1 = pixels(bytes, count), points2 = pixels(bytes, count);
    const Pose pose(bytes);
    const cv::Ptr<RefractiveCamera> camera1 = cameraOf(bytes), camera2 = cameraOf(bytes);
    if (!camera1 || !camera2)
        return;
    const auto parameters = [](const RefractiveCamera& camera) {
        return (int)camera.parameterNames().size(); };
    const int size = bytes.rarely() ? bytes.below(50) : parameters(*camera1) + parameters(*camera2) + 6;
    const Input calibration = bytes.maybe() && size < 200
        ? Input::matrix(bytes, size, size, [&](int r, int c) { return r == c ? bytes.about(0, 1e-3) : 0.; }) : Input();
    Output points3D(bytes, 3, points1.mat()), status(bytes, 1), covariance(bytes, 1);
    triangulateRefractive(camera1, camera2, pose.R, pose.T, points1, points2, points3D, status, bytes.below(2),
                          bytes.about(0.01, 1.), calibration, covariance);
    checkAnswer(points3D.mat(), status.mat());
    const cv::Mat s = status.mat(), C = covariance.mat();
    for (int i = 0; i < (int)s.total() && !C.empty(); i++)
        if (s.at<uchar>(i) != REFRACT_OK)
            promise(allNaN(C, i), "the covariance of no answer is NaN");
}

} // namespace

void fuzz::tryInput(Bytes& bytes)
{
    tryOneOf(bytes, {tryEpilines, tryTriangulate, tryCovariance});
}
