// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_QUANTILE_HPP
#define OPENCV_REFRACT_QUANTILE_HPP

#include <algorithm>
#include <limits>
#include <vector>

namespace cv { namespace refract {

/** The value below which that share of n values lies: the one with floor(share n) values before it in ascending order, the
last one at most. NaN is no value; NaN of none. */
template <typename T> double quantile(std::vector<T> values, double share)
{
    values.erase(std::remove_if(values.begin(), values.end(), [](T value) { return !(value == value); }), values.end());
    if (values.empty())
        return std::numeric_limits<double>::quiet_NaN();
    const auto at = values.begin() + (std::ptrdiff_t)std::min(values.size() - 1, (size_t)(share*(double)values.size()));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}} // namespace

#endif // OPENCV_REFRACT_QUANTILE_HPP
