// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/export_files.hpp"

#include <opencv2/calib3d.hpp>

namespace tools {

using cv::Mat;

namespace {

//! A matrix as CameraInfo's parsers read it.
std::string block(const std::string& name, const Mat& values)
{
    std::string text = cv::format("%s:\n  rows: %d\n  cols: %d\n  data: [", name.c_str(), values.rows, values.cols);
    for (int i = 0; i < (int)values.total(); i++)
        text += cv::format("%s%.12g", i ? ", " : "", values.ptr<double>(i/values.cols)[i % values.cols]);
    return text + "]\n";
}

bool isFisheye(const ExportedCamera& camera) { return camera.central.camera->lensModel() == "fisheye"; }

//! Of a pair: what cv::stereoRectify says; of other rigs each camera for itself.
void findRectification(const CentralRig& rig, std::vector<Mat>& R, std::vector<Mat>& P)
{
    for (const ExportedCamera& camera : rig.cameras)
    {
        R.push_back(Mat::eye(3, 3, CV_64F));
        P.push_back(Mat::zeros(3, 4, CV_64F));
        camera.central.camera->cameraMatrix().copyTo(P.back().colRange(0, 3));
    }
    if (rig.cameras.size() != 2)
        return;
    const ExportedCamera &a = rig.cameras[0], &b = rig.cameras[1];
    const auto &first = a.central.camera, &second = b.central.camera;
    const RigidTransform place = fromTo(a.pose, b.pose);
    Mat Q;
    if (isFisheye(a))
        cv::fisheye::stereoRectify(first->cameraMatrix(), first->distCoeffs(), second->cameraMatrix(), second->distCoeffs(),
                                   first->imageSize(), place.R, place.t, R[0], R[1], P[0], P[1], Q, cv::CALIB_ZERO_DISPARITY);
    else
        cv::stereoRectify(first->cameraMatrix(), first->distCoeffs(), second->cameraMatrix(), second->distCoeffs(),
                          first->imageSize(), place.R, place.t, R[0], R[1], P[0], P[1], Q);
}

} // namespace

std::vector<ExportFile> rosFiles(const CentralRig& rig)
{
    std::vector<Mat> R, P;
    findRectification(rig, R, P);
    std::vector<ExportFile> files;
    for (size_t c = 0; c < rig.cameras.size(); c++)
    {
        const ExportedCamera& camera = rig.cameras[c];
        const auto& lens = camera.central.camera;
        const int coefficients = (int)lens->distCoeffs().total();
        const char* model = isFisheye(camera) ? "equidistant" : coefficients > 5 ? "rational_polynomial" : "plumb_bob";
        files.push_back({camera.name + ".yaml",
            "# " + headText(rig) + "\n# " + errorText(rig, camera) + "\n"
            + cv::format("image_width: %d\nimage_height: %d\ncamera_name: %s\n", lens->imageSize().width, lens->imageSize().height,
                         camera.name.c_str())
            + block("camera_matrix", lens->cameraMatrix()) + "distortion_model: " + model + "\n"
            + block("distortion_coefficients", lens->distCoeffs().reshape(1, 1)) + block("rectification_matrix", R[c])
            + block("projection_matrix", P[c])});
    }
    return files;
}

} // namespace tools
