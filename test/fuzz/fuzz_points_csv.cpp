// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "file_harness.hpp"
#include "target/detected_images.hpp"

// Observed points of any target, for all tools that take images of one.

const char fuzz::EXTENSION[] = ".csv";

void fuzz::tryFile(const std::string& path)
{
    for (const tools::DetectedImage& image : tools::readPointsCsv(path))
    {
        promise(!image.stem.empty() && image.points.size() == image.objectPoints.size(), "each view has a name, each point a pixel");
        promise(cv::checkRange(image.objectPoints), "the target's points are finite");
    }
}
