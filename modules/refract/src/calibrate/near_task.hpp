// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_NEAR_TASK_HPP
#define OPENCV_REFRACT_NEAR_TASK_HPP

#include "calibrate/rig_fit.hpp"
#include "pose/near_origin.hpp"

namespace cv { namespace refract {

/** A pose and what is known of it, of what lies near its origin. Not of a pose that is known in part: that is of the given origin.
@param pose in: far @param prior may be null */
void moveNear(const NearOrigin& origin, Pose& pose, PosePrior* prior);
//! What of a pose is known in all its six numbers, or in none, can be moved.
inline bool canMove(const PosePrior& prior) { return prior.kind == PosePrior::NONE || prior.tellsAll(); }

//! A task whose targets lie near the origins of their coordinates, and the way back.
class NearTask
{
public:
    explicit NearTask(const RigTask& given);
    const RigTask& task() const { return task_; }
    //! Poses and jacobian, for the targets as they were given.
    void moveBack(RigFit& fit) const;
    //! The point that it names.
    void moveBack(FitOutcome& outcome) const;

private:
    RigTask task_;
    std::vector<NearOrigin> origins_;       //!< of each view
};

}} // namespace

#endif // OPENCV_REFRACT_NEAR_TASK_HPP
