// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_NUMBERS_HPP
#define REFRACT_TOOLS_NUMBERS_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace tools {

/* Numbers beside their uncertainty: two significant digits of it, and the value as far (GUM 7.2.6), whatever the unit is. */

//! Digits after the decimal point that an uncertainty leaves; below 0 tens, hundreds. Of 0 and NaN 6.
int decimalsOf(double uncertainty);

//! @param sign also of a positive number
std::string rounded(double value, int decimals, bool sign = false);

//! Of an even number the upper one of the two in the middle; NaN of none.
double median(std::vector<double> values);

//! Takes all of the text, or nothing; whatever the user's locale says about decimal commas.
bool parseNumber(const std::string& text, double& number);

//! "6x5" -> Size(6, 5); `option` names the option in the error text.
cv::Size parseSize(const std::string& text, const std::string& option);

//! Size(6, 5) -> "6x5"
std::string sizeText(cv::Size size);

//! "a, b,c" -> a b c: what stands between commas, without blanks around it.
std::vector<std::string> splitAtCommas(const std::string& text);

//! "a,b,c" -> numbers; all finite.
std::vector<double> parseNumbers(const std::string& text, const std::string& option);

//! "'a', 'b' and 3 more"
std::string listed(const std::vector<std::string>& names);

//! "NEAR,FAR", 0 < NEAR < FAR, of the scene; FAR may be inf.
cv::Vec2d parseDepthRange(const std::string& text, const std::string& option);
//! The same where FAR must be finite.
cv::Vec2d parseFiniteDepthRange(const std::string& text, const std::string& option);

//! --plane=a,b,c,d: a x + b y + c z = d.
cv::Vec4d parsePlane(const std::string& text);

} // namespace tools

#endif // REFRACT_TOOLS_NUMBERS_HPP
