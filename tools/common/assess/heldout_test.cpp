// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/heldout_test.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/view_observations.hpp"
#include "math/dense.hpp"
#include <cmath>
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

void HeldOutTest::add(const HeldOutTest& other)
{
    squares += other.squares;
    expectedSquares += other.expectedSquares;
    chiSquare += other.chiSquare;
    directions += other.directions;
}

double HeldOutTest::ratio() const
{
    return expectedSquares > 0. ? std::sqrt(squares/expectedSquares) : std::numeric_limits<double>::quiet_NaN();
}

double HeldOutTest::calibrationRatio() const
{
    return directions ? std::sqrt(chiSquare/directions) : std::numeric_limits<double>::quiet_NaN();
}

HeldOutTest testHeldOut(const RigModel& rig, const Mat& covariance, double sigma, const std::vector<View>& views)
{
    const CorrelationSpectrum spectrum(toEigen(covariance));
    const MatrixXd H = spectrum.root(spectrum.rank());      // H H^T = covariance
    MatrixXd AH(0, H.cols());
    VectorXd r(0);
    for (const View& view : views)
    {
        ViewObservations observed = observationsOf(rig, view);
        const ViewDerivatives derivatives = refinePose(rig, observed);
        const PoseNullSpace project(derivatives.byPose);
        const MatrixXd part = project(product(derivatives.byParameters, H));
        const Eigen::Index rows = r.size();
        AH.conservativeResize(rows + part.rows(), Eigen::NoChange);
        AH.bottomRows(part.rows()) = part;
        r.conservativeResize(rows + part.rows());
        r.tail(part.rows()) = project(observed.pixels - derivatives.predicted);
    }
    const SingularValues svd(AH);
    const VectorXd rAlong = transposeTimesVector(AH, r);        // U^T r of A H = U S V^T is S^-1 V^T (A H)^T r
    HeldOutTest test;
    test.squares = r.squaredNorm();
    test.expectedSquares = sigma*sigma*(double)r.size() + svd.values.squaredNorm();
    for (int i = 0; i < svd.values.size() && svd.values[i] > sigma; i++)
    {
        const double variance = sigma*sigma + std::pow(svd.values[i], 2);
        test.chiSquare += std::pow(svd.V.col(i).dot(rAlong)/svd.values[i], 2)/variance;
        test.directions++;
    }
    return test;
}

} // namespace tools
