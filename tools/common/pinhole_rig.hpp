#ifndef REFRACT_TOOLS_PINHOLE_RIG_HPP
#define REFRACT_TOOLS_PINHOLE_RIG_HPP

#include "calib_file.hpp"
#include "calibrate_rig.hpp"

namespace tools {

/** What a user would do instead: the same images through the window, given to cv::calibrateCamera and
cv::stereoCalibrate as if there were none. For refract_measure --compare-with.
@param coefficients of the lens: 0, 4, 5, 8, 12 or 14 */
Calibration calibratePinholeRig(const RigData& data, int coefficients);

} // namespace tools

#endif // REFRACT_TOOLS_PINHOLE_RIG_HPP
