// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "file_harness.hpp"

// mrcal's .cameramodel.

using namespace cv::refract;

const char fuzz::EXTENSION[] = ".cameramodel";

void fuzz::tryFile(const std::string& path)
{
    const cv::Ptr<RefractiveCamera> camera = RefractiveCamera::read(path);
    promise(cv::checkRange(camera->lensParameters()), "what was read is finite");
}
