// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_DIRECTION_MANIFOLD_HPP
#define OPENCV_REFRACT_DIRECTION_MANIFOLD_HPP

#include <ceres/manifold.h>
#include <memory>

namespace cv { namespace refract {

/** Ceres' manifold of unit vectors, or of lines, also for directions by the z axis. Nearer than 1.5e-8 radians Ceres takes the axis
itself: a step of 0 moves the direction there, the cost has a jump, and a window that is straight to the last digit never ends its
fit. Such directions get another axis. */
class DirectionManifold : public ceres::Manifold
{
public:
    //! @param manifold ceres::SphereManifold<3>, or LineManifold<3>, whose direction comes last
    explicit DirectionManifold(std::unique_ptr<ceres::Manifold> manifold) : manifold_(std::move(manifold)) {}
    int AmbientSize() const override { return manifold_->AmbientSize(); }
    int TangentSize() const override { return manifold_->TangentSize(); }
    bool Plus(const double* x, const double* delta, double* xPlusDelta) const override;
    bool PlusJacobian(const double* x, double* jacobian) const override;
    bool Minus(const double* y, const double* x, double* yMinusX) const override;
    bool MinusJacobian(const double* x, double* jacobian) const override;

private:
    bool isByAxis(const double* x) const;
    std::unique_ptr<ceres::Manifold> manifold_;
};

}} // namespace

#endif // OPENCV_REFRACT_DIRECTION_MANIFOLD_HPP
