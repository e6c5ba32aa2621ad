// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/arrays.hpp"
#include "camera/camera.hpp"
#include "lens/models.hpp"

/* A camera from what a caller gives; the models of lenses are in lens/models.hpp. */

namespace cv { namespace refract {

Ptr<Lens> readLens(const String& model, InputArray cameraMatrix, InputArray distCoeffs, const char* nameOfMatrix,
                   const char* nameOfCoefficients)
{
    const Matx33d K = readCameraMatrix(cameraMatrix, nameOfMatrix);
    return makeLens({ model, K, readNumbers(distCoeffs, nameOfCoefficients), nameOfCoefficients });
}

Ptr<RefractiveCamera> RefractiveCamera::create(InputArray cameraMatrix, InputArray distCoeffs,
                                               const GlassWindow& window)
{
    return makePtr<Camera>(readLens("opencv", cameraMatrix, distCoeffs), window);
}

Ptr<RefractiveCamera> RefractiveCamera::createFisheye(InputArray cameraMatrix, InputArray distCoeffs,
                                                      const GlassWindow& window)
{
    return makePtr<Camera>(readLens("fisheye", cameraMatrix, distCoeffs), window);
}

Ptr<RefractiveCamera> RefractiveCamera::createMrcal(const String& lensModel, InputArray intrinsics,
                                                    const GlassWindow& window)
{
    return makePtr<Camera>(makeMrcalLens(lensModel, readNumbers(intrinsics, "intrinsics")), window);
}

Ptr<RefractiveCamera> RefractiveCamera::createByName(const String& lensModel, InputArray cameraMatrix, InputArray distCoeffs,
                                                     const GlassWindow& window)
{
    return makePtr<Camera>(readLens(lensModel, cameraMatrix, distCoeffs), window);
}

std::vector<String> RefractiveCamera::lensModels()
{
    std::vector<String> names;
    for (const LensModel& model : refract::lensModels())
        names.push_back(model.pattern());
    return names;
}

}} // namespace
