// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PAGE_TEMPLATE_HPP
#define REFRACT_TOOLS_PAGE_TEMPLATE_HPP

#include "console/json.hpp"
#include <string>
#include <vector>

/* Pages are mustache templates: {{name}} is a text, {{#name}} ... {{/name}} a part that is there if a flag is set, or once for each
entry of a list. The library with its templates is in page_template.cpp alone. */
namespace tools {

//! An entry for each text, which it calls "text".
std::vector<Json> pageList(const std::vector<std::string>& texts);

/** Throws Failure if the template is broken.
@param name for the text: "the report" @param page an object of texts, flags and lists of such objects */
std::string renderPage(const std::string& name, const char* pageTemplate, const Json& page);

} // namespace tools

#endif // REFRACT_TOOLS_PAGE_TEMPLATE_HPP
