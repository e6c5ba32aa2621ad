// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* With t the square over s^2, d its dimensions and s^2 of n degrees of freedom: where the observation was used, t/n has the Beta
distribution with d/2 and (n - d)/2; where it was not, t/d is Fisher's F. For d = 2,

    -(n - 2) log(1 - t/n)   and   n log(1 + t/n)

are exactly chi^2 of two degrees; for d = 1 they are nearly chi^2 of one (with Wallace's factor, to 1e-3). */

#include "math/studentized.hpp"

namespace cv { namespace refract {

DeletionResidual::DeletionResidual(const Vec2d& residual, const Matx22d& prediction, bool isUsed_, int rows)
    : square(0), dimensions(0), isUsed(isUsed_)
{
    // Of a unit variance; less is rounding, and what the linear model leaves out.
    const double LEAST_VARIANCE = 1e-4;
    const double sign = isUsed ? -1 : 1;
    if (rows == 1)
    {
        const double variance = 1 + sign*trace(prediction);
        dimensions = variance > LEAST_VARIANCE;
        square = dimensions > 0 ? residual.dot(residual)/variance : 0;
        return;
    }
    const double a = 1 + sign*prediction(0, 0), b = sign*(prediction(0, 1) + prediction(1, 0))/2, c = 1 + sign*prediction(1, 1);
    const double half = (a - c)/2, root = std::sqrt(half*half + b*b), angle = 0.5*std::atan2(b, half);
    const Vec2d axes[] = { { std::cos(angle), std::sin(angle) }, { -std::sin(angle), std::cos(angle) } };
    const double variances[] = { (a + c)/2 + root, (a + c)/2 - root };
    for (int i = 0; i < 2; i++)
    {
        if (!(variances[i] > LEAST_VARIANCE))
            continue;
        square += std::pow(axes[i].dot(residual), 2)/variances[i];
        dimensions++;
    }
}

double DeletionResidual::excess(double variance, int freedom) const
{
    const double QUANTILES[] = { 1, 15.13671, 18.42068 };      // of chi^2 at 1 - 1e-4
    if (dimensions == 0)
        return 0;
    const double others = isUsed ? freedom - dimensions : freedom, t = square/variance;
    if (!(others > 0))
        return 0;               // nothing to compare it with
    double chiSquare = isUsed ? (t < freedom ? -others*std::log1p(-t/freedom) : std::numeric_limits<double>::infinity())
                              : others*std::log1p(t/freedom);
    if (dimensions == 1)
        chiSquare *= std::pow((8*others + 1)/(8*others + 3), 2);
    return chiSquare/QUANTILES[dimensions];
}

double DeletionResidual::varianceAsMedian() const
{
    const double MEDIANS[] = { 1, 0.454936, 1.386294 };
    return square/MEDIANS[dimensions];
}

}} // namespace
