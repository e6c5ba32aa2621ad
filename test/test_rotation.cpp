// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Rotation vector <-> matrix, to the last digits of any angle.
#include "math/rotation.hpp"
#include "scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

TEST_CASE("A rotation's vector has all of its digits, however small or large the angle", "[rotation]")
{
    const uint64 seed = 20261122;
    CAPTURE(seed);
    RNG rng(seed);
    for (double angle : { 1e-300, 1e-20, 1e-12, 1e-8, 1e-6, 3e-6, 1e-5, 1e-4, 1e-3, 0.1, 1., 2., 3., 3.14, CV_PI - 1e-6, CV_PI - 1e-12 })
        for (int k = 0; k < 50; k++)
        {
            const Vec3d axis = normalize(Vec3d(rng.gaussian(1), rng.gaussian(1), rng.gaussian(k % 2 ? 1 : 1e-6)));
            const Vec3d rvec = angle*axis, back = rotationVector(rotationMatrix(rvec));
            INFO("angle " << angle << ", axis " << axis);
            const double lost = angle < 1e-15 ? 1e-15 : 1e-14*std::max(1., angle);
            CHECK(norm(back - rvec) < (angle < 1 ? std::max(lost*angle*10, 4e-16) : lost));
        }
}

TEST_CASE("Half a turn and none have vectors", "[rotation]")
{
    CHECK(norm(rotationVector(Matx33d::eye())) == 0);
    for (int axis = 0; axis < 3; axis++)
    {
        Matx33d R = -Matx33d::eye();
        R(axis, axis) = 1;
        Vec3d expected;
        expected[axis] = CV_PI;
        const Vec3d rvec = rotationVector(R);
        CHECK(std::min(norm(rvec - expected), norm(rvec + expected)) < 1e-15);
    }
}

TEST_CASE("The right Jacobian says how a rotation turns with its vector", "[rotation]")
{
    const uint64 seed = 20261130;
    CAPTURE(seed);
    RNG rng(seed);
    for (double angle : { 0., 1e-9, 1e-6, 3e-5, 0.1, 1., 3., CV_PI - 1e-7, CV_PI, 4. })
        for (int k = 0; k < 20; k++)
        {
            const Vec3d rvec = angle*normalize(Vec3d(rng.gaussian(1), rng.gaussian(1), rng.gaussian(1)));
            const Vec3d step = 1e-4*Vec3d(rng.gaussian(1), rng.gaussian(1), rng.gaussian(1));
            const Vec3d turn = rotationVector(rotationMatrix(rvec - 0.5*step).t()*rotationMatrix(rvec + 0.5*step));
            INFO("rvec " << rvec << ", step " << step);
            CHECK(norm(Rotation(rvec.val).rightJacobian()*step - turn) < 1e-7*norm(step));
        }
}
