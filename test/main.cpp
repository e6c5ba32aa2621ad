// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
