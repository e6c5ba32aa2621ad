// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/parameter_block.hpp"
#include "adjust/direction_manifold.hpp"
#include "adjust/rig_prior.hpp"
#include "math/dense.hpp"
#include "window/place.hpp"
#include <ceres/line_manifold.h>
#include <ceres/sphere_manifold.h>
#include <map>

namespace cv { namespace refract {

bool ParameterBlock::isOnManifold() const { return kind == PLACE && at.shape != WINDOW_DOME; }

std::unique_ptr<ceres::Manifold> ParameterBlock::manifold() const
{
    if (!isOnManifold())
        return nullptr;
    std::unique_ptr<ceres::Manifold> directions;
    if (at.shape == WINDOW_TUBE)
        directions.reset(new ceres::LineManifold<3>());
    else
        directions.reset(new ceres::SphereManifold<3>());
    return std::unique_ptr<ceres::Manifold>(new DirectionManifold(std::move(directions)));
}

Eigen::MatrixXd ParameterBlock::tangentBasis(bool withHeld) const
{
    const int size = (int)values.size();
    if (isOnManifold() && isFree[0])
    {
        const std::unique_ptr<ceres::Manifold> curved = manifold();
        RowMajorMatrix basis(size, curved->TangentSize());
        curved->PlusJacobian(values.data(), basis.data());
        return basis.colwise().normalized();    // radians; Ceres' scale differs between versions
    }
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(size, size);
    int column = 0;
    for (int i = 0; i < size; i++)
        if (isFree[i] && (withHeld || !isHeld[i]))
            basis(i, column++) = 1;
    return basis.leftCols(column);
}

//! By the root of the correlations of what is uncertain, as the parameters' sizes differ by orders.
void ParameterBlock::setPrior(const Eigen::MatrixXd& covariance)
{
    const int size = (int)values.size();
    Eigen::MatrixXd known = Eigen::MatrixXd::Zero(size, size);
    for (int i = 0; i < size; i++)
    {
        if (covariance(i, i) > 0 || (kind == TARGETS && std::isnan(covariance(i, i))))
            isFree[i] = true;
        else if ((kind == LENS || kind == EXTRINSICS) && covariance(i, i) == 0)
            isFree[i] = false;
        for (int j = 0; j < size; j++)
            if (covariance(i, i) > 0 && covariance(j, j) > 0)
                known(i, j) = covariance(i, j);
    }
    if (known.isZero(0))
        return;
    if (isOnManifold())
        isFree.assign(size, true);
    const Eigen::MatrixXd tangents = tangentBasis(true);
    const Eigen::VectorXd variances = diagonalOfProduct(transposeTimes(tangents, known), tangents);
    const int count = (int)(variances.array() > 0).count();
    Eigen::MatrixXd directions(size, count);    // each divided by its deviation
    for (int i = 0, k = 0; i < variances.size(); i++)
        if (variances[i] > 0)
            directions.col(k++) = tangents.col(i)/std::sqrt(variances[i]);
    sqrtInformation = whiten(product(transposeTimes(directions, known), directions), directions.transpose());
}

std::vector<bool> freeLens(const Camera& camera, int flags)
{
    static const std::map<String, int> FIXED_BY = {
        { "fx", GLASS_FIX_FOCAL_LENGTH }, { "fy", GLASS_FIX_FOCAL_LENGTH }, { "cx", GLASS_FIX_PRINCIPAL_POINT },
        { "cy", GLASS_FIX_PRINCIPAL_POINT }, { "k1", GLASS_FIX_K1 }, { "k2", GLASS_FIX_K2 }, { "k3", GLASS_FIX_K3 },
        { "k4", GLASS_FIX_K4 }, { "k5", GLASS_FIX_K5 }, { "k6", GLASS_FIX_K6 }, { "p1", GLASS_FIX_TANGENT_DIST },
        { "p2", GLASS_FIX_TANGENT_DIST }, { "s1", GLASS_FIX_S1_S2_S3_S4 }, { "s2", GLASS_FIX_S1_S2_S3_S4 },
        { "s3", GLASS_FIX_S1_S2_S3_S4 }, { "s4", GLASS_FIX_S1_S2_S3_S4 }, { "tauX", GLASS_FIX_TAUX_TAUY },
        { "tauY", GLASS_FIX_TAUX_TAUY } };
    const std::vector<String> names = camera.parameterNames();
    std::vector<bool> isFree;
    for (int i = 0; i < camera.lensCount(); i++)
    {
        const auto fixed = FIXED_BY.find(names[i]);
        isFree.push_back((flags & GLASS_FREE_INTRINSICS) && !camera.lens().isFixed(i)
                         && !(fixed != FIXED_BY.end() && (flags & fixed->second)));
    }
    return isFree;
}

double lowerBoundOfLens(int coordinate, double start)
{
    return coordinate < 2 ? 1e-6*start : -std::numeric_limits<double>::infinity();
}

}} // namespace
