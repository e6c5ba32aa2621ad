// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_HELD_OUT_HPP
#define OPENCV_REFRACT_HELD_OUT_HPP

#include "adjust/problem.hpp"

namespace cv { namespace refract {

const int MIN_HELD_OUT_VIEWS = 4;       //!< with fewer views their regions are held out

//! A part of the observations, and its errors when all the others determine the parameters.
struct HeldOutPart
{
    double squares = 0;                 //!< px^2; infinite: without this part they determine less than with it
    int points = 0;
};

/** Views, each with a pose of its own, or, of too few views, regions of them with the pose that the others of the view
determine. The problem is at its least squares. */
std::vector<HeldOutPart> heldOutErrors(const Problem& problem);

}} // namespace

#endif // OPENCV_REFRACT_HELD_OUT_HPP
