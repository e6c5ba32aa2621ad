// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_CHANCE_HPP
#define OPENCV_REFRACT_CHANCE_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

//! What random samples find where nothing is right.
struct Sampling
{
    int size;               //!< of a sample
    double answers;         //!< of a sample, on average
    double chance;          //!< that an answer agrees with a pixel strewn evenly over the image
};

/** Whether as many of `count` would agree with some answer if all were strewn: the expected number of sets of so many, of which a
sample gives an answer that the others agree with (@cite MoisanStival2004), is one or more. All of them are no chance. */
bool isChance(int count, int agreeing, const Sampling& sampling);

//! Width and height of the part of an image that has these pixels.
Size2d extentOf(const std::vector<Point2d>& pixels);

}} // namespace

#endif // OPENCV_REFRACT_CHANCE_HPP
