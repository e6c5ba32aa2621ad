// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHECK_OUTPUT_HPP
#define REFRACT_TOOLS_CHECK_OUTPUT_HPP

#include "assess/rig_check.hpp"
#include "check/check_images.hpp"
#include "check/check_options.hpp"
#include "console/json.hpp"

/* What refract_check says and writes of one check. */
namespace tools {

/* Whether the images of a check can tell. */

/** Empty, or why "unchanged" cannot be said: with too low a probability the images would show what --detect asks for.
@param input that was tested */
std::string whyNot(const CheckResult& result, const CheckOptions& options, const CheckInput& input);

const char CANNOT_TELL[] = "cannot tell";

//! In a word or two. @param why of whyNot
std::string verdictOf(const CheckResult& result, const std::string& why);

//! A sentence of errors that are as they were in the calibration; empty: all would show.
std::string unseenBy(const CheckResult& result);

Json checkJson(const CheckResult& result, const CheckOptions& options, const CheckInput& input, const std::string& verdict,
               const std::string& why);

void printCheck(const CheckResult& result, const CheckOptions& options, const CheckInput& input, const CheckImages& images);

} // namespace tools

#endif // REFRACT_TOOLS_CHECK_OUTPUT_HPP
