// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_DISPARITY_HPP
#define OPENCV_REFRACT_DISPARITY_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

//! A disparity image of whatever type calib3d takes; what has none is NaN.
class Disparity
{
public:
    //! handleMissingValues: the image's smallest value is none.
    Disparity(InputArray disparity, bool handleMissingValues);
    Size size() const { return image_.size(); }
    const float* row(int y) const { return image_.ptr<float>(y); }
    const Mat& image() const { return image_; }     //!< CV_32F

private:
    Mat image_;
};

}} // namespace

#endif // OPENCV_REFRACT_DISPARITY_HPP
