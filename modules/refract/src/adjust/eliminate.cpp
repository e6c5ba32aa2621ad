// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/eliminate.hpp"

namespace cv { namespace refract {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Information informationOf(const Problem& problem, bool withHeld, bool withRoot)
{
    const FreeSpace space(problem, withHeld);
    if (!problem.hasScene())
        return eliminatePoses(problem, space, linearize(problem, space));
    Information information = eliminatePoints(problem, space);
    if (withRoot)
        findRoot(information);
    return information;
}

bool Information::isFinite() const
{
    if (!equations)
        return effect.allFinite() && root.allFinite() && residual.allFinite();
    return effect.allFinite() && equations->ofCameras.allFinite() && equations->ofBoth.allFinite() && equations->gradient.allFinite();
}

//! Columns of the root scaled to their effect: the parameters' sizes differ by orders.
static VectorXd scaleOf(const Information& information)
{
    const VectorXd effect = information.effect.head(information.root.cols());
    return (effect.array() > 0).select(effect.cwiseInverse(), 0.);
}

void setInner(const PivotedQR& qr, const VectorXd& scale, const MatrixXd& rotated, InnerBlock& block)
{
    const int rank = qr.rank(), count = (int)rotated.cols() - 1;
    const MatrixXd best = -(scale.asDiagonal()*qr.solveR(rotated));
    block.half = scale.asDiagonal()*qr.solveR(MatrixXd::Identity(rank, rank));
    block.byOuter = best.leftCols(count);
    block.step = best.col(count);
    block.isDetermined = rank == scale.size();
}

VectorXd gradientOfCameras(const Information& information)
{
    const VectorXd gradient = transposeTimesVector(information.root, information.residual);
    if (information.poses.residual.size() == 0)
        return gradient;
    return gradient + transposeTimesVector(information.poses.byCameras, information.poses.residual);
}

double newtonDecrement(const Information& information)
{
    if (information.root.cols() == 0)
        return std::sqrt(information.ofInner);
    // What no data determine has no least squares.
    const PivotedQR qr(information.root*scaleOf(information).asDiagonal(), information.rounding);
    const VectorXd rotated = qr.rotate(information.residual);
    return std::sqrt(rotated.head(qr.rank()).squaredNorm() + information.ofInner);
}

MatrixXd pseudoInverseRoot(const Information& information)
{
    if (information.root.cols() == 0)
        return MatrixXd(0, information.root.rows());
    const VectorXd scale = scaleOf(information);
    return scale.asDiagonal()*pseudoInverse(information.root*scale.asDiagonal(), information.rounding);
}

}} // namespace
