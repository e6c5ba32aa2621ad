// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SHEET_HPP
#define REFRACT_TOOLS_SHEET_HPP

#include "calibrate/calib_file.hpp"
#include "laser/emitter_prior.hpp"
#include "laser/ridges.hpp"
#include "measure/measurement.hpp"
#include <memory>

/* A sheet of laser light as a plane in the frame of camera 1, a x + b y + c z = d with a unit normal, in the scene's medium; or that of an
emitter behind its own window, which is bent. What it was calibrated with is a part of its error: dstate = noise + byParameters dp, p the
parameters of lens and window of camera 1; the state is a plane's four numbers, or an emitter's as EmitterPrior has it. */
namespace tools {

/* A sheet of light, as far as points are from it. Straight it is a plane; of an emitter behind a window it is what the emitter sees with
the pixels of one u, a ruled surface,

    plane:    e = n . X - d                     state n, d
    emitter:  e = (u(X) - u_0) / |du/dX|        state as EmitterPrior; to first order a distance, as the plane's */

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

struct Sheet
{
    cv::Vec4d plane;            //!< of an emitter's sheet: the nearest to where it was seen
    Emitter emitter = {};       //!< without a camera: the sheet is the plane
    cv::Mat covariance;         //!< of the state, by noise alone
    cv::Mat byParameters;       //!< a row for each number of the state
    double scale = 0.;          //!< px, of the line's profile
    double lineNoise = 0.;      //!< px, of the line's points beyond white noise
    LaserColour colour = LASER_ANY;
    cv::Vec2d depth;            //!< of the points that it was calibrated with
    std::string unit;
    std::string command, time;
};

//! Throws Failure that names the file; also if the sheet was calibrated with another camera.
bool isPlane(const Sheet& sheet);

//! Where the rays of camera 1's pixels meet it; NaN and a RefractiveStatus where they do not.
void pointsOnSheet(const Calibration& calibration, const Sheet& sheet, const std::vector<cv::Point2d>& pixels,
                   std::vector<cv::Point3d>& points, std::vector<uchar>& status);

Sheet readSheet(const std::string& filename, const Calibration& calibration);
void writeSheet(const std::string& filename, const Sheet& sheet, const Calibration& calibration);

//! How points on a sheet move, three rows a point; NaN where there is none.
struct OnSheetDerivatives
{
    MatrixXd byAcross;          //!< by one pixel across the line
    MatrixXd byState;           //!< by the sheet's own error
    MatrixXd byParameters;      //!< by those of camera 1, which move the sheet too
};

OnSheetDerivatives differentiateOnSheet(const Calibration& calibration, const Sheet& sheet, const std::vector<RidgePoint>& line,
                                        const std::vector<cv::Point3d>& points);

/** Where camera rays meet the sheet, with their uncertainty: that of the pixel across the line, of the sheet and of the calibration.
Status REFRACT_PARALLEL_RAYS: the ray lies in the sheet. */
Measurement measureOnSheet(const Calibration& calibration, const Sheet& sheet, const std::vector<RidgePoint>& line);

} // namespace tools

#endif // REFRACT_TOOLS_SHEET_HPP
