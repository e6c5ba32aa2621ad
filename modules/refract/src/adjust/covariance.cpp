// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Covariance = s^2 A^-1 of the free parameters; s^2: variance of a pixel coordinate, A = R^T R: eliminate.hpp. Rows of what is known
before (priors) are in R times the standard deviation of a pixel, which is estimated until it is s: so s^2 A^-1 leaves them as they are.

Refused, by name: what R, with each parameter scaled to its own effect, maps to next to nothing, and parameters that are
required and whose standard deviation is so large that the value is no answer. */

#include "adjust/covariance.hpp"
#include "adjust/distance_profile.hpp"
#include "math/dense.hpp"
#include <numeric>
#include <opencv2/core/eigen.hpp>

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Commercial panes are sold with up to 3 arc minutes: a standard deviation of as much tells nothing.
const double MAX_WEDGE_SIGMA = 3*CV_PI/180/60;
// px, what a detector of points reaches at best: without it, noise-free data would seem to determine anything.
const double LEAST_SIGMA = 0.01;

struct FreeParameter
{
    const ParameterBlock* block;
    int coordinate;
    String name;
    double maxSigma;        //!< a standard deviation beyond this is no answer, though the data had the least noise that there is
    double maxLinear;       //!< beyond this it is none, as derivatives do not tell it

    double value() const { return block->values[coordinate]; }
    bool isThickness() const
    { return block->kind == ParameterBlock::MEDIA && block->windowParameter(coordinate) == WindowParameter::THICKNESS; }
    bool isNumber() const { return block->kind == ParameterBlock::LENS || block->kind == ParameterBlock::MEDIA; }
};

//! The GLASS_REQUIRE_... flag of a block.
int requirementOf(ParameterBlock::Kind kind)
{
    return kind == ParameterBlock::LENS ? GLASS_REQUIRE_INTRINSICS : kind == ParameterBlock::EXTRINSICS ? GLASS_REQUIRE_EXTRINSICS :
           kind == ParameterBlock::TARGETS ? 0 : GLASS_REQUIRE_WINDOW;
}

//! A standard deviation of a coordinate beyond which it is not determined.
double largestSigma(const ParameterBlock& block, int i, double range)
{
    const double MAX_ANGLE_SIGMA = CV_PI/4;
    if (block.kind == ParameterBlock::EXTRINSICS)
        return i < 3 ? MAX_ANGLE_SIGMA : range;
    if (block.kind == ParameterBlock::LENS)
        return i < 2 ? block.values[i] : std::numeric_limits<double>::infinity();
    switch (kindOf(block.at, (block.kind == ParameterBlock::PLACE ? block.at.normal : block.at.media) + i))
    {
    case WindowParameter::NORMAL: case WindowParameter::AXIS: return MAX_ANGLE_SIGMA;
    case WindowParameter::DISTANCE: case WindowParameter::CENTER: return range;
    case WindowParameter::WEDGE: return MAX_WEDGE_SIGMA;
    case WindowParameter::CURVATURE: return 1/range;
    default: return block.values[i];
    }
}

/** Boards parallel to the image tell a focal length by their tilt's perspective alone, to which noise adds: of a relative deviation e
the estimate is too long by some e^2, and a +- of the linearised problem is one as long as that is a tenth of it. So it is of what
images without a window tell, and nothing else. */
bool isFocalLengthOfBoards(const Problem& problem, const ParameterBlock& block, int i)
{
    if (block.kind != ParameterBlock::LENS || i > 1 || problem.hasScene())
        return false;
    if (std::find(block.names.begin(), block.names.end(), "r0") != block.names.end())
        return false;           // a coefficient that scales the focal length: they are large together
    if (block.sqrtInformation.rows() > 0 && !block.sqrtInformation.col(i).isZero(0))
        return false;
    return std::any_of(problem.images().begin(), problem.images().end(), [&](const Image& image) {
        return image.camera == block.index && !(image.refracted && problem.rig().cameras[image.camera].refracts()); });
}

std::vector<FreeParameter> freeParameters(const Problem& problem, int required)
{
    const double MAX_FOCAL_SIGMA = 0.1;
    const double infinity = std::numeric_limits<double>::infinity(), range = meanRange(problem.poses());
    std::vector<FreeParameter> parameters;
    for (const ParameterBlock& block : problem.blocks())
        for (int i = 0; i < (int)block.values.size(); i++)
        {
            const bool isDirection = block.isOnManifold();      // of three coordinates two are free: those of no axis
            if (block.kind == ParameterBlock::POSE || !block.isFree[i] || (isDirection && i % 3 == 2))
                continue;
            FreeParameter p;
            p.name = isDirection ? String(block.names[i].substr(0, block.names[i].find('['))) : block.names[i];
            if (block.kind != ParameterBlock::TARGETS && problem.cameraCount() > (block.kind == ParameterBlock::EXTRINSICS ? 2 : 1))
                p.name += format(" of camera %d", block.index + 1);
            p.block = &block;
            p.coordinate = i;
            p.maxSigma = required & requirementOf(block.kind) ? largestSigma(block, i, range) : infinity;
            p.maxLinear = isFocalLengthOfBoards(problem, block, i) ? MAX_FOCAL_SIGMA*p.maxSigma : infinity;
            parameters.push_back(p);
        }
    return parameters;
}

/** Names the parameters that take part in what is undetermined.
@param part of each parameter
@param dimension of what is undetermined
@param sigma standard deviations; may be empty */
FitOutcome undetermined(const std::vector<FreeParameter>& parameters, const VectorXd& part, int dimension, const VectorXd& sigma)
{
    const double NaN = std::numeric_limits<double>::quiet_NaN();
    FitOutcome outcome(FitOutcome::UNDETERMINED);
    outcome.dimension = dimension;
    for (int i = 0; i < (int)parameters.size(); i++)
    {
        const FreeParameter& p = parameters[i];
        const auto takesPart = [&](int j) { return part[j] >= 0.2*part.maxCoeff(); };
        if (!takesPart(i))
            continue;
        outcome.parameters.push_back({ p.name, p.isNumber() ? p.value() : NaN,
                                       p.isNumber() && sigma.size() > 0 ? sigma[i] : NaN });
        const WindowLayout& at = p.block->at;
        for (int j = i + 1; j < (int)parameters.size(); j++)
            if (p.isThickness() && parameters[j].block == p.block && takesPart(j) &&
                parameters[j].coordinate - p.coordinate == at.index - at.thickness)
                outcome.opticalThickness = p.value()*(1 - p.block->values[at.outerIndex - at.media]/parameters[j].value());
    }
    return outcome;
}

//! 1 for every parameter that is beyond its limit or tied to the worst one, else 0.
VectorXd excessivePart(const MatrixXd& half, const VectorXd& excess, int worst)
{
    const double TIED = 0.9;        // correlation
    const MatrixXd unit = half.rowwise().normalized();
    VectorXd part = VectorXd::Zero(excess.size());
    for (int i = 0; i < excess.size(); i++)
        if (excess[i] > 1 || std::abs(unit.row(i).dot(unit.row(worst))) > TIED)
            part[i] = 1;
    return part;
}

//! H, H H^T = covariance of the cameras' parameters for unit pixel noise; not if a direction is lost.
FitOutcome setHalf(const std::vector<FreeParameter>& parameters, const Information& information, MatrixXd& half)
{
    const int count = (int)parameters.size();
    half.resize(count, 0);
    if (count == 0)
        return FitOutcome();
    // What has no effect at all is lost as well.
    const VectorXd scale = (information.effect.head(count).array() > 0).select(information.effect.head(count).cwiseInverse(), 0.);
    const SingularValues svd(information.root*scale.asDiagonal());
    // The rows may be fewer than the parameters.
    VectorXd values = VectorXd::Zero(count);
    values.head(svd.values.size()) = svd.values;
    const int lost = (int)(values.array() < information.rounding).count();
    if (lost > 0)
        return undetermined(parameters, svd.V.rightCols(lost).rowwise().norm(), lost, VectorXd());
    half = scale.asDiagonal()*svd.V*values.cwiseInverse().asDiagonal();
    return FitOutcome();
}

//! Whether some standard deviation is no answer.
FitOutcome checkSigmas(const std::vector<FreeParameter>& parameters, const MatrixXd& half, double variance)
{
    const double floor = std::max(variance, LEAST_SIGMA*LEAST_SIGMA);
    const VectorXd sigma = half.rowwise().norm()*std::sqrt(floor);
    VectorXd excess(parameters.size());
    for (int i = 0; i < (int)parameters.size(); i++)
        excess[i] = std::max(sigma[i]/parameters[i].maxSigma, sigma[i]*std::sqrt(variance/floor)/parameters[i].maxLinear);
    const int worst = (int)(std::max_element(excess.data(), excess.data() + excess.size()) - excess.data());
    if (excess.size() > 0 && excess[worst] > 1)
        return undetermined(parameters, excessivePart(half, excess, worst), 1, sigma);
    return FitOutcome();
}

} // namespace

FitOutcome Covariance::compute(const Problem& problem, double variance, int required)
{
    problem_ = &problem;
    variance_ = variance;
    information_ = informationOf(problem);
    // An image without derivatives: what the others tell is not all.
    if (!information_.residual.allFinite() || !information_.poses.residual.allFinite())
        return FitOutcome(FitOutcome::MAX_ITERATIONS);
    const std::vector<FreeParameter> parameters = freeParameters(problem, required);
    const FreeSpace space(problem);
    if (information_.poses.factor.lost() >= 0)
    {
        FitOutcome outcome(FitOutcome::POSE_UNDETERMINED);
        for (int view = 0; view < problem.viewCount(); view++)
            if (space.placeOf(problem.poseBlock(view)) == information_.poses.factor.lost())
                outcome.view = view;
        return outcome;
    }
    MatrixXd half;
    FitOutcome outcome = setHalf(parameters, information_, half);
    if (outcome.converged())
        outcome = checkSigmas(parameters, half, variance);
    if (!outcome.converged())
        return outcome;
    information_.equations.reset();     // they were what made the factor
    // What the cameras' covariance says of a weak direction so holds for poses and points.
    outer_ = OuterCovariance(information_, half);
    cameras_ = space.cameraCount();
    setParameters();
    return outcome;
}

void Covariance::setParameters()
{
    ofParameters = MatrixXd::Zero(problem_->publicCount(), problem_->publicCount());
    const MatrixXd half = outer_.half().topRows(cameras_);
    if (half.size() == 0)               // only poses or points are free; Eigen has no products of nothing
        return;
    const MatrixXd all = product(problem_->publicBasis(), half);
    ofParameters = variance_*timesTranspose(all, all);
}

void Covariance::widen(Problem& problem)
{
    MatrixXd half = outer_.half();
    if (!widenByProfiles(problem, information_, variance_, half))
        return;
    outer_.setHalf(half);
    setParameters();
}

size_t Covariance::bytes() const
{
    size_t all = information_.poses.factor.bytes();
    for (const InnerBlock& block : information_.inner)
        all += sizeof(double)*block.byOuter.size() + sizeof(int)*block.columns.size();
    return all;
}

void Covariance::forgetPoses()
{
    poses_ = FORGOTTEN;
    outer_ = OuterCovariance();
    information_.poses = ScenePoses();
    for (InnerBlock& block : information_.inner)
    {
        block.byOuter.resize(0, 0);
        std::vector<int>().swap(block.columns);
    }
}

void Covariance::invertPoses()
{
    if (poses_ == FACTORED)
        outer_.invertPoses(std::move(information_.poses.factor));
    poses_ = poses_ == FACTORED ? INVERTED : poses_;
}

//! X = (1 + e) p, with the points p in the unit of the lengths and the error e that these share.
Mat Covariance::ofPoints()
{
    invertPoses();
    const std::vector<Cluster>& clusters = problem_->scene().clusters();
    const double scale = problem_->sceneScale();
    const int error = problem_->targetBlock() < 0 ? -1 : FreeSpace(*problem_).first[problem_->targetBlock()];
    Mat_<double> deviations(problem_->scene().pointCount(), 3, std::numeric_limits<double>::quiet_NaN());
    parallel_for_(Range(0, (int)clusters.size()), [&](const Range& range)
    {
        for (int i = range.start; i < range.end; i++)
        {
            const InnerBlock& block = information_.inner[i];
            VectorXd variances = scale*scale*block.half.rowwise().squaredNorm();
            MatrixXd byOuter = scale*block.byOuter;
            if (error >= 0 && poses_ == INVERTED)
                byOuter.col(std::lower_bound(block.columns.begin(), block.columns.end(), error) - block.columns.begin()) +=
                    clusters[i].values;
            if (byOuter.size() > 0)
                variances += product(byOuter, outer_.of(block.columns)).cwiseProduct(byOuter).rowwise().sum();
            for (int k = 0; k < clusters[i].size(); k++)
                deviations(clusters[i].points[k/3], k % 3) = block.isDetermined ? std::sqrt(variance_*variances[k])
                                                                                : std::numeric_limits<double>::infinity();
        }
    });
    return deviations;
}

std::vector<Mat> Covariance::ofPoses()
{
    invertPoses();
    const FreeSpace space(*problem_);
    std::vector<Mat> all;
    for (int view = 0; view < problem_->viewCount(); view++)
    {
        const int block = problem_->poseBlock(view);
        const bool isAdjusted = space.placeOf(block) >= 0, isKnown = problem_->pose(view).found && (poses_ == INVERTED || !isAdjusted);
        all.push_back(Mat(6, 6, CV_64F, Scalar(isKnown ? 0 : std::numeric_limits<double>::quiet_NaN())));
        if (!isAdjusted || !isKnown)
            continue;
        std::vector<int> columns(6);
        std::iota(columns.begin(), columns.end(), space.first[block]);
        eigen2cv(MatrixXd(variance_*outer_.of(columns)), all.back());
    }
    return all;
}

}} // namespace
