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

Vec4d quaternionOf(const Matx33d& R)
{
    const double trace = R(0, 0) + R(1, 1) + R(2, 2);
    Vec4d squares(trace, 2*R(0, 0) - trace, 2*R(1, 1) - trace, 2*R(2, 2) - trace);      // 4 q[i]^2 - 1
    const int k = (int)(std::max_element(squares.val, squares.val + 4) - squares.val);
    // 4 q[0] q[i] and 4 q[i] q[j]
    const Matx44d products(1 + squares[0], R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1),
                           R(2, 1) - R(1, 2), 1 + squares[1], R(0, 1) + R(1, 0), R(0, 2) + R(2, 0),
                           R(0, 2) - R(2, 0), R(0, 1) + R(1, 0), 1 + squares[2], R(1, 2) + R(2, 1),
                           R(1, 0) - R(0, 1), R(0, 2) + R(2, 0), R(1, 2) + R(2, 1), 1 + squares[3]);
    const Vec4d q(products.row(k).val);
    return q*((q[0] < 0 ? -1 : 1)/norm(q));
}

/* Not cv::Rodrigues: that takes rotations below 1e-5 for none, a hundredth of a pixel, and has half of the digits of those a little
larger. */
Vec3d rotationVector(const Matx33d& R)
{
    const Vec4d q = quaternionOf(R);
    const Vec3d v(q[1], q[2], q[3]);
    const double sine = norm(v);
    return v*(sine > 0 ? 2*std::atan2(sine, q[0])/sine : 2);
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

Matx33d Rotation::rightJacobian() const
{
    Matx33d J;
    for (int i = 0; i < 3; i++)
    {
        const Matx33d cross = R.t()*dR[i];          // v -> J_i x v
        J(0, i) = 0.5*(cross(2, 1) - cross(1, 2));
        J(1, i) = 0.5*(cross(0, 2) - cross(2, 0));
        J(2, i) = 0.5*(cross(1, 0) - cross(0, 1));
    }
    return J;
}

Matx32d tangents(const Vec3d& u)
{
    const Vec3d a = normalize(u.cross(std::abs(u[0]) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0))), b = u.cross(a);
    return Matx32d(a[0], b[0], a[1], b[1], a[2], b[2]);
}

Matx33d turnToZ(const Vec3d& a)
{
    const Vec3d axis = a.cross(Vec3d(0, 0, 1));
    const double sine = norm(axis);
    return sine > 0 ? rotationMatrix(axis*(std::atan2(sine, a[2])/sine)) : Matx33d::eye();
}

}} // namespace
