// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MEASURED_DOUBTS_HPP
#define REFRACT_TOOLS_MEASURED_DOUBTS_HPP

#include "calibrate/rig_data.hpp"
#include "measure/measured_views.hpp"
#include "measure/measurement.hpp"
#include <optional>

/* What speaks against measured points, in sentences; empty: nothing does. */
namespace tools {

/* Pixels that no image has. The lens model answers for them too, somewhere, with a +- as good as any other. */

/** Points with a pixel more than a pixel outside of its image become NaN with the status OUTSIDE_IMAGE. To be called before their
consistency is checked, which they would distort. Cameras whose image size is not known are left out. */
void forgetOutside(const Calibration& calibration, Measurement& measurement);

/* Do lengths that were measured agree with those of a target? Their mean ratio is known far better than any of them, by the noise of all
pixels and the calibration's covariance, in which their errors are common. */

//! Distances between neighbouring points, measured minus true.
std::vector<double> lengthErrors(const View& view, const std::vector<cv::Point3d>& points);

struct LengthScale
{
    double ratio = 1.;      //!< measured over true, the mean of all neighbours on the target; 1 where there are none
    double sigma;           //!< one standard deviation of it; NaN: unknown

    //! Standard deviations from 1; 0 where unknown.
    double deviations() const;
};

/** Of points that were triangulated, or lie on a plane that is exact.
@param views the target's shape and neighbours. @param results of each view; points that contradict themselves are left out
@param pixelSigma px, NaN: unknown. @param targetSigma of the target's scale, relative */
LengthScale lengthScaleOf(const Calibration& calibration, const std::vector<View>& views, const std::vector<Measurement>& results,
                          double pixelSigma, double targetSigma, const std::optional<cv::Vec4d>& plane = std::nullopt);

//! Pixels that contradict each other by more than noise and calibration explain.
std::string contradictionIn(const std::vector<MeasuredView>& measured, const std::vector<Measurement>& results);

//! Points outside of their images.
std::string outsideImages(const Calibration& calibration, const std::vector<MeasuredView>& measured,
                          const std::vector<Measurement>& results);

bool mostContradict(const std::vector<Measurement>& results);

//! Lengths that are not the target's. @param plane that points were measured on; none: they were triangulated
std::string wrongLengths(double square, const Calibration& calibration, const std::vector<MeasuredView>& measured,
                         const std::vector<Measurement>& results, double pixelSigma, const std::optional<cv::Vec4d>& plane);

std::string noisierImages(const std::vector<MeasuredView>& measured, const std::vector<Measurement>& results, double pixelSigma);

} // namespace tools

#endif // REFRACT_TOOLS_MEASURED_DOUBTS_HPP
