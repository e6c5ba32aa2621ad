// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_A_CONTRARIO_HPP
#define OPENCV_REFRACT_A_CONTRARIO_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

//! What random samples find where nothing is right.
struct Sampling
{
    int size;               //!< of a sample
    double answers;         //!< of a sample, on average
    double chance;          //!< that a uniformly random pixel is an inlier of an answer
};

/** Whether some answer would have as many inliers among `count` uniformly random pixels: the expected number of such sets, each with
a sample whose answer has the others as inliers, is one or more (a contrario, @cite MoisanStival2004). Where all are inliers it is
false. */
bool isExplainedByChance(int count, int inliers, const Sampling& sampling);

//! Width and height of the part of an image that has these pixels.
Size2d extentOf(const std::vector<Point2d>& pixels);

}} // namespace

#endif // OPENCV_REFRACT_A_CONTRARIO_HPP
