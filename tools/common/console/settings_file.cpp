// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/settings_file.hpp"
#include "console/cli.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <set>
#include <sstream>

namespace tools {

const CLI::Option& SettingsFile::optionOf(const CLI::ConfigItem& item) const
{
    const std::string name = item.fullname(), where = "--config: ";
    if (item.name == "++" || item.name == "--")
        throw Failure(where + "'[...]' begins a section; give all settings without sections, one a line: name = value");
    const CLI::Option* option = app_.get_option_no_throw("--" + name);
    if (!option)
        option = app_.get_option_no_throw(name);
    if (!option)
        throw Failure(where + "there is no setting '" + name + "'; settings are the options that --help lists, without dashes, "
                      "one a line: name = value");
    if (!option->get_configurable())
        throw Failure(where + "'" + name + "' belongs on the command line: take it out of the file");
    return *option;
}

//! So that the command line that goes into outputs says all.
void SettingsFile::noteArguments(const CLI::Option& option, const CLI::ConfigItem& item) const
{
    const bool isFlag = option.get_expected_max() == 0;
    for (const std::string& value : item.inputs)
        if (option.get_positional())
            arguments_.push_back(value);
        else if (!isFlag || value == "true")
            arguments_.push_back("--" + item.name + (isFlag ? "" : "=" + value));
}

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

//! The text without a byte order mark; CLI11 joins a setting that comes twice, as if it were a list.
static std::string checkedText(std::istream& in)
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

std::vector<CLI::ConfigItem> SettingsFile::from_config(std::istream& in) const
{
    std::istringstream text(checkedText(in));
    std::vector<CLI::ConfigItem> items = CLI::ConfigTOML::from_config(text);
    for (CLI::ConfigItem& item : items)
    {
        const CLI::Option& option = optionOf(item);
        item.name = item.fullname();        // that of calib.yml has a dot, which divides sections
        item.parents.clear();
        if (option.get_items_expected_max() == 1 && item.inputs.size() > 1)
            item.inputs = {CLI::detail::join(item.inputs, ",")};     // thickness = [20, 5] is --thickness=20,5
        if (option.empty())
            noteArguments(option, item);
    }
    return items;
}

} // namespace tools
