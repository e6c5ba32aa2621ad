// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/export_files.hpp"
#include "calibrate/rigid_transform.hpp"

namespace tools {

//! As mrcal calls it. OpenCV's lens has mrcal's parameters, in its order.
static std::string modelName(const cv::refract::RefractiveCamera& camera)
{
    return camera.lensModel() == "opencv" ? cv::format("LENSMODEL_OPENCV%d", (int)camera.distCoeffs().total()) : camera.lensModel();
}

static std::string numbers(const cv::Mat& values)
{
    std::string text;
    for (int i = 0; i < (int)values.total(); i++)
        text += cv::format("%s%.17g", i ? ", " : "", values.at<double>(i));
    return text;
}

std::vector<ExportFile> mrcalFiles(const CentralRig& rig)
{
    std::vector<ExportFile> files;
    for (const ExportedCamera& camera : rig.cameras)
    {
        const cv::Mat K = camera.central.camera->cameraMatrix();
        cv::Mat lens = (cv::Mat_<double>(4, 1) << K.at<double>(0, 0), K.at<double>(1, 1), K.at<double>(0, 2), K.at<double>(1, 2)), rt;
        lens.push_back(camera.central.camera->distCoeffs());
        rt.push_back(cv::Mat(rotationVector(camera.pose.R)));
        rt.push_back(cv::Mat(camera.pose.t));
        const cv::Size size = camera.central.camera->imageSize();
        files.push_back({camera.name + ".cameramodel",
            "# " + headText(rig) + "\n# " + errorText(rig, camera) + "\n{\n"
            + "    'lensmodel':  '" + modelName(*camera.central.camera) + "',\n\n"
            + "    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....\n    'intrinsics': [ " + numbers(lens) + "],\n\n"
            + "    # extrinsics are rt_fromref\n    'extrinsics': [ " + numbers(rt) + "],\n\n"
            + cv::format("    'imagersize': [ %d, %d],\n}\n", size.width, size.height)});
    }
    return files;
}

} // namespace tools
