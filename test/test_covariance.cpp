// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What a problem's data can and cannot tell.
#include "math/dense.hpp"
#include "problem_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Eigen::MatrixXd;

namespace {

//! Two directions in which a unit vector can turn: columns.
MatrixXd acrossOf(const Vec3d& n)
{
    const Vec3d a = normalize(n.cross(Vec3d(0, 1, 0))), b = n.cross(a);
    MatrixXd across(3, 2);
    across << a[0], b[0], a[1], b[1], a[2], b[2];
    return across;
}

/** Covariance of a camera's parameters from the public derivatives, by inverting the normal equations with every pose in them.
@param free columns of the jacobian behind the pose, other than the normal's */
MatrixXd expectedCovariance(const RigTruth& truth, const RigScene& scene, const std::vector<String>& free, double variance)
{
    const Ptr<RefractiveCamera>& camera = truth.cameras[0];
    const std::vector<String> names = camera->parameterNames();
    const int all = (int)names.size(), count = 2 + (int)free.size(), views = (int)scene.object.size();
    const auto find = [&](const String& name) { return (int)(std::find(names.begin(), names.end(), name) - names.begin()); };
    MatrixXd basis = MatrixXd::Zero(all, count);
    basis.block(find("normal[0]"), 0, 3, 2) = acrossOf(camera->window().normal);
    for (size_t i = 0; i < free.size(); i++)
        basis(find(free[i]), 2 + i) = 1;
    MatrixXd normal = MatrixXd::Zero(count + 6*views, count + 6*views);
    for (int view = 0; view < views; view++)
    {
        std::vector<Point2d> pixels;
        Mat jacobian;
        refractiveProjectPoints(scene.object[view], scene.rvecs[view], scene.tvecs[view], camera, pixels, noArray(), jacobian);
        const Eigen::Map<const RowMajorMatrix> J(jacobian.ptr<double>(), jacobian.rows, jacobian.cols);
        MatrixXd row = MatrixXd::Zero(J.rows(), count + 6*views);
        row.leftCols(count) = J.rightCols(all)*basis;
        row.middleCols(count + 6*view, 6) = J.leftCols(6);
        normal += transposeTimes(row, row);
    }
    const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = scale.asDiagonal()*normal*scale.asDiagonal();
    const MatrixXd covariance = scale.asDiagonal()*cv::refract::inverse(scaled)*scale.asDiagonal();
    return variance*propagated(covariance.topLeftCorner(count, count), basis);
}

RigTruth one(const GlassWindow& window)
{
    RigTruth truth;
    truth.cameras = { paperCamera(window) };
    truth.windows = { 0 };
    truth.Rs = { Matx33d::eye() };
    truth.Ts = { Vec3d() };
    return truth;
}

//! Far, small and straight ahead: rays of small angles only.
RigScene paraxialScene(const RigTruth& truth, Random& random)
{
    return makeRigScene(truth, ObjectViews(4, board(6, 5, 2)), random, 0, 3000, 3100);
}

} // namespace

TEST_CASE("The covariance is the inverse of the normal equations with every pose in them", "[covariance]")
{
    Random random(760);
    CAPTURE(seed());
    const struct { double outerIndex; int flags; std::vector<String> free; } cases[] = {
        { 1, 0, {} }, { 1, GLASS_FREE_THICKNESS, { "thickness[0]" } },
        { 1.333, GLASS_FREE_DISTANCE | GLASS_FREE_INDEX, { "distance", "index[0]" } },
        { 1, GLASS_FREE_WEDGE, { "wedge[0][0]", "wedge[0][1]" } } };
    for (const auto& c : cases)
    {
        GlassWindow window = paper::pane(50, paper::NORMAL1, c.outerIndex);
        if (c.flags & GLASS_FREE_WEDGE)
            window.wedge = { Vec2d(3e-4, -1e-4) };
        const RigTruth truth = one(window);
        const RigScene scene = makeRigScene(truth, 8, random, 0);
        const double variance = 0.04;
        const std::unique_ptr<Problem> problem = problemAt(truth, scene, false, c.flags);
        const int required = c.flags & GLASS_FREE_WEDGE ? 0 : REQUIRE_ALL;      // images through the glass alone hardly tell it
        const MatrixXd C = covarianceOf(*problem, variance, required), expected = expectedCovariance(truth, scene, c.free, variance);
        REQUIRE(C.rows() == expected.rows());
        CAPTURE(c.outerIndex, c.flags);
        for (int i = 0; i < C.rows(); i++)
            for (int j = 0; j < C.cols(); j++)
            {
                CAPTURE(i, j);
                const double size = std::sqrt(expected(i, i)*expected(j, j));
                CHECK(std::abs(C(i, j) - expected(i, j)) <= 1e-6*size);      // 0 where one of them is fixed
            }
        CHECK((covarianceOf(*problem, 4*variance, required) - 4*C).norm() <= 1e-12*C.norm());
        CHECK(covarianceOf(*problem, 0, required).norm() == 0);
    }
}

TEST_CASE("What a second camera sees of a shared window is as uncertain as what the first sees", "[covariance]")
{
    Random random(770);
    CAPTURE(seed());
    const RigTruth truth = makeRig(2, { 0, 0 }, 1);
    const RigScene scene = makeRigScene(truth, 6, random, 0);
    const MatrixXd C = covarianceOf(*problemAt(truth, scene, true, 0), 0.04);
    const std::vector<String> names = truth.cameras[0]->parameterNames();
    const int at = (int)(std::find(names.begin(), names.end(), "normal[0]") - names.begin()), all = (int)names.size();
    MatrixXd R(3, 3);
    for (int i = 0; i < 9; i++)
        R(i/3, i % 3) = truth.Rs[1].val[i];
    const MatrixXd first = C.block(at, at, 3, 3), second = C.block(all + at, all + at, 3, 3);
    REQUIRE(first.norm() > 0);
    CHECK((second - R*first*R.transpose()).norm() <= 1e-9*first.norm());
    CHECK((C.block(all + at, at, 3, 3) - R*first).norm() <= 1e-9*first.norm());
}

TEST_CASE("What has no effect at all is refused by its name", "[covariance]")
{
    Random random(780);
    CAPTURE(seed());
    const RigTruth truth = one(paper::pane());          // with air on both sides the distance is not seen
    const RigScene scene = makeRigScene(truth, 6, random, 0);
    CHECK_THROWS_WITH(covarianceOf(*problemAt(truth, scene, true, GLASS_FREE_DISTANCE), 0.04),
                      Catch::Contains("do not determine distance") && !Catch::Contains("normal"));
    CHECK_NOTHROW(covarianceOf(*problemAt(truth, scene, true, 0), 0.04));
}

TEST_CASE("Thickness and index that only show together are refused together, also without noise", "[covariance]")
{
    Random random(790);
    CAPTURE(seed());
    const RigTruth truth = one(GlassWindow({ 0, 0, 1 }, 20, 1.5437, 50));
    const RigScene scene = paraxialScene(truth, random);
    for (const double variance : { 0.04, 0. })          // data without noise would seem to determine anything
    {
        CAPTURE(variance);
        CHECK_THROWS_WITH(covarianceOf(*problemAt(truth, scene, true, GLASS_FREE_THICKNESS | GLASS_FREE_INDEX), variance),
                          Catch::Contains("thickness[0] = 20") && Catch::Contains("index[0] = 1.544")
                          && Catch::Contains("only thickness (1 - outerIndex/index) = 7.044"));
    }
}

TEST_CASE("What is not required is told, however uncertain it is", "[covariance]")
{
    Random random(795);
    CAPTURE(seed());
    const RigTruth truth = one(paper::pane());
    const RigScene scene = makeRigScene(truth, 6, random, 0);
    const auto problem = problemAt(truth, scene, true, 0);
    const double tame = 0.04, wild = 1e8;       // squared pixels: the second know next to nothing
    for (const int required : { REQUIRE_ALL, (int)GLASS_REQUIRE_WINDOW })
        CHECK_THROWS_WITH(covarianceOf(*problem, wild, required), Catch::Contains("do not determine normal"));
    const MatrixXd expected = wild/tame*covarianceOf(*problem, tame);
    for (const int required : { 0, GLASS_REQUIRE_INTRINSICS | GLASS_REQUIRE_EXTRINSICS })
        CHECK((covarianceOf(*problem, wild, required) - expected).norm() <= 1e-12*expected.norm());
}
