// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_SPLINE_MODEL_HPP
#define OPENCV_REFRACT_SPLINE_MODEL_HPP

/* mrcal's splined lens (lens_splined.cpp states the formula) as the vector code sees it, and what control points weigh, for one
point (T = double) and for many (T = Lanes). No OpenCV in here, see dispatch/kernels.hpp. */

namespace cv { namespace refract {

struct SplineModel
{
    double fx, fy, cx, cy;
    int order, nx, ny;
    double perUnit;                     //!< control points per unit of the stereographic plane
    double edge[2];                     //!< the rectangle in that plane, about 0
    const double* controls;             //!< two more than there are: a kernel reads four in a row, of order 2, too
    const unsigned char* certain;       //!< cells of the plane, row by row, that are CERTAIN in the domain; null: all of them
    int cellColumns, cellRows;
    double cellsPerUnit;
};

//! A cell that the domain holds whatever the slope is. Points of others are for the scalar code.
enum { CERTAIN_CELL = 2 };

struct SplineKernels
{
    bool (*project)(const SplineModel& lens, int n, const double* x, const double* y, const double* z, double* u, double* v);
};

const SplineKernels& splineKernels();

namespace {

//! A coordinate of the stereographic plane, counted in control points.
template<typename T> inline T splineCoordinate(T p, double perUnit, int count) { return p*perUnit + 0.5*(count - 1); }

//! The second of the control points that a coordinate needs, as far as there are any.
template<int ORDER> inline int splineCell(double g, int count)
{
    const int cell = (int)(g + (ORDER == 3 ? 0 : 0.5)), last = count - ORDER;
    return cell < 1 ? 1 : cell < last ? cell : last;
}

//! What the ORDER + 1 control points weigh, t beyond the second.
template<int ORDER, typename T> inline void splineWeights(T t, T* value)
{
    if (ORDER == 3)
    {
        const T t2 = t*t, r = 1 - t, r2 = r*r;
        value[0] = r2*r*(1./6);
        value[1] = 2./3 + t2*(0.5*t - 1);
        value[2] = 2./3 + r2*(0.5*r - 1);
        value[3] = t2*t*(1./6);
        return;
    }
    const T before = 0.5 - t, after = 0.5 + t;
    value[0] = 0.5*before*before;
    value[1] = 0.75 - t*t;
    value[2] = 0.5*after*after;
}

}}} // namespace

#endif // OPENCV_REFRACT_SPLINE_MODEL_HPP
