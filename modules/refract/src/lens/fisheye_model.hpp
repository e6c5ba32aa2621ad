// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_FISHEYE_MODEL_HPP
#define OPENCV_REFRACT_FISHEYE_MODEL_HPP

#include "lens/lens_kernels.hpp"

/* The formula of cv::fisheye's model (lens_fisheye.cpp states it), for one point (T = double) and for many (T = Lanes). */

namespace cv { namespace refract {

//! cv::fisheye's model.
struct FisheyeModel
{
    double fx, fy, cx, cy, alpha;
    double k[4];
    double thetaMax;
    double inverse[TERMS];      //!< theta = theta_d (1 + theta_d^2 (inverse[0] + theta_d^2 (...))): where the search begins
};

const LensKernels<FisheyeModel>& fisheyeKernels();

namespace {

//! theta_d / theta and d theta_d / d theta, by theta^2.
template<typename T>
inline void bendFactor(const FisheyeModel& m, T s, T& factor, T& slope)
{
    const double* k = m.k;
    factor = 1 + s*(k[0] + s*(k[1] + s*(k[2] + s*k[3])));
    slope = 1 + s*(3*k[0] + s*(5*k[1] + s*(7*k[2] + s*(9*k[3]))));
}

}}} // namespace

#endif // OPENCV_REFRACT_FISHEYE_MODEL_HPP
