// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_NPZ_HPP
#define REFRACT_TOOLS_NPZ_HPP

#include "console/json.hpp"

namespace tools {

/** NumPy's archive of arrays, as savez and savez_compressed write it: its numbers by name, each array as lists of rows; arrays
of objects and texts are passed over. Throws Failure. */
Json readNpz(const std::string& bytes);

} // namespace tools

#endif // REFRACT_TOOLS_NPZ_HPP
