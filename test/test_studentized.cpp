// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Deletion residuals of a random linear model with pixels as observations.
#include "scenes.hpp"
#include "math/studentized.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

//! Pixels = rows * parameters + noise; what least squares say of observation i from the others, or from all.
struct LinearModel
{
    LinearModel(int observations, int parameters, Random& random)
        : rows(2*observations, parameters, CV_64F), pixels(2*observations, 1, CV_64F)
    {
        for (int i = 0; i < rows.rows; i++)
        {
            const double size = random.logUniform(0.2, 5);      // so that leverages differ
            for (int j = 0; j < parameters; j++)
                rows.at<double>(i, j) = size*random.normal(1);
            pixels.at<double>(i) = random.normal(1);
        }
    }

    DeletionResidual residual(int i, bool isUsed) const
    {
        Mat weights = Mat::ones(rows.rows, 1, CV_64F);
        if (!isUsed)
            weights.rowRange(2*i, 2*i + 2) = 0;
        const Mat weighed = rows.mul(repeat(weights, 1, rows.cols)), covariance = Mat(weighed.t()*rows).inv();
        const Mat own = rows.rowRange(2*i, 2*i + 2), found = covariance*weighed.t()*pixels;
        const Mat e = own*found - pixels.rowRange(2*i, 2*i + 2), H = own*covariance*own.t();
        return DeletionResidual(Vec2d(e), Matx22d(H), isUsed);
    }

    double variance() const
    {
        const Mat residuals = pixels - rows*(Mat(rows.t()*rows).inv()*rows.t()*pixels);
        return residuals.dot(residuals)/freedom();
    }
    int freedom() const { return rows.rows - rows.cols; }

    Mat rows, pixels;
};

} // namespace

TEST_CASE("The residual of a used observation tells how far off the others' prediction is", "[studentized]")
{
    CAPTURE(seed());
    Random random(1);
    for (int trial = 0; trial < 50; trial++)
    {
        const LinearModel model(8, 5, random);
        for (int i = 0; i < 8; i++)
        {
            const DeletionResidual used = model.residual(i, true), leftOut = model.residual(i, false);
            CHECK(used.dimensions == 2);
            CHECK(used.square == Approx(leftOut.square).epsilon(1e-6));
        }
    }
}

TEST_CASE("What nothing else predicts is no outlier", "[studentized]")
{
    const Vec2d residual(3, 4);
    CHECK(DeletionResidual(residual, Matx22d::eye(), true).dimensions == 0);
    CHECK(DeletionResidual(residual, Matx22d::eye(), true).excess(1e-9, 10) == 0);
    const DeletionResidual half(residual, Matx22d(1, 0, 0, 0.5), true);
    CHECK(half.dimensions == 1);
    CHECK(half.square == Approx(32));       // 4^2/0.5
    CHECK(DeletionResidual(residual, Matx22d(1, 0, 0, 1), false).square == Approx(12.5));
}

TEST_CASE("A good observation exceeds the cut with a chance of 1e-4, whatever the leverage and the freedom", "[studentized]")
{
    CAPTURE(seed());
    Random random(2);
    int count = 0, beyond = 0;
    for (int observations : { 5, 40 })
        for (int trial = 0; trial < 10000; trial++)
        {
            const LinearModel model(observations, 4, random);
            const double variance = model.variance();
            for (int k = 0; k < 4; k++, count++)        // a few of 40
                beyond += model.residual(random.below(observations), true).excess(variance, model.freedom()) > 1;
        }
    CAPTURE(beyond, count);
    CHECK(beyond >= 1);
    CHECK(beyond <= 20);        // 8 expected
}

TEST_CASE("Of half a pixel a deletion residual has one dimension", "[half_pixels][studentized]")
{
    for (bool isUsed : { false, true })
        for (int row : { 0, 1 })
        {
            const double leverage = 0.25, variance = isUsed ? 1 - leverage : 1 + leverage;
            Vec2d residual;
            Matx22d prediction = Matx22d::zeros();
            residual[row] = 3;
            prediction(row, row) = leverage;
            const DeletionResidual half(residual, prediction, isUsed, 1);
            CHECK(half.dimensions == 1);
            CHECK(half.square == Approx(9/variance));
            prediction(row, row) = 1;
            CHECK(DeletionResidual(residual, prediction, true, 1).dimensions == 0);     // nothing else predicts it
        }
}
