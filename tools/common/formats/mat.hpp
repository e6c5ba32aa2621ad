// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MAT_HPP
#define REFRACT_TOOLS_MAT_HPP

#include "console/json.hpp"

namespace tools {

/** MATLAB's file of variables (level 5, as save -v6 and -v7 write it): numbers by name, matrices as lists of rows, structs as
objects. In place of an object of a class stands the text "object"; cells are passed over. Throws Failure. */
Json readMat(const std::string& bytes);

} // namespace tools

#endif // REFRACT_TOOLS_MAT_HPP
