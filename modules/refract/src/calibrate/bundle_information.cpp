// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* With the derivatives E by a cluster's points and F by cameras and poses, the information on the latter that is left when
the points are unknown is

    S = sum over images of F^T F - sum over clusters of (Y E^T F)^T (Y E^T F),     Y^T Y = (E^T E)^+

(the Schur complement); cameras are told from poses by the same step on S. Columns are scaled to their own effect before
anything is inverted. The points' covariance is Y^T (I + W S^-1 W^T) Y with W = Y E^T F. */

#include "calibrate/bundle_information.hpp"
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// What is left of a squared effect below this part of it is rounding.
const double ROUNDING = 1e-12;

//! Y, Y^T Y = A^+. @param isRegular if given: whether A has an inverse
MatrixXd inverseRoot(const MatrixXd& A, bool* isRegular = nullptr)
{
    const VectorXd scale = A.diagonal().cwiseMax(DBL_MIN).cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal()*A*scale.asDiagonal());
    const VectorXd& values = eigen.eigenvalues();
    const VectorXd roots = (values.array() > ROUNDING*values.maxCoeff()).select(values.cwiseSqrt().cwiseInverse(), 0.);
    if (isRegular)
        *isRegular = values[0] > ROUNDING*values.maxCoeff();
    return roots.asDiagonal()*eigen.eigenvectors().transpose()*scale.asDiagonal();
}

} // namespace

ReducedBundle::ReducedBundle(const BundleProblem& bundle, bool withHeld)
    : bundle_(bundle), space_(bundle.rig(), withHeld), count_(space_.count), ofPoints_(0)
{
    for (int view = 0; view < bundle.rig().viewCount(); view++)
    {
        const bool isAdjusted = bundle.rig().isAdjusted(view);
        firstOfPose_.push_back(isAdjusted ? count_ : -1);
        count_ += isAdjusted ? 6 : 0;
    }
    matrix_.setZero(count_, count_);
    gradient_.setZero(count_);
    addImages();
    addPriors();
    effect_ = matrix_.diagonal().cwiseSqrt();
    addClusters();
}

void ReducedBundle::addImages()
{
    const RigProblem& rig = bundle_.rig();
    for (int i = 0; i < (int)rig.images().size(); i++)
    {
        const RigProblem::Derivatives& derivatives = bundle_.state(i).derivatives;
        const int pose = firstOfPose_[rig.images()[i].view];
        ImageRows image;
        for (int block : derivatives.blocks)
            for (int j = 0; j < space_.bases[block].cols(); j++)
                image.columns.push_back(space_.first[block] + j);
        const int ofRig = (int)image.columns.size();
        for (int j = 0; pose >= 0 && j < 6; j++)
            image.columns.push_back(pose + j);
        image.rows.resize(derivatives.residuals.size(), image.columns.size());
        int column = 0;
        for (size_t b = 0; b < derivatives.blocks.size(); b++)
        {
            const MatrixXd& basis = space_.bases[derivatives.blocks[b]];
            image.rows.middleCols(column, basis.cols()) = derivatives.byBlock[b]*basis;
            column += (int)basis.cols();
        }
        if (pose >= 0)
            image.rows.rightCols(6) = derivatives.byPose;
        CV_Assert(column == ofRig);

        MatrixXd used = image.rows;
        for (int row = 0; 2*row < used.rows(); row++)
            if (!bundle_.isInlier(i, row))
                used.middleRows<2>(2*row).setZero();
        const MatrixXd products = used.transpose()*used;
        const VectorXd gradient = used.transpose()*derivatives.residuals;
        for (size_t c = 0; c < image.columns.size(); c++)
        {
            gradient_[image.columns[c]] += gradient[c];
            for (size_t r = 0; r < image.columns.size(); r++)
                if (image.columns[r] >= image.columns[c])
                    matrix_(image.columns[r], image.columns[c]) += products(r, c);
        }
        images_.push_back(image);
    }
}

void ReducedBundle::addPriors()
{
    const RigProblem& rig = bundle_.rig();
    for (int view = 0; view < rig.viewCount(); view++)
    {
        const int first = firstOfPose_[view];
        if (first < 0 || !rig.isUncertain(view))
            continue;
        const Matrix6 rows = rig.priorByPose(view);
        matrix_.block<6, 6>(first, first) += rows.transpose()*rows;
        gradient_.segment<6>(first) += rows.transpose()*rig.priorOfPose(view);
    }
}

ReducedBundle::Eliminated ReducedBundle::eliminate(const Cluster& cluster) const
{
    const int size = cluster.size();
    MatrixXd EE = MatrixXd::Zero(size, size), EF = MatrixXd::Zero(size, count_);
    VectorXd Er = VectorXd::Zero(size);
    for (const Sighting& sighting : cluster.sightings)
    {
        const BundleProblem::ImageState& state = bundle_.state(sighting.image);
        const ImageRows& image = images_[sighting.image];
        const Eigen::Matrix<double, 2, 3> E = state.byPoint.middleRows<2>(2*sighting.row);
        const int at = 3*sighting.at;
        EE.block<3, 3>(at, at) += E.transpose()*E;
        Er.segment<3>(at) += E.transpose()*state.derivatives.residuals.segment<2>(2*sighting.row);
        for (size_t c = 0; c < image.columns.size(); c++)
            EF.block<3, 1>(at, image.columns[c]) += E.transpose()*image.rows.block<2, 1>(2*sighting.row, c);
    }
    Eigen::RowVectorXd byValues;
    for (const KnownLength& length : cluster.lengths)
    {
        const double sigma = bundle_.rig().pixelSigma(), residual = sigma*cluster.residual(length, byValues);
        byValues *= sigma;
        EE += byValues.transpose()*byValues;
        Er += byValues.transpose()*residual;
    }
    Eliminated result;
    result.Y = inverseRoot(EE, &result.isDetermined);
    result.W = result.Y*EF;
    result.ofResiduals = result.Y*Er;
    return result;
}

void ReducedBundle::addClusters()
{
    const int MANY = 256;       // rows at a time: products of large matrices are faster
    MatrixXd rows(MANY, count_);
    int used = 0;
    const auto subtract = [&]
    {
        matrix_.selfadjointView<Eigen::Lower>().rankUpdate(rows.topRows(used).transpose(), -1);
        used = 0;
    };
    for (const Cluster& cluster : bundle_.clusters())
    {
        const Eliminated part = eliminate(cluster);
        ofPoints_ += part.ofResiduals.squaredNorm();
        gradient_ -= part.W.transpose()*part.ofResiduals;
        if (used + cluster.size() > rows.rows())
            subtract();
        if (cluster.size() > rows.rows())
            rows.resize(cluster.size(), count_);
        rows.middleRows(used, cluster.size()) = part.W;
        used += cluster.size();
    }
    subtract();
}

//! Scaled by the columns' effects, both halves.
static MatrixXd scaledMatrix(const MatrixXd& lower, const VectorXd& effect)
{
    const VectorXd scale = (effect.array() > 0).select(effect.cwiseInverse(), 0.);
    MatrixXd scaled = lower.selfadjointView<Eigen::Lower>();
    return scale.asDiagonal()*scaled*scale.asDiagonal();
}

double ReducedBundle::stepLeft() const
{
    // What no data determine has no least squares: a little weight on everything keeps such steps short.
    MatrixXd S = scaledMatrix(matrix_, effect_);
    S.diagonal().array() += ROUNDING;
    const VectorXd gradient = (effect_.array() > 0).select(gradient_.cwiseQuotient(effect_), 0.);
    const double ofRest = count_ == 0 ? 0 : gradient.dot(Eigen::LDLT<MatrixXd>(S).solve(gradient));
    return std::sqrt(ofPoints_ + std::max(ofRest, 0.));
}

//! Y, Y^T Y = inverse of the poses' part of the scaled matrix, the rig being known.
MatrixXd ReducedBundle::poseInverseRoot() const
{
    const int ofRig = space_.count, ofPoses = count_ - ofRig;
    if (ofPoses == 0)
        return MatrixXd(0, 0);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scaledMatrix(matrix_, effect_).bottomRightCorner(ofPoses, ofPoses));
    if (!(eigen.eigenvalues()[0] > ROUNDING))
    {
        int worst;
        eigen.eigenvectors().col(0).cwiseAbs().maxCoeff(&worst);
        const auto pose = std::find(firstOfPose_.begin(), firstOfPose_.end(), ofRig + worst/6*6);
        const int view = (int)(pose - firstOfPose_.begin());
        CV_Error_(Error::StsNoConv, ("the points do not determine the poses, that of view %d least; leave it out, or add "
                                     "points that it shares with others", view));
    }
    return eigen.eigenvalues().cwiseSqrt().cwiseInverse().asDiagonal()*eigen.eigenvectors().transpose();
}

Information ReducedBundle::information() const
{
    const int ofRig = space_.count, ofPoses = count_ - ofRig;
    const MatrixXd S = scaledMatrix(matrix_, effect_), Y = poseInverseRoot();
    MatrixXd A = S.topLeftCorner(ofRig, ofRig);
    if (ofPoses > 0)
    {
        const MatrixXd rows = Y*S.bottomLeftCorner(ofPoses, ofRig);
        A -= rows.transpose()*rows;
    }
    Information information;
    information.effect = effect_.head(ofRig);
    information.ofPoses = 0;
    if (ofRig == 0)
        return information;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(A);
    const VectorXd roots = (eigen.eigenvalues().array() > ROUNDING).select(eigen.eigenvalues().cwiseSqrt(), 0.);
    information.root = roots.asDiagonal()*eigen.eigenvectors().transpose()*information.effect.asDiagonal();
    return information;
}

/** H, H H^T = covariance of the rig's parameters and the poses together: with H_r of the rig alone, and the poses' Y and scaled
matrix B by the rig, [ H_r 0; -Y^T Y B H_r  Y^T ]. What the rig's covariance says of a weak direction so holds for all. */
MatrixXd ReducedBundle::jointHalf(const MatrixXd& half) const
{
    const int ofRig = space_.count, ofPoses = count_ - ofRig;
    const MatrixXd S = scaledMatrix(matrix_, effect_), Y = poseInverseRoot();
    MatrixXd joint = MatrixXd::Zero(count_, half.cols() + ofPoses);
    joint.topLeftCorner(ofRig, half.cols()) = half;
    if (ofPoses == 0)
        return joint;
    const VectorXd scale = effect_.tail(ofPoses).cwiseInverse();
    joint.bottomRightCorner(ofPoses, ofPoses) = scale.asDiagonal()*Y.transpose();
    if (ofRig > 0)
        joint.bottomLeftCorner(ofPoses, half.cols()) = -(scale.asDiagonal()*(Y.transpose()*(Y*(
            S.bottomLeftCorner(ofPoses, ofRig)*(effect_.head(ofRig).asDiagonal()*half)))));
    return joint;
}

Mat ReducedBundle::pointDeviations(const MatrixXd& half, double variance) const
{
    Mat_<double> deviations(bundle_.points().empty() ? 0 : (int)bundle_.points().size(), 3,
                            std::numeric_limits<double>::quiet_NaN());
    const MatrixXd joint = jointHalf(half);
    const std::vector<Cluster>& clusters = bundle_.clusters();
    parallel_for_(Range(0, (int)clusters.size()), [&](const Range& range)
    {
        for (int i = range.start; i < range.end; i++)
        {
            const Eliminated part = eliminate(clusters[i]);
            VectorXd variances = part.Y.colwise().squaredNorm();
            if (count_ > 0)
                variances += (joint.transpose()*(part.W.transpose()*part.Y)).colwise().squaredNorm().transpose();
            for (int k = 0; k < clusters[i].size(); k++)
                deviations(clusters[i].points[k/3], k % 3) = part.isDetermined ? std::sqrt(variance*variances[k])
                                                                               : std::numeric_limits<double>::infinity();
        }
    });
    return deviations;
}

//! @param ofPoints, cross, ofCameras covariance of the cluster's points, of them with the columns, of the columns
Matx22d ReducedBundle::prediction(const Observation& observation, const MatrixXd& ofPoints, const MatrixXd& cross,
                                  const MatrixXd& ofCameras) const
{
    const ImageRows& image = images_[observation.image];
    const int count = (int)image.columns.size(), at = 3*observation.at;
    const Eigen::Matrix<double, 2, 3> E = bundle_.state(observation.image).byPoint.middleRows<2>(2*observation.row);
    const MatrixXd F = image.rows.middleRows<2>(2*observation.row);
    MatrixXd S(count, count), X(3, count);
    for (int j = 0; j < count; j++)
    {
        X.col(j) = cross.block<3, 1>(at, image.columns[j]);
        for (int i = 0; i < count; i++)
            S(i, j) = ofCameras(image.columns[i], image.columns[j]);
    }
    const Eigen::Matrix2d both = E*X*F.transpose();
    const Eigen::Matrix2d H = E*ofPoints.block<3, 3>(at, at)*E.transpose() + both + both.transpose() + F*S*F.transpose();
    return Matx22d(H(0, 0), H(0, 1), H(1, 0), H(1, 1));
}

std::vector<std::vector<Matx22d> > ReducedBundle::predictions() const
{
    const std::vector<Cluster>& clusters = bundle_.clusters();
    std::vector<std::vector<Observation> > ofCluster(clusters.size());
    std::vector<std::vector<Matx22d> > all;
    for (int i = 0; i < (int)images_.size(); i++)
    {
        const std::vector<int>& index = bundle_.rig().images()[i].points.index;
        all.push_back(std::vector<Matx22d>(index.size(), Matx22d::zeros()));
        for (int row = 0; row < (int)index.size(); row++)
            if (bundle_.clusterOf(index[row]) >= 0)
                ofCluster[bundle_.clusterOf(index[row])].push_back({ i, row, bundle_.placeInCluster(index[row]) });
    }
    MatrixXd C(count_, count_);
    if (count_ > 0)
    {
        const VectorXd scale = (effect_.array() > 0).select(effect_.cwiseInverse(), 0.);
        const MatrixXd half = inverseRoot(scaledMatrix(matrix_, effect_))*scale.asDiagonal();
        C = half.transpose()*half;
    }
    parallel_for_(Range(0, (int)clusters.size()), [&](const Range& range)
    {
        for (int i = range.start; i < range.end; i++)
        {
            const Eliminated part = eliminate(clusters[i]);
            const MatrixXd toPoints = -part.Y.transpose()*part.W, cross = toPoints*C;
            const MatrixXd ofPoints = part.Y.transpose()*part.Y + cross*toPoints.transpose();
            for (const Observation& observation : ofCluster[i])
                all[observation.image][observation.row] = prediction(observation, ofPoints, cross, C);
        }
    });
    return all;
}

}} // namespace
