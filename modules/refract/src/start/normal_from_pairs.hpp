// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_NORMAL_FROM_PAIRS_HPP
#define OPENCV_REFRACT_NORMAL_FROM_PAIRS_HPP

#include "camera/camera.hpp"
#include "arrays/views.hpp"

namespace cv { namespace refract {

struct NormalEstimate
{
    String undetermined;    //!< empty, or why there is no answer
    Vec3d normal;
    Matx33d covariance;     //!< rank 2; NaN where two pairs leave no residual to scale it by
    double rms;             //!< pixels
};

/** The normal from pairs; see normal_from_pairs.cpp. Only the lens of the camera is used. Views that are empty in one of
the two, and pairs that are not seen in both, are left out. */
NormalEstimate normalFromPairs(const Camera& camera, const PixelViews& direct, const PixelViews& refracted);

/** The same from the views that agree: those whose errors stand out by the normal that the median view likes best are left
out. For targets that were moved within a pair. */
NormalEstimate normalFromInlierPairs(const Camera& camera, const PixelViews& direct, const PixelViews& refracted);

}} // namespace

#endif // OPENCV_REFRACT_NORMAL_FROM_PAIRS_HPP
