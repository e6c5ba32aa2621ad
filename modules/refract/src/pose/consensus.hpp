// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_CONSENSUS_HPP
#define OPENCV_REFRACT_CONSENSUS_HPP

#include "math/rigid_transform.hpp"

namespace cv { namespace refract {

//! A pose and its inliers.
struct Consensus
{
    RigidTransform motion;
    double cost = DBL_MAX;              //!< MSAC (@cite TorrZisserman2000): sum of squared errors, each cut off at the limit
    std::vector<int> inliers;
    std::vector<double> errors;         //!< of the inliers

    //! The next observation's error; NaN is none.
    void add(int index, double error, double limit)
    {
        const bool isInlier = std::abs(error) <= limit;
        cost += isInlier ? error*error : limit*limit;
        if (!isInlier)
            return;
        inliers.push_back(index);
        errors.push_back(error);
    }
};

}} // namespace

#endif // OPENCV_REFRACT_CONSENSUS_HPP
