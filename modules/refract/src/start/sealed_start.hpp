// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_SEALED_START_HPP
#define OPENCV_REFRACT_SEALED_START_HPP

#include "start/multi_start.hpp"

namespace cv { namespace refract {

/** The same rig on the other side of what a tilt is exchanged for: a window tilted the other way, or, with the window as it is,
a lens with its principal point there and no distortion. One after the other; nothing where that is the same.
@param middle where principal points are looked for around */
std::vector<RigStart> mirrored(const Rig& rig, const Rig& middle, int flags);

/** What fits to all views that have a pose end in, the best first; see bestSealedStart. The poses are those of such views. Empty
if no start gives every point an image. */
std::vector<Minimum> sealedMinima(const RigStart& given, const RigViews& views, int flags);

/** A sealed rig's cost has more than one minimum: distance against focal length, tilt against principal point and tangential
distortion. Some views are fitted a little from several lenses and distances, and from tilts of one window after the other;
the start is the best of the minima that these lead to when all views count.
@param others one per camera; the second best of these minima */
RigStart bestSealedStart(const RigStart& given, const RigViews& views, int flags, std::vector<OtherMinimum>& others);

}} // namespace

#endif // OPENCV_REFRACT_SEALED_START_HPP
