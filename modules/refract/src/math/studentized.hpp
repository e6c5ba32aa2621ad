// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_STUDENTIZED_HPP
#define OPENCV_REFRACT_STUDENTIZED_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

/** An observed pixel against what all other observations predict, in least squares of unit noise with the hat matrix H. Its own
part of H is its leverage: the residual of an observation that was used has the covariance I - H, that of one that was left out
I + H. Both give the square of its deletion residual (@cite Cook1982), chi^2 where the observation is no outlier. */
struct DeletionResidual
{
    DeletionResidual() : square(0), dimensions(0), isUsed(false) {}
    /** @param prediction covariance of the predicted pixel: H
    @param rows of the residual: 2, or 1 where half a pixel was observed; the other row is 0 then */
    DeletionResidual(const Vec2d& residual, const Matx22d& prediction, bool isUsed, int rows = 2);

    double square;      //!< for unit noise
    int dimensions;     //!< as rows; fewer where nothing else predicts the pixel, or only one coordinate of it
    bool isUsed;

    /** Above 1: an outlier. A good observation exceeds 1 with a chance of 1e-4, whatever its leverage, also where the variance was
    estimated from few residuals.
    @param variance of a pixel coordinate, from the residuals of what was used
    @param freedom of that variance */
    double excess(double variance, int freedom) const;

    //! The variance that this residual would have as the median of many.
    double varianceAsMedian() const;
};

}} // namespace

#endif // OPENCV_REFRACT_STUDENTIZED_HPP
