// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_COPLANARITY_HPP
#define OPENCV_REFRACT_COPLANARITY_HPP

#include "arrays/views.hpp"
#include "camera/camera.hpp"

namespace cv { namespace refract {

/** Normals of a plane-parallel window by the images through it alone, whatever its distance, its thickness and the media are: a point,
its ray within the camera and the window's normal through the camera lie in one plane (@cite Agrawal2012, section 3). Where the window
bends rays by little, or its faces are not parallel, they are no more than a start.
@return the best one and others, of other tilts, that the images do not exclude; nothing where no view has enough points */
std::vector<Vec3d> normalsByCoplanarity(const Camera& camera, const RigViews& views);

}} // namespace

#endif // OPENCV_REFRACT_COPLANARITY_HPP
