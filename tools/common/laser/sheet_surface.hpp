// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SHEET_SURFACE_HPP
#define REFRACT_TOOLS_SHEET_SURFACE_HPP

#include "laser/emitter_prior.hpp"
#include <memory>

/* A sheet of light, as far as points are from it. Straight it is a plane; of an emitter behind a window it is what the emitter sees with
the pixels of one u, a ruled surface,

    plane:    e = n . X - d                     state n, d
    emitter:  e = (u(X) - u_0) / |du/dX|        state as EmitterPrior; to first order a distance, as the plane's */
namespace tools {

struct SheetDistances
{
    VectorXd e;                     //!< NaN where the sheet cannot be
    MatrixXd byPoint, byState;      //!< a row a point; byPoint: unit normals
};

SheetDistances distancesFromPlane(const cv::Vec4d& plane, const std::vector<cv::Point3d>& points);
SheetDistances distancesFromEmitter(const Emitter& emitter, const std::vector<cv::Point3d>& points);

//! A sheet that is being estimated.
class SheetSurface
{
public:
    virtual ~SheetSurface() = default;
    virtual SheetDistances distances(const std::vector<cv::Point3d>& points) const = 0;
    virtual MatrixXd basis() const = 0;             //!< of the state, by what is free
    //! Of what is free from its prior, in standard deviations; empty: there is no prior.
    virtual VectorXd deviation() const = 0;
    virtual std::shared_ptr<const SheetSurface> moved(const VectorXd& step) const = 0;
    //! Polynomial coefficients of a line on a board that tell of it: middle and slope of a straight one, bend.
    virtual int coefficients() const = 0;
};

class PlaneSurface : public SheetSurface
{
public:
    //! @param coefficients 3, to compare it with a bent sheet
    explicit PlaneSurface(const cv::Vec4d& plane, int coefficients = 2) : plane_(plane), coefficients_(coefficients) {}
    const cv::Vec4d& plane() const { return plane_; }
    SheetDistances distances(const std::vector<cv::Point3d>& points) const override { return distancesFromPlane(plane_, points); }
    MatrixXd basis() const override;
    VectorXd deviation() const override { return VectorXd(); }
    std::shared_ptr<const SheetSurface> moved(const VectorXd& step) const override;
    int coefficients() const override { return coefficients_; }

private:
    cv::Vec4d plane_;
    int coefficients_;
};

class EmitterSurface : public SheetSurface
{
public:
    EmitterSurface(const EmitterPrior& prior, const Emitter& emitter) : prior_(&prior), emitter_(emitter) {}
    const Emitter& emitter() const { return emitter_; }
    SheetDistances distances(const std::vector<cv::Point3d>& points) const override { return distancesFromEmitter(emitter_, points); }
    MatrixXd basis() const override { return prior_->basis(); }
    VectorXd deviation() const override { return prior_->deviation(emitter_); }
    std::shared_ptr<const SheetSurface> moved(const VectorXd& step) const override;
    int coefficients() const override { return 3; }

private:
    const EmitterPrior* prior_;
    Emitter emitter_;
};

} // namespace tools

#endif // REFRACT_TOOLS_SHEET_SURFACE_HPP
