// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/eliminate.hpp"

namespace cv { namespace refract {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Information informationOf(const Problem& problem, bool withHeld)
{
    const FreeSpace space(problem, withHeld);
    const std::vector<ImageRows> images = linearize(problem, space);
    return problem.hasScene() ? eliminatePoints(problem, space, images) : eliminatePoses(problem, space, images);
}

//! Columns scaled to their effect: the parameters' sizes differ by orders.
static VectorXd scaleOf(const Information& information)
{
    return (information.effect.array() > 0).select(information.effect.cwiseInverse(), 0.);
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

Information eliminateLast(const Information& information, int first, InnerBlock& last, int& lost)
{
    const int others = (int)information.root.cols() - first, rows = (int)information.root.rows();
    Information left;
    left.effect = information.effect.head(first);
    left.rounding = information.rounding;
    MatrixXd rotated(rows, first + 1);
    rotated << information.root.leftCols(first), information.residual;
    int rank = 0;
    lost = -1;
    if (others > 0)
    {
        const VectorXd scale = scaleOf(information).tail(others);
        const PivotedQR qr(information.root.rightCols(others)*scale.asDiagonal(), information.rounding);
        rank = qr.rank();
        if (rank < others)
            lost = first + qr.column(rank);
        rotated = qr.rotate(rotated);
        setInner(qr, scale, rotated, last);
    }
    for (int i = 0; i < first; i++)
        last.columns.push_back(i);
    left.root = rotated.bottomRows(rows - rank).leftCols(first);
    left.residual = rotated.bottomRows(rows - rank).rightCols<1>();
    left.ofInner = information.ofInner + rotated.topRows(rank).rightCols<1>().squaredNorm();
    return left;
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

MatrixXd pseudoCovariance(const Information& information)
{
    const MatrixXd half = pseudoInverseRoot(information);
    return timesTranspose(half, half);
}

}} // namespace
