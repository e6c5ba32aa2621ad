// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* A calibration as the robust fit (robust_fit.hpp) sees it. With an observation's derivatives F by the free parameters and K by
its view's pose, and P = sum of K^T K, B = sum of K^T F over the view, its predicted pixel has the covariance

    [F K] C [F K]^T,     C = [ S  -S Q^T; -Q S  P^+ + Q S Q^T ],     Q = P^+ B,     S = A^+ (information.hpp)  */

#include "calibrate/rig_robust.hpp"
#include "calibrate/information.hpp"
#include "calibrate/moved_images.hpp"
#include "math/robust_scale.hpp"
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

//! Covariance of the free parameters; what is not determined has no part in any prediction.
MatrixXd parameterCovariance(const Information& information)
{
    const double SINGULAR = 1e-9;
    if (information.effect.size() == 0)
        return MatrixXd();
    const VectorXd scale = (information.effect.array() > 0).select(information.effect.cwiseInverse(), 0.);
    const Eigen::JacobiSVD<MatrixXd> svd(information.root*scale.asDiagonal(), Eigen::ComputeFullV);
    const VectorXd inverse = (svd.singularValues().array() > SINGULAR).select(svd.singularValues().cwiseInverse(), 0.);
    const MatrixXd half = scale.asDiagonal()*svd.matrixV()*inverse.asDiagonal();
    return half*half.transpose();
}

Matrix6 pseudoInverse(const Matrix6& P)
{
    const double ROUNDING = 1e-12;
    const Vector6 diagonal = P.diagonal();
    const Vector6 scale = (diagonal.array() > 0).select(diagonal.cwiseSqrt().cwiseInverse(), 0.);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal()*P*scale.asDiagonal());
    const VectorXd inverse = (eigen.eigenvalues().array() > ROUNDING).select(eigen.eigenvalues().cwiseInverse(), 0.);
    const MatrixXd half = scale.asDiagonal()*eigen.eigenvectors();
    return half*inverse.asDiagonal()*half.transpose();
}

//! Derivatives of one image's pixels by the free parameters (those in columns) and its pose, whether they are used or not.
struct ImageRows
{
    MatrixXd F, K;
    VectorXd residuals;
    std::vector<int> columns;
    std::vector<uchar> isUsed;

    ImageRows(const RigProblem& rig, const FreeSpace& space, int image, const std::vector<uchar>& used) : isUsed(used)
    {
        const RigProblem::Derivatives d = rig.derivatives(rig.images()[image]);
        K = d.byPose;
        residuals = d.residuals;
        F.resize(K.rows(), 0);
        for (size_t i = 0; i < d.blocks.size(); i++)
        {
            const MatrixXd& basis = space.bases[d.blocks[i]];
            const int before = (int)F.cols();
            F.conservativeResize(Eigen::NoChange, before + basis.cols());
            F.rightCols(basis.cols()) = d.byBlock[i]*basis;
            for (int j = 0; j < basis.cols(); j++)
                columns.push_back(space.first[d.blocks[i]] + j);
        }
    }
};

//! Those of one point; of a matrix without columns, too, of which Eigen makes no block.
MatrixXd rowsOf(const MatrixXd& matrix, int point)
{
    return matrix.cols() == 0 ? MatrixXd(2, 0) : MatrixXd(matrix.middleRows(2*point, 2));
}

//! The covariance of what one view predicts.
class ViewPredictions
{
public:
    ViewPredictions(const std::vector<ImageRows>& images, const MatrixXd& S, const Matrix6& prior) : S_(S)
    {
        Matrix6 P = prior;
        MatrixXd B = MatrixXd::Zero(6, S.cols());
        for (const ImageRows& image : images)
            for (size_t row = 0; row < image.isUsed.size(); row++)
            {
                if (!image.isUsed[row])
                    continue;
                const MatrixXd K = image.K.middleRows(2*row, 2), KF = K.transpose()*rowsOf(image.F, (int)row);
                P += K.transpose()*K;
                for (size_t j = 0; j < image.columns.size(); j++)
                    B.col(image.columns[j]) += KF.col(j);
            }
        const Matrix6 inverse = pseudoInverse(P);
        const MatrixXd Q = inverse*B;
        QS_ = Q*S;
        ofPose_ = inverse + QS_*Q.transpose();
    }

    Matx22d operator()(const ImageRows& image, int row) const
    {
        const MatrixXd K = image.K.middleRows(2*row, 2), F = rowsOf(image.F, row);
        const int count = (int)image.columns.size();
        MatrixXd S(count, count), QS(6, count);
        for (int j = 0; j < count; j++)
        {
            QS.col(j) = QS_.col(image.columns[j]);
            for (int i = 0; i < count; i++)
                S(i, j) = S_(image.columns[i], image.columns[j]);
        }
        const Eigen::Matrix2d cross = K*QS*F.transpose();
        const Eigen::Matrix2d H = K*ofPose_*K.transpose() + F*S*F.transpose() - cross - cross.transpose();
        return Matx22d(H(0, 0), H(0, 1), H(1, 0), H(1, 1));
    }

private:
    const MatrixXd& S_;
    MatrixXd QS_;
    Matrix6 ofPose_;
};

} // namespace

double RigFitProblem::rootWeight(double ratio) const
{
    const double TUKEY = 4.685;     // 95 % as efficient as squares on clean data
    return std::max(0., 1 - std::pow(ratio/TUKEY, 2));
}

void RigFitProblem::leaveOutImages(double scale)
{
    for (int i : findMovedImages(rig(), scale))
        status_[i] = GLASS_IMAGE_MOVED;
}

void RigFitProblem::setInliers(Masks& inliers)
{
    for (int i = 0; i < (int)inliers.size(); i++)
    {
        const double kept = (double)std::count(inliers[i].begin(), inliers[i].end(), 1);
        if (status_[i] == GLASS_IMAGE_USED && kept < LEAST_AGREEING*(double)inliers[i].size())
            status_[i] = GLASS_IMAGE_UNUSABLE;
        if (status_[i] != GLASS_IMAGE_USED)
            std::fill(inliers[i].begin(), inliers[i].end(), (uchar)0);
        rig().setRootWeights(i, std::vector<double>(inliers[i].begin(), inliers[i].end()));
    }
}

std::vector<std::vector<DeletionResidual> > RigFitProblem::deletionResiduals(const Masks& inliers)
{
    const FreeSpace space(rig(), false);
    const MatrixXd S = parameterCovariance(rigInformation(rig(), false));
    std::vector<std::vector<DeletionResidual> > all(inliers.size());
    std::vector<Matrix6> priors;        // views without any observation lose theirs while all have a weight
    for (int view = 0; view < rig().viewCount(); view++)
        priors.push_back(rig().isUncertain(view) ? Matrix6(rig().priorByPose(view).transpose()*rig().priorByPose(view))
                                                 : Matrix6(Matrix6::Zero()));
    for (int view = 0; view < rig().viewCount(); view++)
    {
        std::vector<ImageRows> rows;
        std::vector<std::vector<uchar> > hasImage;
        for (int i : rig().imagesOf(view))
        {
            const RigImage& image = rig().images()[i];
            const std::vector<double> errors = rig().pixelErrors(image, rig().pose(view));
            hasImage.push_back(std::vector<uchar>());
            for (double error : errors)
                hasImage.back().push_back(std::isfinite(error) && status_[i] == GLASS_IMAGE_USED);
            rig().setRootWeights(i, std::vector<double>(hasImage.back().begin(), hasImage.back().end()));
        }
        for (int i : rig().imagesOf(view))
            rows.push_back(ImageRows(rig(), space, i, inliers[i]));
        const ViewPredictions predictions(rows, S, priors[view]);
        for (size_t k = 0; k < rows.size(); k++)
        {
            const int i = rig().imagesOf(view)[k];
            for (int row = 0; row < (int)inliers[i].size(); row++)
            {
                DeletionResidual residual(Vec2d(rows[k].residuals[2*row], rows[k].residuals[2*row + 1]),
                                          predictions(rows[k], row), inliers[i][row] != 0);
                residual.dimensions = hasImage[k][row] ? residual.dimensions : 0;
                all[i].push_back(residual);
            }
            rig().setRootWeights(i, std::vector<double>(inliers[i].begin(), inliers[i].end()));
        }
    }
    return all;
}

String RigFitProblem::minorityFault(int fitting, int seen) const
{
    return format("only %d of %d points fit; are the target's size, its square and the order of its points right, and the "
                  "poses, if they were given (target to camera 1)?", fitting, seen);
}

RigViews agreeingViews(const Rig& rig, const RigViews& views)
{
    RigViews agreeing = views;
    for (int c = 0; c < rig.count(); c++)
    {
        const Camera bare = withWindow(rig.cameras[c]);
        for (int view = 0; view < views.count(); view++)
        {
            CameraViews& seen = agreeing.cameras[c];
            seen.direct[view] = pointsOfOnePose(bare, views.object[view], seen.direct[view]);
            seen.refracted[view] = pointsOfOnePose(rig.cameras[c], views.object[view], seen.refracted[view]);
        }
    }
    return agreeing;
}

}} // namespace
