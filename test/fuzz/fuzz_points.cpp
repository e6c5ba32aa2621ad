// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "harness.hpp"

// Project, unproject, undistort, meet a plane: one camera, point by point.

using namespace cv::refract;
using namespace fuzz;

namespace {

void tryProject(Bytes& bytes)
{
    const Input points = objectPoints(bytes, countOf(bytes)), rvec = rotation(bytes, 3), tvec = translation(bytes, 200, 500);
    Output imagePoints(bytes, 2, points.mat()), status(bytes, 1);
    if (bytes.maybe())
    {
        const Lens lens(bytes);
        refractiveProjectPoints(points, rvec, tvec, lens.cameraMatrix, lens.distCoeffs, lens.window, imagePoints, status);
    }
    else
        refractiveProjectPoints(points, rvec, tvec, cameraOf(bytes), imagePoints, status);
    checkAnswer(imagePoints.mat(), status.mat());
}

void tryJacobian(Bytes& bytes)
{
    const Input points = objectPoints(bytes, countOf(bytes)), rvec = rotation(bytes, 3), tvec = translation(bytes, 200, 500);
    Output imagePoints(bytes, 2, points.mat()), status(bytes, 1), jacobian(bytes, 1);
    refractiveProjectPoints(points, rvec, tvec, cameraOf(bytes), imagePoints, status, jacobian);
    checkAnswer(imagePoints.mat(), status.mat());
    const cv::Mat J = jacobian.mat(), s = status.mat();
    for (int i = 0; i < (int)s.total() && 2*i + 1 < J.rows; i++)
        if (s.at<uchar>(i) != REFRACT_OK)
            promise(allNaN(J, 2*i) && allNaN(J, 2*i + 1), "derivatives are NaN where status is not 0");
}

void tryUnproject(Bytes& bytes)
{
    const Input points = pixels(bytes, countOf(bytes));
    Output origins(bytes, 3), directions(bytes, 3, points.mat()), status(bytes, 1);
    if (bytes.maybe())
    {
        const Lens lens(bytes);
        refractiveUnprojectPoints(points, origins, directions, lens.cameraMatrix, lens.distCoeffs, lens.window, status);
    }
    else
        refractiveUnprojectPoints(points, origins, directions, cameraOf(bytes), status);
    const cv::Mat s = status.mat(), d = directions.mat();
    checkAnswer(origins.mat(), s);
    checkAnswer(d, s);
    for (int i = 0; i < (int)s.total() && !d.empty(); i++)
        if (s.at<uchar>(i) == REFRACT_OK)
            promise(std::abs(cv::norm(d.row(i)) - 1) < (d.depth() == CV_32F ? 1e-5 : 1e-9), "directions have unit length");
}

Input depthOf(Bytes& bytes, int count)
{
    switch (bytes.below(4))
    {
    case 0: return Input::matrix(bytes, 1, 1, [&](int, int) { return bytes.about(100, 2000); });
    case 1: return Input::matrix(bytes, bytes.rarely() ? bytes.below(9) : count, 1, [&](int, int) { return bytes.about(100, 2000); });
    case 2:
        return Input::matrix(bytes, 4, 1, [&](int i, int)
                             { return i == 2 ? 1. : i == 3 ? bytes.about(100, 2000) : bytes.about(-1, 1); });
    default: return Input::matrix(bytes, 1, 1, [&](int, int) { return std::numeric_limits<double>::infinity(); });
    }
}

Input projectionOf(Bytes& bytes)
{
    const int columns = bytes.maybe() ? 3 : 4;
    return Input::matrix(bytes, 3, columns, [&](int r, int c) {
        return c == 2 ? r == 2 ? bytes.rarely() ? bytes.number() : 1. : bytes.about(0, 1000) : r == c ? bytes.about(300, 2000)
                                                                                                 : bytes.rarely() ? bytes.number() : 0.; });
}

void tryUndistort(Bytes& bytes)
{
    const int count = countOf(bytes);
    const Input points = pixels(bytes, count), depth = depthOf(bytes, count);
    const Input R = bytes.maybe() ? rotation(bytes, 0.3) : Input(), P = bytes.maybe() ? projectionOf(bytes) : Input();
    Output corrected(bytes, 2, points.mat()), status(bytes, 1);
    if (bytes.maybe())
    {
        const Lens lens(bytes);
        refractiveUndistortPoints(points, corrected, lens.cameraMatrix, lens.distCoeffs, lens.window, depth, R, P, status);
    }
    else
        refractiveUndistortPoints(points, corrected, cameraOf(bytes), depth, R, P, status);
    checkAnswer(corrected.mat(), status.mat());
}

void tryPlane(Bytes& bytes)
{
    const Input points = pixels(bytes, countOf(bytes));
    const cv::Vec4d plane(bytes.about(-0.5, 0.5), bytes.about(-0.5, 0.5), bytes.about(0.5, 1), bytes.about(200, 2000));
    Output points3D(bytes, 3, points.mat()), status(bytes, 1);
    if (bytes.maybe())
    {
        const Lens lens(bytes);
        refractivePointsOnPlane(points, points3D, lens.cameraMatrix, lens.distCoeffs, lens.window, plane, status);
    }
    else
        refractivePointsOnPlane(points, points3D, cameraOf(bytes), plane, status);
    checkAnswer(points3D.mat(), status.mat());
}

} // namespace

void fuzz::tryInput(Bytes& bytes)
{
    tryOneOf(bytes, {tryProject, tryJacobian, tryUnproject, tryUndistort, tryPlane});
}
