// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/rounded.hpp"
#include <opencv2/core.hpp>
#include <cmath>
#include <cstdlib>

namespace tools {

int decimalsOf(double uncertainty)
{
    const int UNKNOWN = 6;
    if (!(uncertainty > 0) || !std::isfinite(uncertainty))
        return UNKNOWN;
    const std::string digits = cv::format("%.1e", uncertainty);        // 0.0996 -> 1.0e-01
    return 1 - std::atoi(digits.c_str() + digits.find('e') + 1);
}

std::string rounded(double value, int decimals, bool sign)
{
    const double unit = std::pow(10., -decimals), number = decimals < 0 ? unit*std::round(value/unit) : value;
    const std::string text = cv::format(sign ? "%+.*f" : "%.*f", std::max(0, decimals), number);
    const bool isZero = text.find_first_of("123456789") == std::string::npos;       // which has no sign
    return isZero && text.find_first_of("+-") == 0 ? text.substr(1) : text;
}

} // namespace tools
