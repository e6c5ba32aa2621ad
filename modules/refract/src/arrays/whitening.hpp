// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_WHITENING_HPP
#define OPENCV_REFRACT_WHITENING_HPP

#include "precomp.hpp"

/* An observed pixel is r = W (predicted - observed), with W^T W the inverse of its covariance. Of half a pixel one coordinate is
known, the other is NaN: then W has one row, and its place for the other is 0. */

namespace cv { namespace refract {

//! Both coordinates are known.
inline bool isWhole(const Point2d& pixel) { return std::isfinite(pixel.x) && std::isfinite(pixel.y); }

//! One coordinate is known, and the other is NaN.
inline bool isHalf(const Point2d& pixel)
{
    return (std::isfinite(pixel.x) && std::isnan(pixel.y)) || (std::isnan(pixel.x) && std::isfinite(pixel.y));
}

//! Of the coordinates that were observed; NaN where there is no prediction.
inline double squaredDistance(const Point2d& predicted, const Point2d& observed)
{
    const double du = predicted.x - observed.x, dv = predicted.y - observed.y;
    return (std::isnan(observed.x) ? 0 : du*du) + (std::isnan(observed.y) ? 0 : dv*dv);
}

inline bool isSeen(const Point2d& pixel) { return isWhole(pixel) || isHalf(pixel); }

//! Covariance of a pixel, in units of the square of a usual coordinate's standard deviation.
struct PixelCovariance
{
    double uu = 1, uv = 0, vv = 1;
};
typedef std::vector<PixelCovariance> PixelCovariances;      //!< empty: all are usual ones

//! W, lower triangular.
struct Whitening
{
    double uu = 1, vu = 0, vv = 1;

    Whitening() = default;
    //! Of a pixel that was seen. @param scale of W
    Whitening(const Point2d& pixel, const PixelCovariance& covariance, double scale);
    int rows() const { return (uu > 0) + (vv > 0); }

    //! An error u, v, or what it is differentiated by; a coordinate without a row may be NaN.
    void apply(double& u, double& v) const
    {
        v = vv > 0 ? (uu > 0 ? vu*u : 0) + vv*v : 0;
        u = uu > 0 ? uu*u : 0;
    }
};

/** Arrays of covariances as users give them; empty or noArray(): none. Throws with the name where one is not positive definite
that a pixel needs. */
PixelCovariances readPixelCovariances(InputArray covariances, const std::vector<Point2d>& pixels, const String& name);

/** The median variance of the coordinates that were seen: against its root, what a weighted error is has the size of pixels. */
class MedianVariance
{
public:
    void add(const std::vector<Point2d>& pixels, const PixelCovariances& covariances);
    double operator()() const;      //!< 1 if there is none
private:
    std::vector<double> variances_;
};

}} // namespace

#endif // OPENCV_REFRACT_WHITENING_HPP
