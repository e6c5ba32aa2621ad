// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/option_names.hpp"
#include "console/failure.hpp"
#include <algorithm>

namespace tools {

std::string numberedName(const std::string& name, size_t at) { return name + (at ? std::to_string(at + 1) : ""); }

void OptionNames::addForEach(const std::string& name, std::string* values, size_t count, const std::string& needed)
{
    ofEach_[name] = {values, count, needed};
}

std::string OptionNames::presentName(const std::string& name) const
{
    const auto former = former_.find(name);
    return former == former_.end() ? name : former->second;
}

std::string OptionNames::nameOfEach(const std::string& name) const
{
    for (const auto& option : ofEach_)
        for (size_t at = 0; at < option.second.count; at++)
            if (name == numberedName(option.first, at) || name == option.first + "1")
                return option.first;
    return "";
}

std::vector<std::string> OptionNames::valuesOfEach(const std::string& name, const Said& said) const
{
    const size_t count = ofEach_.at(name).count;
    std::vector<std::string> values;
    size_t next = 0;
    for (const auto& one : said)
    {
        const size_t at = one.first == name ? next++ : (size_t)std::stoi(one.first.substr(name.size())) - 1;
        if (at >= count)
            throw Failure(name + " is given more than " + std::to_string(count) + " times");
        values.resize(std::max(values.size(), at + 1));
        if (!values[at].empty())
            throw Failure(numberedName(name, at) + " is given twice" + (at ? ": one " + name + " more is it, too" : ""));
        values[at] = one.second;
    }
    return values;
}

std::vector<std::string> OptionNames::inOrder(const std::vector<std::string>& arguments) const
{
    std::map<std::string, Said> said;
    std::vector<std::string> others;
    auto argument = arguments.begin();
    for (; argument != arguments.end() && *argument != "--"; ++argument)
    {
        const size_t equals = std::min(argument->find('='), argument->size());
        const std::string name = presentName(argument->substr(0, equals)), ofEach = nameOfEach(name);
        if (ofEach.empty())
        {
            others.push_back(name + argument->substr(equals));
            continue;
        }
        const bool isSaid = equals < argument->size();
        const bool isNext = !isSaid && argument + 1 != arguments.end() && argument[1].compare(0, 2, "--") != 0;
        const std::string value = isNext ? *++argument : isSaid ? argument->substr(equals + 1) : "";
        if (value.empty())
            throw Failure(name + ": 1 required TEXT missing");
        said[ofEach].push_back({name, value});
    }
    std::vector<std::string> all;
    for (const auto& option : said)
        for (const std::string& value : valuesOfEach(option.first, option.second))
            if (value.empty())
                all.insert(all.end(), {option.first, ""});
            else
                all.push_back(option.first + "=" + value);
    all.insert(all.end(), others.begin(), others.end());
    all.insert(all.end(), argument, arguments.end());
    return all;
}

void OptionNames::requireNeeded() const
{
    for (const auto& option : ofEach_)
        for (size_t at = 1; at < option.second.count && !option.second.needed.empty(); at++)
            if (!option.second.values[at].empty() && ofEach_.at(option.second.needed).values[at].empty())
                throw Failure(numberedName(option.first, at) + " requires " + numberedName(option.second.needed, at));
}

} // namespace tools
