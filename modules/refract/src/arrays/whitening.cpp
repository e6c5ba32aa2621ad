// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/whitening.hpp"
#include "math/quantile.hpp"

namespace cv { namespace refract {

Whitening::Whitening(const Point2d& pixel, const PixelCovariance& c, double scale)
{
    // C = L L^T, W = L^-1.
    const double first = std::sqrt(c.uu), across = std::isnan(pixel.x) ? 0 : c.uv/first, second = std::sqrt(c.vv - across*across);
    uu = std::isnan(pixel.x) ? 0 : scale/first;
    vv = std::isnan(pixel.y) ? 0 : scale/second;
    vu = isWhole(pixel) ? -across*vv/first : 0;
}

//! N x 3 or N x 4 numbers.
static Mat_<double> rowsOf(const Mat& given, int count, const String& name)
{
    const int values = (int)given.total()*given.channels(), perPixel = count > 0 ? values/count : 0;
    const int last = given.channels() > 1 ? given.channels() : given.dims > 2 ? given.size[2] : given.cols;
    const bool isShape = last == perPixel || (perPixel == 4 && last == 2 && (given.dims > 2 || given.channels() == 2));
    if ((given.depth() != CV_32F && given.depth() != CV_64F) || (perPixel != 3 && perPixel != 4) || perPixel*count != values || !isShape)
        CV_Error_(Error::StsBadSize, ("%s has %d values of type %s; for %d pixels it must be Nx4 (2x2 row by row) or Nx3 (uu, uv, vv), "
                                      "float32 or float64", name.c_str(), values, typeToString(given.type()).c_str(), count));
    const int sizes[] = { count, perPixel };
    Mat_<double> rows;
    given.clone().reshape(1, 2, sizes).convertTo(rows, CV_64F);
    return rows;
}

PixelCovariances readPixelCovariances(InputArray covariances, const std::vector<Point2d>& pixels, const String& name)
{
    PixelCovariances all;
    const Mat given = covariances.getMat();
    if (given.empty())
        return all;
    const Mat_<double> rows = rowsOf(given, (int)pixels.size(), name);
    for (int i = 0; i < rows.rows; i++)
    {
        const double* const row = rows[i];
        const bool isSquare = rows.cols == 4;
        PixelCovariance c;
        c.uu = row[0];
        c.uv = isSquare ? 0.5*(row[1] + row[2]) : row[1];
        c.vv = row[isSquare ? 3 : 2];
        const auto isVariance = [](double variance) { return variance > 0 && std::isfinite(variance); };
        const bool isGood = (std::isnan(pixels[i].x) || isVariance(c.uu)) && (std::isnan(pixels[i].y) || isVariance(c.vv)) &&
                            (!isWhole(pixels[i]) || (c.uu*c.vv - c.uv*c.uv > 1e-12*c.uu*c.vv &&
                                                     (!isSquare || std::abs(row[1] - row[2]) <= 1e-6*std::sqrt(c.uu*c.vv))));
        if (isSeen(pixels[i]) && !isGood)
            CV_Error_(Error::StsBadArg, ("%s has (%g, %g, %g) as uu, uv, vv of pixel %d; it must be symmetric and positive definite",
                                         name.c_str(), c.uu, c.uv, c.vv, i));
        all.push_back(c);
    }
    return all;
}

void MedianVariance::add(const std::vector<Point2d>& pixels, const PixelCovariances& covariances)
{
    for (size_t i = 0; i < pixels.size(); i++)
    {
        const PixelCovariance c = covariances.empty() ? PixelCovariance() : covariances[i];
        if (isSeen(pixels[i]) && !std::isnan(pixels[i].x))
            variances_.push_back(c.uu);
        if (isSeen(pixels[i]) && !std::isnan(pixels[i].y))
            variances_.push_back(c.vv);
    }
}

double MedianVariance::operator()() const
{
    return variances_.empty() ? 1 : quantile(variances_, 0.5);
}

}} // namespace
