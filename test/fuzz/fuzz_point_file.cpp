// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/csv.hpp"
#include "file_harness.hpp"

// Points for refract_epilines --points.

const char fuzz::EXTENSION[] = ".txt";

void fuzz::tryFile(const std::string& path)
{
    const std::vector<cv::Point2d> points = tools::readPixels(path);
    promise(!points.empty() && cv::checkRange(points), "there are points, all finite");
}
