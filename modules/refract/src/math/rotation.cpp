// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/rotation.hpp"

namespace cv { namespace refract {

Matx33d rotationMatrix(const Vec3d& rvec, Matx33d* jacobian)
{
    Matx33d R;
    Mat J;
    cv::Rodrigues(rvec, R, jacobian ? OutputArray(J) : OutputArray(noArray()));
    if (jacobian)
        for (int i = 0; i < 3; i++)         // row i: derivatives of the nine elements by rvec[i]
            jacobian[i] = Matx33d(J.ptr<double>(i));
    return R;
}

Vec3d rotationVector(const Matx33d& R)
{
    Vec3d rvec;
    cv::Rodrigues(R, rvec);
    return rvec;
}

Rotation::Rotation(const double* rvec)
{
    R = rotationMatrix(Vec3d(rvec), dR);
}

Matx33d Rotation::derivativeOf(const Vec3d& v) const
{
    Matx33d d;
    for (int i = 0; i < 3; i++)
    {
        const Vec3d column = dR[i]*v;
        for (int k = 0; k < 3; k++)
            d(k, i) = column[k];
    }
    return d;
}

}} // namespace
