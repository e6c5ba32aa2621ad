#ifndef REFRACT_TOOLS_RIG_CHECKS_HPP
#define REFRACT_TOOLS_RIG_CHECKS_HPP

#include "calibrate_rig.hpp"
#include <limits>

/* What a user would do instead, on the same images, and what the fit predicts of images that it has not seen. In all of
these every board pose is fitted to its single image again (refractiveSolvePnP), so that the numbers compare. */
namespace tools {

const double NONE = std::numeric_limits<double>::quiet_NaN();

//! RMS px of the images through the window, all cameras; NaN where it could not be computed.
struct Baselines
{
    std::vector<double> glassIgnored;       //!< per camera: the start's lens alone
    std::vector<double> shift;              //!< the same, board where the direct image of the pair shows it
    std::vector<double> throughGlass;       //!< per camera: a pinhole camera calibrated on the glass images
};

Baselines computeBaselines(const RigData& data, const Rig& start, const std::vector<LensSource>& lensSources);

/** Calibrated on the boards of one half of the range, tested on the other. A central camera fitted through the glass
absorbs the window at the range it was calibrated at, and nowhere else. */
struct NearFar
{
    bool done = false;              //!< false: too few images through the window
    double nearRange[2], farRange[2];                       //!< board distance from camera 1, from - to
    double windowNearToFar = NONE, windowFarToNear = NONE;  //!< RMS px on the half not used
    double pinholeNearToFar = NONE, pinholeFarToNear = NONE;
};

NearFar crossValidate(const RigData& data, const Rig& start, const Fit& fit, int flags,
                      const std::vector<LensSource>& lensSources);

//! How far the normal of each camera turns (degrees) if one moment is left out.
struct Influence
{
    int moment;
    double turnDeg[2];              //!< NaN: not determined without it
};

//! Moments with a glass image; empty if there are fewer than three.
std::vector<Influence> leaveOneOut(const RigData& data, const Fit& fit, int flags, bool quiet);

} // namespace tools

#endif // REFRACT_TOOLS_RIG_CHECKS_HPP
