// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/export_files.hpp"
#include "console/file_output.hpp"

namespace tools {

//! Keys of a camera, in the map that is open.
static void writeCamera(cv::FileStorage& fs, const CentralRig& rig, const ExportedCamera& camera)
{
    const CentralError& e = camera.central.error;
    camera.central.camera->write(fs);
    fs << "central_R" << cv::Mat(camera.pose.R) << "central_T" << cv::Mat(camera.pose.t);
    fs << "central_error" << "{" << "z_near" << rig.range[0] << "z_far" << rig.range[1] << "rms_px" << e.rms << "max_px" << e.max
       << "rms_length" << e.lengthRms << "max_length" << e.lengthMax << "}";
}

void writeOpenCV(const std::string& path, const CentralRig& rig)
{
    writeStorage(path, ".yml", [&](cv::FileStorage& fs)
    {
        if (fs.getFormat() == cv::FileStorage::FORMAT_JSON)     // which has no comments
            fs << "comment" << headText(rig);
        else
            fs.writeComment(headText(rig));
        const std::vector<ExportedCamera>& cameras = rig.cameras;
        if (cameras.size() == 1)
            writeCamera(fs, rig, cameras[0]);
        for (size_t c = 0; c < cameras.size() && cameras.size() > 1; c++)
        {
            fs << cameras[c].name << "{";
            writeCamera(fs, rig, cameras[c]);
            fs << "}";
        }
        for (size_t c = 1; c < cameras.size(); c++)
        {
            const std::string number = c == 1 ? "" : std::to_string(c + 1);
            const RigidTransform place = fromTo(cameras[0].pose, cameras[c].pose);
            fs << "R" + number << cv::Mat(place.R) << "T" + number << cv::Mat(place.t);
        }
    });
}

} // namespace tools
