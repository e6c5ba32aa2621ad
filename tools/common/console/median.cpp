// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/median.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace tools {

double median(std::vector<double> values)
{
    if (values.empty())
        return std::numeric_limits<double>::quiet_NaN();
    const auto middle = values.begin() + (std::ptrdiff_t)values.size()/2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

} // namespace tools
