// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/page_template.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"

#include <kainjow/mustache.hpp>

using kainjow::mustache::data;

namespace tools {

//! To what the library takes.
class PageConverter
{
public:
    static data dataOf(const PageValues& page)
    {
        data object;
        for (const auto& [name, value] : page.values_)
            object.set(name, value.kind == PageValues::Value::TEXT ? data(toUtf8(value.text))
                       : value.kind == PageValues::Value::FLAG ? data(value.flag) : listOf(value.list));
        return object;
    }

private:
    static data listOf(const PageList& entries)
    {
        data list{data::type::list};
        for (const PageValues& entry : entries)
            list << dataOf(entry);
        return list;
    }
};

PageList pageList(const std::vector<std::string>& texts)
{
    PageList list;
    for (const std::string& text : texts)
        list.push_back({{"text", text}});
    return list;
}

std::string renderPage(const std::string& name, const char* pageTemplate, const PageValues& page)
{
    kainjow::mustache::mustache mustache(pageTemplate);
    const std::string text = mustache.render(PageConverter::dataOf(page));
    if (!mustache.is_valid())
        throw Failure(name + "'s template is broken: " + mustache.error_message());
    return text;
}

} // namespace tools
