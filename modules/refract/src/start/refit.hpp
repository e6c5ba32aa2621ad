// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_REFIT_HPP
#define OPENCV_REFRACT_REFIT_HPP

namespace cv { namespace refract {

/** A flag of calibrateGlassRigExtended that is not of the public header: what is given is where an earlier fit of the same images, or
of some of them, has ended. So no other minima are looked for, unless that fit does not end near. */
const int FROM_EARLIER_FIT = 1 << 30;

}} // namespace

#endif // OPENCV_REFRACT_REFIT_HPP
