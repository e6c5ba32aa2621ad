// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/settings_file.hpp"
#include "console/failure.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <set>
#include <sstream>

namespace tools {

//! What stands before the first '=' of a line, without blanks and quotes; empty if that is no name.
static std::string nameOf(const std::string& line)
{
    const std::string AROUND = " \t\"'";
    const size_t equals = line.find('='), begin = line.find_first_not_of(AROUND);
    if (equals == std::string::npos || begin >= equals)
        return "";
    const std::string name = line.substr(begin, line.find_last_not_of(AROUND, equals - 1) + 1 - begin);
    const auto isOfName = [](char c) { return std::isalnum((unsigned char)c) || c == '.' || c == '_' || c == '-'; };
    return std::all_of(name.begin(), name.end(), isOfName) ? name : "";
}

std::string readSettings(std::istream& in)
{
    const std::string MARK = "\xEF\xBB\xBF", text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    std::istringstream lines(text.compare(0, MARK.size(), MARK) == 0 ? text.substr(MARK.size()) : text);
    std::set<std::string> names;
    for (std::string line; std::getline(lines, line); )
    {
        const std::string name = nameOf(line);
        if (!name.empty() && !names.insert(name).second)
            throw Failure("--config: '" + name + "' is set twice; several values are a list: name = [one, two]");
    }
    return lines.str();
}

} // namespace tools
