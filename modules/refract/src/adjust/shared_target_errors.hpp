// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_SHARED_TARGET_ERRORS_HPP
#define OPENCV_REFRACT_SHARED_TARGET_ERRORS_HPP

#include "math/rotation.hpp"

namespace cv { namespace refract {

struct SimilarityTransform
{
    Matx33d A;                          //!< rotation times scale
    Vec3d t;
    Vec3d apply(const Vec3d& X) const { return A*X + t; }
};

/** Systematic errors of the targets that all views share: the scale of their points (a printed square is not as large as its
drawing), and one motion of all of them, or of the camera's mount, between the direct and the refracted images. In camera 1:

    direct: X = (1 + e) R Xo + t,    refracted: X = M ((1 + e) R Xo + t) + d

Known by a prior: nuisance parameters of the problem. */
struct SharedTargetErrors
{
    static const int COUNT = 7;         //!< e, rotation vector of M, d
    SharedTargetErrors() : rotation(Vec3d().val) {}
    explicit SharedTargetErrors(const double* values) : scale(1 + values[0]), rotation(values + 1), translation(values + 4) {}

    //! Object -> camera 1 in an image, of a target whose pose (in the direct images) is this.
    SimilarityTransform place(const Matx33d& R, const Vec3d& t, bool refracted) const
    {
        const SimilarityTransform direct = { R*scale, t };
        return refracted ? SimilarityTransform{ rotation.R*direct.A, rotation.R*t + translation } : direct;
    }

    double scale = 1;
    Rotation rotation;                  //!< M
    Vec3d translation;                  //!< d
};

}} // namespace

#endif // OPENCV_REFRACT_SHARED_TARGET_ERRORS_HPP
