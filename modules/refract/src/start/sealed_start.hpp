// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_SEALED_START_HPP
#define OPENCV_REFRACT_SEALED_START_HPP

#include "start/rig_task.hpp"
#include "start/pose_start.hpp"
#include "start/window_start.hpp"

namespace cv { namespace refract {

//! A fit from one start, and what it leaves.
struct Trial
{
    Rig start, rig;
    std::vector<Pose> poses;
    double cost;            //!< infinite where a point has no image
    int freedom;
    bool converged;
    bool operator<(const Trial& other) const { return cost < other.cost; }
};

const TermCriteria TO_THE_END(TermCriteria::COUNT + TermCriteria::EPS, 1000, 1e-12);

Trial fitFrom(const RigStart& start, const RigViews& views, const TermCriteria& criteria, int flags);

//! By how much the second is worse, as OtherMinimum::excess.
double excessOver(const Trial& best, const Trial& other);

//! Standard deviations that some views, or one camera alone, leave a minimum behind the best that all have in another.
const double PLAUSIBLE = 10;
//! One of each minimum that could still be the best where all count. All these: the best first.
std::vector<Trial> plausibleTrials(const std::vector<Trial>& sorted);

/** From the best to the other sides of it, as long as that finds a better one: a search meets neither all combinations of
several windows, nor minima that some views do not have.
@param middle where principal points are looked for around
@param sorted gets them too */
void turnOver(const Rig& middle, std::vector<Trial>& sorted, const RigViews& views, const TermCriteria& criteria, int flags);

//! The second best minimum, for the windows that it has elsewhere: rows of the first camera behind each.
void describeOther(const std::vector<Trial>& sorted, std::vector<OtherMinimum>& others);

/** What fits to all views that have a pose end in, the best first; see bestSealedStart. The poses are those of such views. Empty
if no start gives every point an image. */
std::vector<Trial> sealedMinima(const RigStart& given, const RigViews& views, int flags);

/** A sealed rig's cost has more than one minimum: distance against focal length, tilt against principal point and tangential
distortion. Some views are fitted a little from several lenses and distances, and from tilts of one window after the other;
the start is the best of the minima that these lead to when all views count.
@param others one per camera; the second best of these minima */
RigStart bestSealedStart(const RigStart& given, const RigViews& views, int flags, std::vector<OtherMinimum>& others);

}} // namespace

#endif // OPENCV_REFRACT_SEALED_START_HPP
