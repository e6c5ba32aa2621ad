// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "pose/a_contrario.hpp"

namespace cv { namespace refract {

//! log n! by Stirling's series; std::lgamma would write to a variable that all threads share.
static double logFactorial(double n)
{
    const double SMALL = 16, LOG_ROOT_2PI = 0.91893853320467274178;     // from SMALL on the series is good to 3e-12
    double below = 0;
    for (; n < SMALL; n++)
        below += std::log(n + 1);
    const double inverse = 1/n, square = inverse*inverse;
    return (n + 0.5)*std::log(n) - n + LOG_ROOT_2PI + inverse*(1/12. - square*(1/360. - square/1260)) - below;
}

static double logBinomial(int n, int k) { return logFactorial(n) - logFactorial(k) - logFactorial(n - k); }

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
