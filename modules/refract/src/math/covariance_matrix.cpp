// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/covariance_matrix.hpp"
#include "opencv2/core/hal/hal.hpp"

namespace cv { namespace refract {

static const double PRINTED = 1e-6;     // parts of a standard deviation that six printed digits leave

/** Between quantities in units of their standard deviations; 0 beside those that are known exactly, whose variance is up to
`rounding`. False if their covariances with others are not 0. */
static bool correlationOf(const Mat& C, double most, double rounding, Mat& correlation)
{
    correlation = Mat::zeros(C.size(), CV_64F);
    for (int r = 0; r < C.rows; r++)
        for (int c = 0; c < C.cols; c++)
        {
            const double first = C.at<double>(r, r), second = C.at<double>(c, c), both = C.at<double>(r, c);
            if (first > rounding && second > rounding)
                correlation.at<double>(r, c) = both/(std::sqrt(first)*std::sqrt(second));
            else if (std::abs(both) > std::max(rounding, PRINTED*std::sqrt(most)*std::sqrt(std::max(0., std::max(first, second)))))
                return false;
        }
    return true;
}

void checkCovariance(const Mat& C, const String& name)
{
    const double ROUNDING = 1e-12;
    double least = 0, most = 0;
    if (!C.empty() && checkRange(C))
        minMaxIdx(C.diag(), &least, &most);
    if (!checkRange(C) || least < -ROUNDING*most || most < 0)
        CV_Error_(Error::StsBadArg, ("%s holds a number that is not finite, or one below 0 on its diagonal", name.c_str()));
    Mat correlation;
    if (!correlationOf(C, most, std::max(-least, 0.), correlation))
        CV_Error_(Error::StsBadArg, ("%s has a covariance that is not 0 for a quantity with variance 0", name.c_str()));
    if (norm(correlation, correlation.t(), NORM_INF) > 2*PRINTED)
        CV_Error_(Error::StsBadArg, ("%s is not symmetric", name.c_str()));
    correlation += 2*PRINTED*C.rows*Mat::eye(C.size(), CV_64F);
    if (!C.empty() && !hal::Cholesky64f(correlation.ptr<double>(), correlation.step, C.rows, NULL, 0, 0))
        CV_Error_(Error::StsBadArg, ("%s is not positive semidefinite", name.c_str()));
}

}} // namespace
