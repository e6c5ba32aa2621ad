// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PAGE_TEMPLATE_HPP
#define REFRACT_TOOLS_PAGE_TEMPLATE_HPP

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
    PageValues() = default;
    PageValues(const std::string& name, const std::string& text) { set(name, text); }

    void set(const std::string& name, const std::string& text);
    void set(const std::string& name, const char* text) { set(name, std::string(text)); }
    void set(const std::string& name, bool flag);
    void set(const std::string& name, const std::vector<PageValues>& list);

private:
    friend class PageConverter;
    struct Value
    {
        enum Kind { TEXT, FLAG, LIST } kind;
        std::string text;
        bool flag;
        std::vector<PageValues> list;
    };
    std::vector<std::pair<std::string, Value>> values_;
};

using PageList = std::vector<PageValues>;

//! An entry for each text, which it calls "text".
PageList pageList(const std::vector<std::string>& texts);

//! Throws Failure if the template is broken. @param name for the text: "the report"
std::string renderPage(const std::string& name, const char* pageTemplate, const PageValues& page);

} // namespace tools

#endif // REFRACT_TOOLS_PAGE_TEMPLATE_HPP
