// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/image_noise.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/view_observations.hpp"
#include "console/failure.hpp"
#include "math/dense.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int CUBIC = 3, TERMS = 10;
const int POINTS_PER_TERM = 2;

//! Columns x^i y^j, x and y within -1 to 1.
MatrixXd polynomials(const VectorXd& pixels)
{
    const Eigen::Index n = pixels.size()/2;
    MatrixXd xy(n, 2);
    for (Eigen::Index i = 0; i < n; i++)
        xy.row(i) = pixels.segment<2>(2*i).transpose();
    const Eigen::RowVector2d low = xy.colwise().minCoeff(), high = xy.colwise().maxCoeff();
    for (int axis = 0; axis < 2; axis++)
        xy.col(axis) = (2.*xy.col(axis).array() - low[axis] - high[axis])/std::max(1e-9, high[axis] - low[axis]);
    MatrixXd columns(n, TERMS);
    int column = 0;
    for (int i = 0; i <= CUBIC; i++)
        for (int j = 0; i + j <= CUBIC; j++)
            columns.col(column++) = xy.col(0).array().pow(i)*xy.col(1).array().pow(j);
    return columns;
}

void addImage(const RigModel& rig, const View& view, double& squares, double& dof)
{
    ViewObservations observed = observationsOf(rig, view);
    const ViewDerivatives derivatives = refinePose(rig, observed);
    const Eigen::Index n = observed.pixels.size()/2;
    const VectorXd residual = observed.pixels - derivatives.predicted;
    if (n < POINTS_PER_TERM*TERMS || !residual.allFinite())
        return;
    const PivotedQR smooth(polynomials(observed.pixels));
    for (int axis = 0; axis < 2; axis++)
    {
        VectorXd rest(n);
        for (Eigen::Index i = 0; i < n; i++)
            rest[i] = residual[2*i + axis];
        rest = smooth.rotate(rest);
        squares += rest.tail(n - smooth.rank()).squaredNorm();
        dof += (double)(n - smooth.rank());
    }
}

} // namespace

ImageNoise imageNoise(const RigModel& rig, const std::vector<View>& views)
{
    double squares = 0., dof = 0.;
    for (const View& view : views)
        for (int c = 0; c < (int)rig.cameras.size(); c++)
            for (bool glass : {false, true})
            {
                View alone = view;
                alone.direct = alone.glass = {};
                (glass ? alone.glass : alone.direct)[c] = (glass ? view.glass : view.direct)[c];
                const std::vector<Point2d>& pixels = (glass ? alone.glass : alone.direct)[c];
                if (pixels.empty())
                    continue;
                try
                {
                    addImage(rig, alone, squares, dof);
                }
                catch (const Failure&) {}       // no pose
            }
    return {dof > 0. ? std::sqrt(squares/dof) : 0., dof};
}

} // namespace tools
