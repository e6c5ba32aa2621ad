// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "file_harness.hpp"

// A camera in OpenCV's YAML, XML or JSON; what was read is written and read again.

using namespace cv::refract;

const char fuzz::EXTENSION[] = ".yml";

void fuzz::tryFile(const std::string& path)
{
    const cv::Ptr<RefractiveCamera> camera = RefractiveCamera::read(path);
    promise(cv::checkRange(camera->cameraMatrix()) && cv::checkRange(camera->distCoeffs()), "what was read is finite");
    camera->window().check();
    const std::string copy = (scratch().path() / "copy.yml").string();
    camera->save(copy);
    const cv::Ptr<RefractiveCamera> again = RefractiveCamera::read(copy);
    promise(cv::norm(camera->lensParameters(), again->lensParameters(), cv::NORM_INF) == 0 && camera->lensModel() == again->lensModel()
            && camera->imageSize() == again->imageSize(), "a camera that is read again is what was saved");
}
