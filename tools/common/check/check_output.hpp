// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHECK_OUTPUT_HPP
#define REFRACT_TOOLS_CHECK_OUTPUT_HPP

#include "check/check_images.hpp"
#include "console/json.hpp"

/* What refract_check says and writes of one check. */
namespace tools {

Json checkJson(const CheckResult& result, const CheckOptions& options, const CheckInput& input, const std::string& verdict,
               const std::string& why);

void printCheck(const CheckResult& result, const CheckOptions& options, const CheckInput& input, const CheckImages& images);

} // namespace tools

#endif // REFRACT_TOOLS_CHECK_OUTPUT_HPP
