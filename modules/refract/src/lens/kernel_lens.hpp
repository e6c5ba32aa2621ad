// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_KERNEL_LENS_HPP
#define OPENCV_REFRACT_KERNEL_LENS_HPP

#include "lens/lens.hpp"
#include "lens/lens_kernels.hpp"
#include "math/missing.hpp"
#include "math/once.hpp"

namespace cv { namespace refract {

//! A lens with a vector form: its kernels first, then one lane after the other of those that they left without an answer.
template<typename Model>
class KernelLens : public Lens
{
public:
    void project(int n, const double* x, const double* y, const double* z, double* u, double* v,
                 uchar* status) const CV_OVERRIDE
    {
        if (!kernels_().project(m_, n, x, y, z, u, v))
            answerMissing(n, u, status, [=](int i) { return projectOne(x[i], y[i], z[i], u[i], v[i]); });
    }

    void unproject(int n, const double* u, const double* v, double* x, double* y, double* z,
                   uchar* status) const CV_OVERRIDE
    {
        fitStartOnce_([this] { fitStart(); });
        if (!kernels_().unproject(m_, n, u, v, x, y, z))
            answerMissing(n, x, status, [=](int i) { return unprojectOne(u[i], v[i], x[i], y[i], z[i]); });
    }

    using Lens::projectJacobian;
    void projectJacobian(int n, const double* x, const double* y, const double* z, double* u, double* v,
                         const Columns& byDirection, const Columns& byParameters, uchar* status) const CV_OVERRIDE
    {
        if (!kernels_().projectJacobian(m_, n, x, y, z, u, v, byDirection, byParameters))
            answerMissing(n, u, status, [=](int i) { return projectOne(x[i], y[i], z[i], u[i], v[i]); });
    }

protected:
    explicit KernelLens(const LensKernels<Model>& (*kernels)()) : m_(), kernels_(kernels) {}

    virtual uchar projectOne(double x, double y, double z, double& u, double& v) const = 0;
    virtual uchar unprojectOne(double u, double v, double& x, double& y, double& z) const = 0;
    //! The part of m_ that only the search for a direction wants; it takes its time.
    virtual void fitStart() const = 0;

    mutable Model m_;

private:
    const LensKernels<Model>& (*kernels_)();
    mutable Once fitStartOnce_;
};

}} // namespace

#endif // OPENCV_REFRACT_KERNEL_LENS_HPP
