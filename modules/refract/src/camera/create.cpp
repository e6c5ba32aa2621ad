// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/arrays.hpp"
#include "camera/camera.hpp"

/* Which lens a camera gets, made by a caller or named in a file: with lens.hpp the only place that knows all lens models. */

namespace cv { namespace refract {

Ptr<RefractiveCamera> RefractiveCamera::create(InputArray cameraMatrix, InputArray distCoeffs,
                                               const GlassWindow& window)
{
    return makePtr<Camera>(makeOpenCVLens(readCameraMatrix(cameraMatrix, "cameraMatrix"),
                                          readDistCoeffs(distCoeffs, "distCoeffs")), window);
}

Ptr<RefractiveCamera> RefractiveCamera::createFisheye(InputArray cameraMatrix, InputArray distCoeffs,
                                                      const GlassWindow& window)
{
    return makePtr<Camera>(makeFisheyeLens(readCameraMatrix(cameraMatrix, "cameraMatrix"),
                                           readNumbers(distCoeffs, "distCoeffs")), window);
}

Ptr<RefractiveCamera> RefractiveCamera::createMrcal(const String& lensModel, InputArray intrinsics,
                                                    const GlassWindow& window)
{
    return makePtr<Camera>(makeMrcalLens(lensModel, readNumbers(intrinsics, "intrinsics")), window);
}

Ptr<Lens> makeLens(const String& model, const Mat& K, const Mat& D)
{
    const Matx33d cameraMatrix = readCameraMatrix(K, "camera_matrix");
    if (model == "opencv")
        return makeOpenCVLens(cameraMatrix, readDistCoeffs(D, "distortion_coefficients"));
    if (model == "fisheye")
        return makeFisheyeLens(cameraMatrix, readNumbers(D, "distortion_coefficients"));
    std::vector<double> intrinsics = { cameraMatrix(0, 0), cameraMatrix(1, 1), cameraMatrix(0, 2), cameraMatrix(1, 2) };
    const std::vector<double> d = readNumbers(D, "distortion_coefficients");
    intrinsics.insert(intrinsics.end(), d.begin(), d.end());
    return makeMrcalLens(model, intrinsics);
}

}} // namespace
