// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/parameter_columns.hpp"
#include "math/dense.hpp"
#include "math/rotation.hpp"
#include "paper_rig.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;
using Eigen::MatrixXd;

namespace {

//! The rig with one of its parameters, in the order of Fit::covariance, moved; a normal stays a unit vector.
RigModel moved(const RigModel& rig, int column, double step)
{
    RigModel result = rig.clone();
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(rig, c);
        Mat lens = rig.cameras[c]->lensParameters();
        GlassWindow window = rig.cameras[c]->window();
        if (column >= at.lens && column < at.normal)
            lens.at<double>(column - at.lens) += step;
        else if (column >= at.normal && column < at.distance)
            window.normal[column - at.normal] += step;
        else if (column == at.distance)
            window.distance += step;
        else if (column >= at.thickness && column < at.index)
            window.thickness[column - at.thickness] += step;
        else if (column >= at.index && column < at.innerIndex)
            window.index[column - at.index] += step;
        else if (column == at.outerIndex)
            window.outerIndex += step;
        window.normal = normalize(window.normal);
        result.cameras[c]->setLensParameters(lens);
        result.cameras[c]->setWindow(window);
        const int k = column - columnsOf(rig, (int)rig.cameras.size() - 1).end - 6*(c - 1);
        if (c > 0 && k >= 0 && k < 3)
        {
            Vec3d rvec;
            Rodrigues(rig.extrinsics[c].R, rvec);
            rvec[k] += step;
            Rodrigues(rvec, result.extrinsics[c].R);
        }
        else if (c > 0 && k >= 3 && k < 6)
            result.extrinsics[c].t[k - 3] += step;
    }
    const int target = column - columnCount(rig);
    if (target == 0)
        result.targetScale += step;
    else if (target > 0 && target < 4)
    {
        Vec3d rvec;
        Rodrigues(rig.targetMotion.R, rvec);
        rvec[target - 1] += step;
        Rodrigues(rvec, result.targetMotion.R);
    }
    else if (target >= 4)
        result.targetMotion.t[target - 4] += step;
    return result;
}

} // namespace

TEST_CASE("Derivatives of a view of three cameras agree with differences", "[view_derivatives]")
{
    RigModel rig = paperRig(3);
    const bool targets = GENERATE(false, true);
    if (targets)
    {
        rig.targetCovariance = Mat::eye(TARGET_ERRORS, TARGET_ERRORS, CV_64F);
        rig.targetScale = 1.01;
        Rodrigues(Vec3d(0.02, -0.01, 0.03), rig.targetMotion.R);
        rig.targetMotion.t = Vec3d(1, -2, 3);
    }
    const std::vector<Point3d> object = board(6, 5);
    // As usual; hardly turned, and upside down, in camera 2: where cv::Rodrigues has no derivatives.
    const Vec3d turn2 = GENERATE(Vec3d::all(NAN), Vec3d(4e-7, -1e-7, 2e-7), Vec3d(0, 0, CV_PI - 1e-6));
    const Vec3d rvec = std::isnan(turn2[0]) ? Vec3d(0.2, -0.3, 0.1) : rotationVector(rig.extrinsics[1].R.t()*rotationMatrix(turn2));
    const Vec3d tvec(-30, 10, 620);
    CAPTURE(turn2, targets);
    std::vector<ImageOfView> images;
    for (int c = 0; c < 3; c++)
        for (bool glass : {true, false})
            images.push_back(pointsInImage(rig, object, rvec, tvec, c, glass));
    const auto predicted = [&](const RigModel& r, const Vec3d& rv, const Vec3d& tv) {
        return differentiateView(r, object, rv, tv, images).predicted;
    };
    const ViewDerivatives d = differentiateView(rig, object, rvec, tvec, images);
    REQUIRE(d.byParameters.rows() >= 100);
    REQUIRE(d.byParameters.cols() == columnCount(rig) + (targets ? TARGET_ERRORS : 0));
    const int inner[] = {columnsOf(rig, 0).innerIndex, columnsOf(rig, 1).innerIndex, columnsOf(rig, 2).innerIndex};
    for (int column = 0; column < d.byParameters.cols(); column++)
    {
        if (column == inner[0] || column == inner[1] || column == inner[2])
            continue;                   // 1 is the least a medium can have
        const int end = columnsOf(rig, 2).end;
        bool outer = false;
        for (int c = 0; c < 3; c++)
            outer = outer || column == columnsOf(rig, c).outerIndex;
        const double h = outer || (column >= end && (column - end) % 6 < 3) ? 1e-6 : 1e-5;
        // 1 is the least a medium can have, so that one is differenced to one side.
        const Eigen::VectorXd below = outer ? d.predicted : predicted(moved(rig, column, -h), rvec, tvec);
        const Eigen::VectorXd slope = (predicted(moved(rig, column, h), rvec, tvec) - below)/(outer ? h : 2*h);
        CAPTURE(column);
        CHECK((slope - d.byParameters.col(column)).norm() <= 2e-5*d.byParameters.col(column).norm() + 1e-5*outer + 1e-6);
    }
    for (int k = 0; k < 6; k++)
    {
        const double h = 1e-6;
        Vec3d r1 = rvec, r2 = rvec, t1 = tvec, t2 = tvec;
        (k < 3 ? r1 : t1)[k % 3] += h;
        (k < 3 ? r2 : t2)[k % 3] -= h;
        const Eigen::VectorXd slope = (predicted(rig, r1, t1) - predicted(rig, r2, t2))/(2*h);
        CAPTURE(k);
        CHECK((slope - d.byPose.col(k)).norm() < 1e-5*d.byPose.col(k).norm());
    }
    const PoseNullSpace project(d.byPose);
    const MatrixXd Q = project(MatrixXd::Identity(d.byPose.rows(), d.byPose.rows())).transpose();
    CHECK(Q.cols() == d.byPose.rows() - 6);
    CHECK(project(d.byPose).norm() < 1e-9*d.byPose.norm());
    CHECK((Q.transpose()*Q - MatrixXd::Identity(Q.cols(), Q.cols())).norm() < 1e-10);
}

TEST_CASE("A view added to a covariance is what the information of both gives", "[view_derivatives]")
{
    scenes::Random random(3002);
    std::cout << "seed " << scenes::seed() << '\n';
    const auto matrix = [&random](int rows, int columns) {
        MatrixXd m(rows, columns);
        for (int i = 0; i < m.size(); i++)
            m.data()[i] = random.normal(1);
        return m;
    };
    const MatrixXd half = matrix(5, 5), J = matrix(12, 5), C = half*half.transpose();
    const MatrixXd both = inverse(inverse(C) + transposeTimes(J, J, 1/0.04));
    CHECK((covarianceWith(C, J, 0.2) - both).norm() < 1e-8*both.norm());
    CHECK(covarianceWith(MatrixXd::Zero(5, 5), J, 0.2).norm() == 0.);          // what is exact stays so
}
