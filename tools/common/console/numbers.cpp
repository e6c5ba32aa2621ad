// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/numbers.hpp"
#include "console/failure.hpp"
#include "math/quantile.hpp"
#include <opencv2/core.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <locale>
#include <sstream>

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

double median(std::vector<double> values)
{
    return cv::refract::quantile(std::move(values), 0.5);
}

bool parseNumber(const std::string& text, double& number)
{
    const char* const end = text.data() + text.size();
    const char* const begin = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-');
#ifdef __cpp_lib_to_chars
    const std::from_chars_result result = std::from_chars(begin, end, number);
    return result.ec == std::errc() && result.ptr == end;
#else       // libc++: whole numbers only
    const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    for (const auto& [name, value] : { std::make_pair("nan", nan), std::make_pair("inf", inf), std::make_pair("-inf", -inf) })
        if (std::string(begin, end) == name)
        {
            number = value;
            return true;
        }
    std::istringstream in(std::string(begin, end));
    in.imbue(std::locale::classic());
    return in >> std::noskipws >> number && in.eof();
#endif
}

cv::Size parseSize(const std::string& text, const std::string& option)
{
    std::istringstream in(text);
    in.imbue(std::locale::classic());
    cv::Size size;
    char x = 0, rest;
    if (!(in >> size.width >> x >> size.height) || (x != 'x' && x != 'X') || in >> rest
        || size.width <= 0 || size.height <= 0)
        throw Failure(option + "=" + text + ": give two positive whole numbers, as in " + option + "=6x5");
    return size;
}

std::string sizeText(cv::Size size)
{
    return std::to_string(size.width) + "x" + std::to_string(size.height);
}

std::vector<std::string> splitAtCommas(const std::string& text)
{
    const char* const blanks = " \t\r\n";
    std::vector<std::string> items;
    for (size_t begin = 0; begin <= text.size();)
    {
        const size_t comma = std::min(text.find(',', begin), text.size());
        const std::string item = text.substr(begin, comma - begin);
        const size_t first = item.find_first_not_of(blanks);
        items.push_back(first == std::string::npos ? "" : item.substr(first, item.find_last_not_of(blanks) - first + 1));
        begin = comma + 1;
    }
    return items;
}

std::vector<double> parseNumbers(const std::string& text, const std::string& option)
{
    std::vector<double> numbers;
    for (const std::string& item : splitAtCommas(text))
    {
        double number;
        if (!parseNumber(item, number) || !std::isfinite(number))
            throw Failure(option + "=" + text + ": '" + item + "' is not a number; give numbers with commas between");
        numbers.push_back(number);
    }
    return numbers;
}

std::string listed(const std::vector<std::string>& names)
{
    const size_t most = 8;
    std::string text;
    for (size_t i = 0; i < std::min(most, names.size()); i++)
        text += (i ? ", '" : "'") + names[i] + "'";
    return names.size() > most ? text + cv::format(" and %d more", (int)(names.size() - most)) : text;
}

cv::Vec2d parseDepthRange(const std::string& text, const std::string& option)
{
    const std::vector<std::string> items = splitAtCommas(text);
    cv::Vec2d range;
    const bool areTwo = items.size() == 2 && parseNumber(items[0], range[0]) && parseNumber(items[1], range[1]);
    if (!areTwo || !(range[0] > 0 && range[1] > range[0]))
        throw Failure(option + "=" + text + ": give the near and the far end of the scene, as in " + option + "=400,1200 (0 < NEAR < "
                      "FAR)");
    return range;
}

cv::Vec2d parseFiniteDepthRange(const std::string& text, const std::string& option)
{
    const cv::Vec2d range = parseDepthRange(text, option);
    if (std::isinf(range[1]))
        throw Failure(option + "=" + text + ": the far end must be a number here");
    return range;
}

cv::Vec4d parsePlane(const std::string& text)
{
    const std::vector<double> numbers = parseNumbers(text, "--plane");
    if (numbers.size() != 4 || (numbers[0] == 0 && numbers[1] == 0 && numbers[2] == 0))
        throw Failure("--plane=" + text + ": four numbers a,b,c,d are needed, a, b and c not all 0");
    return cv::Vec4d(numbers.data());
}

} // namespace tools
