// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Installed OpenCVs have no private headers. This is all that the NumPy conversions want of this one.
#ifndef REFRACT_CONFIGURATION_PRIVATE_HPP
#define REFRACT_CONFIGURATION_PRIVATE_HPP

#include <cstdlib>
#include <string>

namespace cv { namespace utils {

inline bool getConfigurationParameterBool(const char* name, bool defaultValue)
{
    const char* const value = std::getenv(name);
    if (!value)
        return defaultValue;
    const std::string s(value);
    return s == "1" || s == "True" || s == "true" || s == "TRUE";
}

}} // namespace cv::utils

#endif
