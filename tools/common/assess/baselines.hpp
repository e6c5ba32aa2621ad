// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BASELINES_HPP
#define REFRACT_TOOLS_BASELINES_HPP

#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"
#include "calibrate/starting_model.hpp"
#include <cmath>
#include <limits>

/* What a user could do instead with the same images. Every board pose is fitted to its single image, so that the numbers are comparable. */
namespace tools {

const double NONE = std::numeric_limits<double>::quiet_NaN();

//! RMS px with the pose of each board fitted to its one image.
class PooledRms
{
public:
    void add(const std::vector<cv::Point3d>& object, const std::vector<cv::Point2d>& pixels,
             const cv::Ptr<cv::refract::RefractiveCamera>& camera);
    double value() const { return count_ ? std::sqrt(sum_/count_) : NONE; }
private:
    double sum_ = 0.;
    int count_ = 0;
};

//! RMS px of the images through the window, all cameras; NaN where it could not be computed.
struct Baselines
{
    std::vector<double> glassIgnored;       //!< per camera: the start's lens alone
    std::vector<double> shift;              //!< the same, board where the direct image of the pair shows it
    std::vector<double> throughGlass;       //!< per camera: a pinhole camera calibrated on the glass images
};

Baselines computeBaselines(const RigData& data, const RigModel& start, const std::vector<LensSource>& lensSources);

//! The largest RMS of what was fitted to one camera: the pinhole through the glass, or the lens. 0: there is none.
double rmsOfSeparateFits(const Baselines& baselines, const std::vector<LensSource>& lensSources);

} // namespace tools

#endif // REFRACT_TOOLS_BASELINES_HPP
