// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PAGE_TEMPLATE_HPP
#define REFRACT_TOOLS_PAGE_TEMPLATE_HPP

#include "console/failure.hpp"
#include <kainjow/mustache.hpp>

namespace tools {

//! Throws Failure if the template is broken. @param name for the text: "the report"
inline std::string renderPage(const std::string& name, const char* pageTemplate, const kainjow::mustache::data& page)
{
    kainjow::mustache::mustache mustache(pageTemplate);
    const std::string text = mustache.render(page);
    if (!mustache.is_valid())
        throw Failure(name + "'s template is broken: " + mustache.error_message());
    return text;
}

} // namespace tools

#endif // REFRACT_TOOLS_PAGE_TEMPLATE_HPP
