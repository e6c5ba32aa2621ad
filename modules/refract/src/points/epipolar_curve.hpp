// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_EPIPOLAR_CURVE_HPP
#define OPENCV_REFRACT_EPIPOLAR_CURVE_HPP

#include "arrays/arrays.hpp"
#include "camera/camera.hpp"

/* The refracted ray o + s d of one camera, seen by the other, and the way of its points to pixels. The parameter t runs
from infinity (0) to the ray's origin (1): the other camera sees the point (1 - t) d + t e, where e is the unit vector to the
origin. Even steps of t are nearly even steps of the angle there, whatever the depth range; 1/s = t / ((1 - t) b) with b the
distance of the origin. */

namespace cv { namespace refract {

//! The curve as a function of t.
class EpipolarCurve
{
public:
    EpipolarCurve(const Matx33d& R, const Vec3d& T, const Vec3d& origin, const Vec3d& d)
        : direction_(R*d), origin_(R*origin + T), unit_(1)
    {
        const double distance = cv::norm(origin_);
        if (distance > 0)       // else the curve is one point in any unit
            unit_ = 1/distance;
    }

    //! The parameter of the point at 1/s.
    double parameter(double mu) const { return mu/(mu + unit_); }

    //! The points at t, in the frame of the other camera, times w.
    void points(int n, const double* t, double* x, double* y, double* z, double* w) const
    {
        for (int i = 0; i < n; i++)
        {
            w[i] = t[i]*unit_;
            x[i] = (1 - t[i])*direction_[0] + w[i]*origin_[0];
            y[i] = (1 - t[i])*direction_[1] + w[i]*origin_[1];
            z[i] = (1 - t[i])*direction_[2] + w[i]*origin_[2];
        }
    }

private:
    Vec3d direction_, origin_;  //!< in the frame of the other camera
    double unit_;
};

//! Points of one or several curves on their way to pixels.
class Projection
{
public:
    enum { CAPACITY = 2*BLOCK };
    explicit Projection(const Camera& other) : other_(other), size_(0) {}
    int room() const { return CAPACITY - size_; }
    void clear() { size_ = 0; }
    //! Returns where the points are among all.
    int add(const EpipolarCurve& curve, int n, const double* t)
    {
        const int begin = size_;
        CV_DbgAssert(n <= room());
        curve.points(n, t, x_ + begin, y_ + begin, z_ + begin, w_ + begin);
        std::copy(t, t + n, t_ + begin);
        size_ += n;
        return begin;
    }
    void run()
    {
        std::fill(status_, status_ + size_, (uchar)REFRACT_OK);
        for (int i = 0; i < size_; i += BLOCK)
            other_.project(std::min(size_ - i, BLOCK), x_ + i, y_ + i, z_ + i, w_ + i, u_ + i, v_ + i, status_ + i);
        for (int i = 0; i < size_; i++)
            if (status_[i] != REFRACT_OK)
                u_[i] = v_[i] = std::numeric_limits<double>::quiet_NaN();
    }
    const Camera& camera() const { return other_; }
    const double* t() const { return t_; }
    const double* u() const { return u_; }      //!< NaN where there is no image
    const double* v() const { return v_; }
    Vec2d pixel(int i) const { return Vec2d(u_[i], v_[i]); }
    uchar status(int i) const { return status_[i]; }

private:
    const Camera& other_;
    int size_;
    double t_[CAPACITY], x_[CAPACITY], y_[CAPACITY], z_[CAPACITY], w_[CAPACITY], u_[CAPACITY], v_[CAPACITY];
    uchar status_[CAPACITY];
};

//! Adds even steps of t to a projection; returns where they begin.
int addSamples(const EpipolarCurve& curve, double tNear, double tFar, int samples, Projection& p);

/** The visible part of the curve by its samples: one interval, because what lies beyond a window and inside a lens' field is
convex. False if no sample is visible. */
bool visiblePart(const EpipolarCurve& curve, const Projection& p, int begin, int samples, double& tNear, double& tFar);

}} // namespace

#endif // OPENCV_REFRACT_EPIPOLAR_CURVE_HPP
