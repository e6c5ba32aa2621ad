// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PAGE_TEMPLATE_HPP
#define REFRACT_TOOLS_PAGE_TEMPLATE_HPP

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

/* Pages are mustache templates: {{name}} is a text, {{#name}} ... {{/name}} a part that is there if a flag is set, or once for each
entry of a list. The library with its templates is in page_template.cpp alone. */
namespace tools {

//! What the names of a template, or of an entry of a list, stand for.
class PageValues
{
public:
    //! A text, a flag or a list.
    struct Value
    {
        Value(const std::string& ofText) : kind(TEXT), text(ofText) {}
        Value(const char* ofText) : kind(TEXT), text(ofText) {}
        Value(bool ofFlag) : kind(FLAG), flag(ofFlag) {}
        Value(const std::vector<PageValues>& entries) : kind(LIST), list(entries) {}

        enum Kind { TEXT, FLAG, LIST } kind;
        std::string text = {};
        bool flag = false;
        std::vector<PageValues> list = {};
    };

    PageValues() = default;
    PageValues(std::initializer_list<std::pair<std::string, Value>> values) : values_(values) {}

    void set(const std::string& name, const Value& value) { values_.emplace_back(name, value); }

private:
    friend class PageConverter;
    std::vector<std::pair<std::string, Value>> values_;
};

using PageList = std::vector<PageValues>;

//! An entry for each text, which it calls "text".
PageList pageList(const std::vector<std::string>& texts);

//! Throws Failure if the template is broken. @param name for the text: "the report"
std::string renderPage(const std::string& name, const char* pageTemplate, const PageValues& page);

} // namespace tools

#endif // REFRACT_TOOLS_PAGE_TEMPLATE_HPP
