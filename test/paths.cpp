// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "paths.hpp"
#include <cstdlib>

namespace paths {

std::string data()
{
    const char* given = std::getenv("REFRACT_DATA_DIR");
    return given ? given : REFRACT_DATA_DIR;
}

std::string tests() { return REFRACT_TEST_DIR; }
std::string bundled() { return REFRACT_BUNDLED_DIR; }
std::string programs() { return REFRACT_BIN_DIR; }

} // namespace paths
