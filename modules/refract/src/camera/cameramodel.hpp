// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_CAMERAMODEL_HPP
#define OPENCV_REFRACT_CAMERAMODEL_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

//! What a .cameramodel file of mrcal says of the camera.
struct CameraModel
{
    String lensModel;                   //!< LENSMODEL_...
    std::vector<double> intrinsics;
    Size imageSize;
    Vec3d rvec, tvec;                   //!< reference -> camera
};

//! By its name.
bool isCameraModel(const String& filename);

/** Reads an mrcal .cameramodel: one Python dict of strings, numbers and nested lists, with # comments. Unknown keys (the
optimization inputs) are passed over. Throws with the file's name. */
CameraModel readCameraModel(const String& filename);

//! The camera without a window; where it is stays behind.
Ptr<RefractiveCamera> cameraFrom(const CameraModel& model);

//! A camera that is the reference frame. Throws with the file's name if it has a window, a lens that mrcal has not, or no size.
CameraModel cameraModelOf(const RefractiveCamera& camera, const String& filename);

//! Whole or not at all; each number is read back as it was. Throws with the file's name.
void saveCameraModel(const String& filename, const CameraModel& model);

}} // namespace

#endif // OPENCV_REFRACT_CAMERAMODEL_HPP
