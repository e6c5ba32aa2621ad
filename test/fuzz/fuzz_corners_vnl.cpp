// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "file_harness.hpp"
#include "target/detected_images.hpp"

// mrcal's corners.vnl, of a target of six points.

const char fuzz::EXTENSION[] = ".vnl";

void fuzz::tryFile(const std::string& path)
{
    for (const auto& image : tools::readCornersVnl(path, 6))
        promise(image.second.empty() || image.second.size() == 6, "an image has all points or none");
}
