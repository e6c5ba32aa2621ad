// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "pose/chance.hpp"

namespace cv { namespace refract {

static double logBinomial(int n, int k) { return std::lgamma(n + 1.) - std::lgamma(k + 1.) - std::lgamma(n - k + 1.); }

bool isExplainedByChance(int count, int inliers, const Sampling& s)
{
    if (inliers == count)
        return false;
    return std::log(s.answers*(count - s.size)) + logBinomial(count, inliers) + logBinomial(inliers, s.size)
           + (inliers - s.size)*std::log(std::min(s.chance, 1.)) >= 0;
}

Size2d extentOf(const std::vector<Point2d>& pixels)
{
    Point2d low(DBL_MAX, DBL_MAX), high(-DBL_MAX, -DBL_MAX);
    for (const Point2d& p : pixels)
    {
        low = Point2d(std::min(low.x, p.x), std::min(low.y, p.y));
        high = Point2d(std::max(high.x, p.x), std::max(high.y, p.y));
    }
    return Size2d(high.x - low.x, high.y - low.y);
}

}} // namespace
