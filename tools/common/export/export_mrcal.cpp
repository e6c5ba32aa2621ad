// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/export_files.hpp"

#include <opencv2/calib3d.hpp>

namespace tools {

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
        const cv::Mat lens = camera.central.camera->lensParameters();
        cv::Mat rt;
        cv::Rodrigues(camera.R, rt);
        rt.push_back(cv::Mat(camera.T));
        const cv::Size size = camera.central.camera->imageSize();
        files.push_back({camera.name + ".cameramodel",
            "# " + headText(rig) + "\n# " + errorText(rig, camera) + "\n{\n"
            + cv::format("    'lensmodel':  'LENSMODEL_OPENCV%d',\n\n", (int)lens.total() - 4)
            + "    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....\n    'intrinsics': [ " + numbers(lens) + "],\n\n"
            + "    # extrinsics are rt_fromref\n    'extrinsics': [ " + numbers(rt) + "],\n\n"
            + cv::format("    'imagersize': [ %d, %d],\n}\n", size.width, size.height)});
    }
    return files;
}

} // namespace tools
