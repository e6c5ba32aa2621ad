// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/calib_file.hpp"
#include "file_harness.hpp"

// calib.yml as the tools read it; what was read is written and read again.

const char fuzz::EXTENSION[] = ".yml";

void fuzz::tryFile(const std::string& path)
{
    const tools::Calibration calibration = tools::readCalibration(path);
    promise(!calibration.cameras.empty(), "at least one camera");
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        const tools::RigidTransform& cam_from_cam1 = calibration.extrinsics.at(c);
        promise(cv::checkRange(cv::Mat(cam_from_cam1.R)) && cv::checkRange(cv::Mat(cam_from_cam1.T)), "R and T are finite");
    }
    const std::string copy = (scratch().path() / "copy.yml").string();
    tools::writeCalibration(copy, calibration);
    const tools::Calibration again = tools::readCalibration(copy);
    promise(again.cameras.size() == calibration.cameras.size(), "a calibration that is read again has the same cameras");
}
