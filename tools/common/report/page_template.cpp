// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/page_template.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"

#include <kainjow/mustache.hpp>

using kainjow::mustache::data;

namespace tools {

static data dataOf(const Json& page)
{
    data object;
    for (const std::string& name : page.names())
    {
        const Json& value = page.at(name);
        if (value.isText())
            object.set(name, data(toUtf8(value.asText())));
        else if (!value.isList())
            object.set(name, data(value.asFlag()));
        else
        {
            data list{data::type::list};
            for (const Json& entry : value.items())
                list << dataOf(entry);
            object.set(name, list);
        }
    }
    return object;
}

std::vector<Json> pageList(const std::vector<std::string>& texts)
{
    std::vector<Json> list;
    for (const std::string& text : texts)
        list.push_back({{"text", text}});
    return list;
}

std::string renderPage(const std::string& name, const char* pageTemplate, const Json& page)
{
    kainjow::mustache::mustache mustache(pageTemplate);
    const std::string text = mustache.render(dataOf(page));
    if (!mustache.is_valid())
        throw Failure(name + "'s template is broken: " + mustache.error_message());
    return text;
}

} // namespace tools
