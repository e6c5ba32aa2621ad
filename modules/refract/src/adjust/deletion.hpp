// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_DELETION_HPP
#define OPENCV_REFRACT_DELETION_HPP

#include "adjust/problem.hpp"
#include "math/studentized.hpp"

namespace cv { namespace refract {

/** Every observation against the others, whether it has a weight or not, per image, per point of it.
@param isInlier whether it has one
@param isAsked which ones are wanted; the others, and those without an image, have no dimension */
std::vector<std::vector<DeletionResidual> > deletionResiduals(const Problem& problem, const Masks& isInlier, const Masks& isAsked);

}} // namespace

#endif // OPENCV_REFRACT_DELETION_HPP
