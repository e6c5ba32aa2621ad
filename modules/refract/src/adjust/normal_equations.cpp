// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/normal_equations.hpp"
#include "math/dense.hpp"

namespace cv { namespace refract {

using Eigen::MatrixXd;
using Eigen::VectorXd;

static const int SIZE = BlockCholesky::SIZE;

NormalEquations::NormalEquations(int cameras, const BlockGraph& graph)
    : ofCameras(MatrixXd::Zero(cameras, cameras)), ofPoses(graph), ofBoth(MatrixXd::Zero(SIZE*ofPoses.count(), cameras)),
      gradient(VectorXd::Zero(cameras + SIZE*ofPoses.count())) {}

double& NormalEquations::at(int row, int column)
{
    const int cameras = (int)ofCameras.cols(), pose = row - cameras;
    if (pose < 0)
        return ofCameras(row, column);
    if (column < cameras)
        return ofBoth(pose, column);
    return ofPoses.column(ofPoses.at(pose/SIZE)).diagonal(pose % SIZE, (column - cameras) % SIZE);
}

void NormalEquations::add(const MatrixXd& products, const VectorXd& ownGradient, const std::vector<int>& columns)
{
    for (size_t c = 0; c < columns.size(); c++)
    {
        gradient[columns[c]] += ownGradient[c];
        for (size_t r = c; r < columns.size(); r++)
            at(std::max(columns[r], columns[c]), std::min(columns[r], columns[c])) += products(r, c);
    }
}

VectorXd NormalEquations::diagonal() const
{
    VectorXd all(gradient.size());
    all << ofCameras.diagonal(), ofPoses.diagonal();
    return all;
}

void NormalEquations::addToDiagonal(const VectorXd& damping)
{
    const int cameras = (int)ofCameras.cols();
    ofCameras.diagonal() += damping.head(cameras);
    for (int k = 0; k < ofPoses.count(); k++)
        ofPoses.column(k).diagonal.diagonal() += damping.segment<SIZE>(cameras + SIZE*ofPoses.blockAt(k));
}

static VectorXd inverseOrZero(const VectorXd& x) { return (x.array() > 0).select(x.cwiseInverse(), 0.); }

//! Poses are eliminated as points were; then R and z, R^T R = what is left for the cameras and R^T z = its gradient.
RootOfEquations::RootOfEquations(NormalEquations equations, const VectorXd& effect, double rounding)
{
    const int cameras = (int)equations.ofCameras.cols(), ofPoses = SIZE*equations.ofPoses.count();
    equations.ofPoses.factor(effect.tail(ofPoses), rounding);
    MatrixXd both(ofPoses, cameras + 1);
    both << equations.ofBoth, equations.gradient.tail(ofPoses);
    equations.ofPoses.solveL(both);
    poses.byCameras = both.leftCols(cameras);
    poses.residual = both.col(cameras);
    poses.factor = std::move(equations.ofPoses);
    ofCameras.resize(cameras, cameras);
    residual.resize(cameras);
    if (cameras == 0)
        return;
    VectorXd gradient = equations.gradient.head(cameras);
    if (ofPoses > 0)                // Eigen has no products of nothing
    {
        gradient -= transposeTimesVector(poses.byCameras, poses.residual);
        addGram(poses.byCameras, -1, equations.ofCameras);
    }
    const VectorXd own = effect.head(cameras), scale = inverseOrZero(own);
    const LDLT ldlt(scale.asDiagonal()*equations.ofCameras*scale.asDiagonal());
    const VectorXd D = ldlt.D();
    const VectorXd roots = (D.array() > rounding).select(D.cwiseMax(0).cwiseSqrt(), 0.);
    ofCameras = roots.asDiagonal()*ldlt.L().transpose()*own.asDiagonal();
    const VectorXd z = ldlt.solveL(scale.cwiseProduct(gradient));
    residual = (roots.array() > 0).select(z.cwiseQuotient(roots), 0.);
}

VectorXd RootOfEquations::step(const VectorXd& effect, double rounding) const
{
    const int cameras = (int)ofCameras.cols(), ofPoses = (int)poses.residual.size();
    VectorXd all = VectorXd::Zero(cameras + ofPoses);
    if (cameras > 0)
    {
        const VectorXd scale = inverseOrZero(effect.head(cameras));
        const PivotedQR qr(ofCameras*scale.asDiagonal(), std::sqrt(rounding));
        all.head(cameras) = scale.cwiseProduct(qr.solve(VectorXd(-residual)));
    }
    if (ofPoses > 0)
    {
        MatrixXd ofPose = -poses.residual;
        if (cameras > 0)            // Eigen has no products of nothing
            ofPose -= timesVector(poses.byCameras, all.head(cameras));
        poses.factor.solveTranspose(ofPose);
        all.tail(ofPoses) = ofPose;
    }
    return all;
}

}} // namespace
