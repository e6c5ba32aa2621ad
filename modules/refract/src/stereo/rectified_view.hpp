// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RECTIFIED_VIEW_HPP
#define OPENCV_REFRACT_RECTIFIED_VIEW_HPP

#include "points/map.hpp"
#include "stereo/rectified_projection.hpp"

namespace cv { namespace refract {

/** One image of a rectified pair, and the surface that it shows: a plane, or a depth for each of its pixels. Pixels are of the
rectified image; depth is z in the rectified frame, which P projects. */
class RectifiedView
{
public:
    //! What the caller calls the arguments.
    struct Names
    {
        const char* R;
        const char* P;
        const char* depth;
    };

    /** @param T camera 1 -> this camera; empty for camera 1
    @param depth z, a plane (a, b, c, d) of the rectified frame, or z of each pixel
    @param size of the rectified image */
    RectifiedView(const Camera& camera, InputArray R, InputArray P, InputArray T, InputArray depth, Size size, const Names& names);

    const PinholeView& pinhole() const { return pinhole_; }
    //! Each pixel has a depth of its own; else pinhole().plane is what it shows.
    bool hasDepths() const { return !depths_.empty(); }
    //! plane[3] of pinhole() for some pixels of a row.
    void load(int row, int column, int n, double* planeD) const;
    //! The same between pixels; NaN outside of the image.
    void interpolate(int n, const double* x, const double* y, double* planeD) const;

    const Matx33d& R() const { return R_; }
    const RectifiedProjection& projection() const { return projection_; }

private:
    void see(const Vec4d& plane);       //!< of the rectified frame

    Matx33d R_;
    RectifiedProjection projection_;
    Vec3d T_;
    Mat depths_;
    double shift_;          //!< depth -> d of the plane z = depth in the frame of the camera
    PinholeView pinhole_;
};

//! R1, R2 and T, R of one pair, or the error that says they are not.
void checkRectification(const Matx33d& R1, const Matx33d& R2, const Matx33d& R);

}} // namespace

#endif // OPENCV_REFRACT_RECTIFIED_VIEW_HPP
