// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_START_TABLE_HPP
#define OPENCV_REFRACT_START_TABLE_HPP

#include "start/pose_start.hpp"
#include "window/place.hpp"

namespace cv { namespace refract {

/* The hypotheses that searches start from: one table of the tilts and distances of a window. */

//! Normals about the optical axis; of a dome or tube, centres about the camera (placesAround).
struct TiltRing
{
    double tilt;        //!< radians
    int count;
    double first;       //!< where the ring begins, in steps
};
//! Where all but the window is known.
const TiltRing KNOWN_LENS_TILTS[] = { { 0, 1, 0 }, { 0.2, 8, 0 }, { 0.45, 8, 0 } };
//! One more where no fit leads on from a tilt: where it is told which points are wrong.
const TiltRing STEEP_TILTS = { 0.8, 8, 0 };
//! Where each is tried with several lenses.
const TiltRing SEALED_TILTS[] = { { 0.25, 4, 0.5 } };

/** The rig with its windows at other distances, geometric from near the camera to just before the nearest target. A far window looks
like one on the lens that is tilted the other way, and no fit leads from there to here.
@return nothing where windows have no distance (domes, tubes) or no view has a pose */
std::vector<Rig> atOtherDistances(const Rig& rig, const RigViews& views);

}} // namespace

#endif // OPENCV_REFRACT_START_TABLE_HPP
