// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_OPTION_NAMES_HPP
#define REFRACT_TOOLS_OPTION_NAMES_HPP

#include <map>
#include <string>
#include <utility>
#include <vector>

/* Options that are said for each camera, and options that had another name: what a command line or a file of settings says, in the form
that the parser takes. */
namespace tools {

class OptionNames
{
public:
    using Said = std::vector<std::pair<std::string, std::string>>;          // names and values

    void addForEach(const std::string& name, std::string* values, size_t count, const std::string& needed);
    void addFormer(const std::string& former, const std::string& name) { former_[former] = name; }

    std::string presentName(const std::string& name) const;
    //! The option for each camera that a name belongs to, with a number or without; empty: none.
    std::string nameOfEach(const std::string& name) const;
    /** The values of an option for each camera in their order; empty: of a camera that is left out. Names without a number count by
    themselves. Throws Failure. */
    std::vector<std::string> valuesOfEach(const std::string& name, const Said& said) const;
    //! All arguments, with the values for each camera in their order, one a camera. Throws Failure.
    std::vector<std::string> inOrder(const std::vector<std::string>& arguments) const;
    //! Cameras after the first. Throws Failure.
    void requireNeeded() const;

private:
    struct OfEach
    {
        std::string* values;
        size_t count;
        std::string needed;
    };
    std::map<std::string, OfEach> ofEach_;          // by the option's name
    std::map<std::string, std::string> former_;     // and those of now
};

//! "--glass", "--glass2", "--glass3", ...
std::string numberedName(const std::string& name, size_t at);

} // namespace tools

#endif // REFRACT_TOOLS_OPTION_NAMES_HPP
