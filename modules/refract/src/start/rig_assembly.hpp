// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIG_ASSEMBLY_HPP
#define OPENCV_REFRACT_RIG_ASSEMBLY_HPP

#include "start/multi_start.hpp"

namespace cv { namespace refract {

//! One camera and the targets in its frame.
struct CameraHypothesis
{
    Camera camera;
    std::vector<Pose> poses;
};

/** All cameras as they see the targets; behind a shared window that of one of them.
@param windowFrom per camera, whose window its owner gets
@return false if some camera looks away from its window then */
bool assemble(const Rig& given, const std::vector<CameraHypothesis>& cameras, const std::vector<int>& windowFrom,
              const RigViews& views, int flags, RigStart& start);

/** Moves cameras to where the views that they have in common with others show them, if the images fit there clearly better than where
they are given. From far off a fit turns a flat target to its other pose, or comes to no end.
@param known poses of the targets; empty: none is
@return whether any was moved */
bool placeByViews(const RigViews& views, const std::vector<Pose>& known, Rig& rig);

/** The cameras of a fit, each with the targets in its own frame.
@param before which views each saw well enough */
std::vector<CameraHypothesis> camerasOf(const Minimum& minimum, const std::vector<CameraHypothesis>& before);

}} // namespace

#endif // OPENCV_REFRACT_RIG_ASSEMBLY_HPP
