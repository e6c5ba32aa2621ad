// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/emitter.hpp"
#include "calibrate/rigid_transform.hpp"
#include "camera/storage.hpp"
#include "console/failure.hpp"
#include "console/keys.hpp"
#include <opencv2/core/persistence.hpp>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

FileStorage openDescription(const std::string& filename, const std::string& content)
{
    std::string reason = "it holds no map";
    try
    {
        const FileStorage fs = cv::refract::openStorage(filename);
        if (fs.isOpened() && fs.root().isMap())
            return fs;
    }
    catch (const cv::Exception& e)
    {
        reason = e.err;
    }
    throw Failure("cannot read '" + filename + "' (" + reason + "): it must describe " + content);
}

std::vector<std::string> emitterKeys()
{
    return {"image_width", "image_height", "camera_matrix", "distortion_coefficients", "lens_model", "glass_window", "rvec", "tvec",
            "line"};
}

Emitter readEmitter(const cv::FileNode& node, const std::string& name, bool needsLine)
{
    const Keys keys(node, name);
    for (const char* key : {"camera_matrix", "distortion_coefficients", "rvec", "tvec"})
        if (!keys.has(key))
            throw Failure(name + ": '" + key + "' is missing; an emitter has the keys of a camera, and rvec and tvec, camera 1 -> emitter");
    Emitter emitter;
    try
    {
        emitter.camera = RefractiveCamera::read(node);
    }
    catch (const cv::Exception& e)
    {
        throw Failure(name + ": " + e.err);
    }
    emitter.R = rotationMatrix(keys.vector("rvec"));
    emitter.position = -(emitter.R.t()*keys.vector("tvec"));
    if (needsLine || keys.has("line"))
        emitter.line = keys.number("line", -1e6, 1e6);
    return emitter;
}

void writeEmitter(cv::FileStorage& fs, const Emitter& emitter)
{
    emitter.camera->write(fs);
    fs << "rvec" << rotationVector(emitter.R) << "tvec" << emitter.translation();
    if (!std::isnan(emitter.line))
        fs << "line" << emitter.line;
}

} // namespace tools
