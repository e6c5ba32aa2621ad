// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The version in the header is the project's.
#include "scenes.hpp"

TEST_CASE("The header's version is the project's", "[version]")
{
    CHECK(std::string(CV_REFRACT_VERSION) == REFRACT_PROJECT_VERSION);
    CHECK(cv::format("%d.%d.%d", CV_REFRACT_VERSION_MAJOR, CV_REFRACT_VERSION_MINOR, CV_REFRACT_VERSION_PATCH) == REFRACT_PROJECT_VERSION);
}
