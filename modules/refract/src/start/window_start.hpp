// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_WINDOW_START_HPP
#define OPENCV_REFRACT_WINDOW_START_HPP

#include "start/multi_start.hpp"

namespace cv { namespace refract {

//! What one camera saw of targets through its window, in images that give a pose. @param which views these are
RigViews viewsThrough(const RigViews& views, int camera, std::vector<int>& which);

/** The minima that the window of one camera may have, its lens being known, the best first: from tilts and, if the distance is free,
distances (start_table.hpp).
@param views what it saw through it; at least one */
std::vector<Minimum> windowMinima(const Camera& camera, const RigViews& views, int flags);

/** Start of every window: its normal and, if free, its distance; the rest as given. Of a dome or tube the place.

From pairs if there are any; a pose that is known without the window makes every image of its view one of a pair. Else,
with the lens known, some views are fitted from the best few of a ring of tilts, as the cost through the window alone has
more than one minimum, and all views from each distinct one of these; the least cost wins. Else the given window.
A window of unknown distance that is shared is described from now on in the frame of the camera nearest to it (rig.owner): its
distance has a bound at 0, so that no camera comes to lie beyond. Where the start puts one there, the window moves out.
@param poses what is known without windows; a search for a window of unknown distance adds what it found
@param others one per camera; only the given owner's may hold a second minimum
@return LOOKS_AWAY if some camera looks away from its window then */
FitOutcome startWindows(Rig& rig, const RigViews& views, std::vector<Pose>& poses, int flags, std::vector<OtherMinimum>& others);

/** The given place for a window whose start hides what was seen through it: noisy pairs through a thin window have their least
error anywhere. */
FitOutcome keepGivenPlaces(const Rig& given, const RigViews& views, const std::vector<Pose>& poses, Rig& rig);

}} // namespace

#endif // OPENCV_REFRACT_WINDOW_START_HPP
