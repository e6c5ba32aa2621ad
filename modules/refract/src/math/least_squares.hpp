// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LEAST_SQUARES_HPP
#define OPENCV_REFRACT_LEAST_SQUARES_HPP

#include "precomp.hpp"
#include "opencv2/core/hal/hal.hpp"

/* Sums of squares of many errors by a handful of parameters: Levenberg and Marquardt's method on the normal equations, with
Nielsen's rule for the damping (Madsen, Nielsen, Tingleff, Methods for non-linear least squares problems, 2004). Nothing is on
the heap. Symmetric matrices are scaled to a diagonal of ones before they are factorised, so that no unit is too small. */

namespace cv { namespace refract {

//! Of errors e at one place: e^T e, J^T e and J^T J.
template<int N>
struct SumOfSquares
{
    double value = 0;
    Vec<double, N> gradient;
    Matx<double, N, N> curvature;

    //! @param derivatives of the error by the parameters
    void add(double error, const double* derivatives)
    {
        double row[N];          // a copy is no part of the sums, and whole rows are vectors: the compiler can use both
        std::copy(derivatives, derivatives + N, row);
        value += error*error;
        for (int r = 0; r < N; r++)
        {
            gradient[r] += row[r]*error;
            for (int c = 0; c < N; c++)
                curvature(r, c) += row[r]*row[c];
        }
    }
};

/** Solves A X = B for a positive definite A, of which the upper triangle is read; false if it is singular.
@param X in: B */
template<int N, int M>
bool solvePositive(const Matx<double, N, N>& A, Matx<double, N, M>& X)
{
    Matx<double, N, N> scaled;
    double scale[N];
    for (int i = 0; i < N; i++)
    {
        scale[i] = 1/std::sqrt(A(i, i));
        if (!std::isfinite(scale[i]))
            return false;
    }
    for (int r = 0; r < N; r++)
    {
        for (int c = r; c < N; c++)
            scaled(r, c) = scaled(c, r) = A(r, c)*scale[r]*scale[c];
        for (int c = 0; c < M; c++)
            X(r, c) *= scale[r];
    }
    if (!hal::Cholesky64f(scaled.val, sizeof(double)*N, N, X.val, sizeof(double)*M, M))
        return false;
    for (int r = 0; r < N; r++)
        for (int c = 0; c < M; c++)
            X(r, c) *= scale[r];
    return true;
}

//! Inverse of a positive definite matrix, of which the upper triangle is read; NaN if it is singular.
template<int N>
Matx<double, N, N> inverseOfPositive(const Matx<double, N, N>& A)
{
    Matx<double, N, N> inverse = Matx<double, N, N>::eye();
    return solvePositive(A, inverse) ? inverse : Matx<double, N, N>::all(std::numeric_limits<double>::quiet_NaN());
}

//! What ends minimizeSquares.
struct LeastSquaresEnd
{
    int iterations;
    double change;          //!< of the sum of squares, absolute
    double step;            //!< of the parameters, relative
};

//! The step with the curvature's diagonal enlarged by a part `damping`; false if that is singular.
template<int N>
bool dampedStep(const SumOfSquares<N>& here, const Vec<double, N>& leastDiagonal, double damping, Vec<double, N>& step)
{
    Matx<double, N, N> A = here.curvature;
    for (int i = 0; i < N; i++)
        A(i, i) += damping*std::max(A(i, i), leastDiagonal[i]);
    step = -here.gradient;
    return solvePositive<N, 1>(A, step);
}

//! By how much a step reduces the sum of squares if the errors are linear.
template<int N>
double expectedGain(const SumOfSquares<N>& here, const Vec<double, N>& step)
{
    double gain = 0;
    for (int r = 0; r < N; r++)
    {
        gain -= step[r]*(2*here.gradient[r] + here.curvature(r, r)*step[r]);
        for (int c = r + 1; c < N; c++)
            gain -= 2*step[r]*here.curvature(r, c)*step[c];
    }
    return gain;
}

/** The least sum of squares near a start.
@param evaluate callable: evaluate(const Vec<double, N>& x, SumOfSquares<N>& sum), false where some error has no value
@param x in: start, out: minimum
@param here gets what is there
@return the sum; NaN, and x as it was, if the start has none */
template<int N, typename Evaluate>
double minimizeSquares(const Evaluate& evaluate, const LeastSquaresEnd& end, Vec<double, N>& x, SumOfSquares<N>& here)
{
    here = SumOfSquares<N>();
    if (!evaluate(x, here) || !std::isfinite(here.value))
        return std::numeric_limits<double>::quiet_NaN();
    Vec<double, N> leastDiagonal;               // for a parameter that hardly moves anything
    for (int i = 0; i < N; i++)
        leastDiagonal[i] = 1e-6*std::pow(1 + std::sqrt(here.curvature(i, i)), 2);
    double damping = 1e-4, growth = 2;
    for (int k = 1; k < end.iterations; k++)
    {
        Vec<double, N> step;
        const bool isStep = dampedStep(here, leastDiagonal, damping, step);
        if (isStep && norm(step) < end.step*(norm(x) + end.step))
            break;
        SumOfSquares<N> there;
        const Vec<double, N> next = x + step;
        const bool isPlace = isStep && evaluate(next, there) && std::isfinite(there.value);
        const double gain = isPlace ? here.value - there.value : -std::numeric_limits<double>::infinity();
        const double ratio = isPlace ? gain/expectedGain(here, step) : 0;
        if (ratio > 0)
        {
            x = next;
            here = there;
            damping *= std::max(1/3., 1 - std::pow(2*ratio - 1, 3));
            growth = 2;
        }
        else
        {
            damping *= growth;
            growth *= 2;
        }
        if (std::abs(gain) < end.change)
            break;
    }
    return here.value;
}

template<int N, typename Evaluate>
double minimizeSquares(const Evaluate& evaluate, const LeastSquaresEnd& end, Vec<double, N>& x)
{
    SumOfSquares<N> here;
    return minimizeSquares(evaluate, end, x, here);
}

}} // namespace

#endif // OPENCV_REFRACT_LEAST_SQUARES_HPP
