// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Where the tests find files. paths.cpp alone is compiled with them, so that a compiler cache serves every clone.
#ifndef REFRACT_TEST_PATHS_HPP
#define REFRACT_TEST_PATHS_HPP

#include <string>

namespace paths {

//! Real data: the environment's REFRACT_DATA_DIR, or where CMake was told. The folder may be absent.
std::string data();
//! The folder of the tests.
std::string tests();
//! samples/data
std::string bundled();
//! The built programs.
std::string programs();

} // namespace paths

#endif // REFRACT_TEST_PATHS_HPP
