// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Covariance = s^2 A^-1 of the free parameters; s^2: variance of a pixel coordinate, A = R^T R: information.hpp.

Refused, by name: what R, with each parameter scaled to its own effect, maps to next to nothing, and parameters that are
required and whose standard deviation is so large that the value is no answer. */

#include "calibrate/covariance.hpp"
#include "calibrate/information.hpp"
#include <Eigen/SVD>

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Below this part of its own effect, what a parameter does that others cannot do is the derivatives' rounding error.
const double SINGULAR = 1e-9;
// Nobody finds points better than this: without it, noise-free data would seem to determine anything.
const double LEAST_SIGMA = 0.01;

struct FreeParameter
{
    const RigBlock* block;
    int coordinate;
    String name;
    double hopeless;        //!< a standard deviation beyond this is no answer

    double value() const { return block->values[coordinate]; }
    bool isThickness() const
    { return block->kind == RigBlock::MEDIA && block->windowParameter(coordinate) == WindowParameter::THICKNESS; }
    bool isNumber() const { return block->kind == RigBlock::LENS || block->kind == RigBlock::MEDIA; }
};

double meanRange(const RigProblem& rig)
{
    double sum = 0;
    int count = 0;
    for (int view = 0; view < rig.viewCount(); view++)
        if (rig.pose(view).found)
        {
            sum += norm(rig.pose(view).tvec);
            count++;
        }
    return sum/count;
}

//! The GLASS_REQUIRE_... flag of a block.
int requirementOf(RigBlock::Kind kind)
{
    return kind == RigBlock::LENS ? GLASS_REQUIRE_INTRINSICS : kind == RigBlock::EXTRINSICS ? GLASS_REQUIRE_EXTRINSICS :
           GLASS_REQUIRE_WINDOW;
}

std::vector<FreeParameter> freeParameters(const RigProblem& rig, int required)
{
    const double infinity = std::numeric_limits<double>::infinity(), range = meanRange(rig);
    std::vector<FreeParameter> parameters;
    for (const RigBlock& block : rig.blocks())
        for (int i = 0; i < (int)block.values.size(); i++)
        {
            if (!block.isFree[i] || (block.kind == RigBlock::NORMAL && i == 2))     // a normal has two
                continue;
            FreeParameter p;
            p.name = block.kind == RigBlock::NORMAL ? "normal" : block.names[i];
            if (rig.cameraCount() > (block.kind == RigBlock::EXTRINSICS ? 2 : 1))
                p.name += format(" of camera %d", block.camera + 1);
            p.block = &block;
            p.coordinate = i;
            const bool isAngle = block.kind == RigBlock::NORMAL || (block.kind == RigBlock::EXTRINSICS && i < 3);
            const bool isLength = block.kind == RigBlock::MEDIA ? block.windowParameter(i) == WindowParameter::DISTANCE :
                                  block.kind == RigBlock::EXTRINSICS && i >= 3;
            p.hopeless = !(required & requirementOf(block.kind)) ? infinity : isAngle ? CV_PI/4 : isLength ? range :
                block.kind == RigBlock::MEDIA || i < 2 ? p.value() : infinity;
            parameters.push_back(p);
        }
    return parameters;
}

/** Throws, naming the parameters that take part in what is undetermined.
@param part of each parameter
@param dimension of what is undetermined
@param sigma standard deviations; may be empty */
void refuse(const std::vector<FreeParameter>& parameters, const VectorXd& part, int dimension, const VectorXd& sigma)
{
    std::vector<String> words;
    String hint;
    for (int i = 0; i < (int)parameters.size(); i++)
    {
        const FreeParameter& p = parameters[i];
        const auto takesPart = [&](int j) { return part[j] >= 0.2*part.maxCoeff(); };
        if (!takesPart(i))
            continue;
        String word = p.name;
        if (p.isNumber())
            word += format(" = %.4g", p.value());
        if (p.isNumber() && sigma.size() > 0)
            word += format(" +- %.2g", sigma[i]);
        if (std::find(words.begin(), words.end(), word) == words.end())     // two angles of one normal
            words.push_back(word);
        const WindowLayout& at = p.block->at;
        for (int j = i + 1; j < (int)parameters.size(); j++)
            if (p.isThickness() && parameters[j].block == p.block && takesPart(j) &&
                parameters[j].coordinate - p.coordinate == at.index - at.thickness)
                hint += format("; at small angles only thickness (1 - outerIndex/index) = %.4g shows",
                               p.value()*(1 - p.block->values[at.outerIndex - at.media]/parameters[j].value()));
    }
    String text;
    for (size_t i = 0; i < words.size(); i++)
        text += (i == 0 ? "" : i + 1 < words.size() ? ", " : " and ") + words[i];
    if ((int)words.size() > dimension)
        text += hint.empty() ? String("; only combinations of them show") : hint;
    CV_Error_(Error::StsNoConv, ("the views do not determine %s. Fix what is known otherwise, or add views: pairs without "
                                 "and with the window, more tilt, more depth", text.c_str()));
}

//! 1 for every parameter that is beyond its limit or tied to the worst one, else 0.
VectorXd hopelessPart(const MatrixXd& half, const VectorXd& excess, int worst)
{
    const double TIED = 0.9;        // correlation
    const MatrixXd unit = half.rowwise().normalized();
    VectorXd part = VectorXd::Zero(excess.size());
    for (int i = 0; i < excess.size(); i++)
        if (excess[i] > 1 || std::abs(unit.row(i).dot(unit.row(worst))) > TIED)
            part[i] = 1;
    return part;
}

//! H, H H^T = covariance of the free parameters for unit pixel noise; refuses if a direction is lost.
MatrixXd halfCovariance(const std::vector<FreeParameter>& parameters, const Information& information)
{
    for (int i = 0; i < (int)parameters.size(); i++)
        if (!(information.effect[i] > 0))
            refuse(parameters, VectorXd::Unit(parameters.size(), i), 1, VectorXd());

    const VectorXd scale = information.effect.cwiseInverse();
    const Eigen::JacobiSVD<MatrixXd> svd(information.root*scale.asDiagonal(), Eigen::ComputeFullV);
    const int undetermined = (int)(svd.singularValues().array() < SINGULAR).count();
    if (undetermined > 0)
        refuse(parameters, svd.matrixV().rightCols(undetermined).rowwise().norm(), undetermined, VectorXd());
    return scale.asDiagonal()*svd.matrixV()*svd.singularValues().cwiseInverse().asDiagonal();
}

//! Refuses if a standard deviation is no answer.
void refuseHopeless(const std::vector<FreeParameter>& parameters, const MatrixXd& half, double variance)
{
    const double floor = std::max(variance, LEAST_SIGMA*LEAST_SIGMA);
    const VectorXd sigma = half.rowwise().norm()*std::sqrt(floor);
    VectorXd excess(parameters.size());
    for (int i = 0; i < (int)parameters.size(); i++)
        excess[i] = sigma[i]/parameters[i].hopeless;
    int worst;
    if (excess.maxCoeff(&worst) > 1)
        refuse(parameters, hopelessPart(half, excess, worst), 1, sigma);
}

} // namespace

MatrixXd publicCovariance(const RigProblem& rig, const MatrixXd& half, double variance)
{
    if (half.size() == 0)       // only poses and points are free
        return MatrixXd::Zero(rig.publicCount(), rig.publicCount());
    const MatrixXd all = rig.publicBasis()*half;
    return variance*all*all.transpose();
}

MatrixXd rigCovariance(const RigProblem& rig, double variance, int required)
{
    const std::vector<FreeParameter> parameters = freeParameters(rig, required);
    const MatrixXd half = halfCovariance(parameters, rigInformation(rig));
    refuseHopeless(parameters, half, variance);
    return publicCovariance(rig, half, variance);
}

MatrixXd halfCovariance(const RigProblem& rig, const Information& information)
{
    if (information.effect.size() == 0)
        return MatrixXd(0, 0);
    return halfCovariance(freeParameters(rig, 0), information);
}

}} // namespace
