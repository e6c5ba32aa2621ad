// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/direction_manifold.hpp"
#include "precomp.hpp"

namespace cv { namespace refract {

//! Where a coordinate stands after each three were turned: (y, z, x).
static int turned(int i) { return i/3*3 + (i + 2) % 3; }

static std::vector<double> turned(const double* x, int size)
{
    std::vector<double> y(size);
    for (int i = 0; i < size; i++)
        y[turned(i)] = x[i];
    return y;
}

//! The axis itself is one of Ceres', too.
bool DirectionManifold::isByAxis(const double* x) const
{
    const double* const d = x + AmbientSize() - 3;
    const double across = d[0]*d[0] + d[1]*d[1];
    return across > 0 && across <= std::numeric_limits<double>::epsilon();
}

bool DirectionManifold::Plus(const double* x, const double* delta, double* xPlusDelta) const
{
    if (!isByAxis(x))
        return manifold_->Plus(x, delta, xPlusDelta);
    const int size = AmbientSize();
    std::vector<double> sum(size);
    if (!manifold_->Plus(turned(x, size).data(), delta, sum.data()))
        return false;
    for (int i = 0; i < size; i++)
        xPlusDelta[i] = sum[turned(i)];
    return true;
}

bool DirectionManifold::PlusJacobian(const double* x, double* jacobian) const
{
    if (!isByAxis(x))
        return manifold_->PlusJacobian(x, jacobian);
    const int rows = AmbientSize(), columns = TangentSize();
    std::vector<double> J(rows*columns);
    if (!manifold_->PlusJacobian(turned(x, rows).data(), J.data()))
        return false;
    for (int i = 0; i < rows; i++)
        std::copy_n(&J[turned(i)*columns], columns, jacobian + i*columns);
    return true;
}

bool DirectionManifold::Minus(const double* y, const double* x, double* yMinusX) const
{
    if (!isByAxis(x))
        return manifold_->Minus(y, x, yMinusX);
    const int size = AmbientSize();
    return manifold_->Minus(turned(y, size).data(), turned(x, size).data(), yMinusX);
}

bool DirectionManifold::MinusJacobian(const double* x, double* jacobian) const
{
    if (!isByAxis(x))
        return manifold_->MinusJacobian(x, jacobian);
    const int rows = TangentSize(), columns = AmbientSize();
    std::vector<double> J(rows*columns);
    if (!manifold_->MinusJacobian(turned(x, columns).data(), J.data()))
        return false;
    for (int i = 0; i < rows; i++)
        for (int k = 0; k < columns; k++)
            jacobian[i*columns + k] = J[i*columns + turned(k)];
    return true;
}

}} // namespace
