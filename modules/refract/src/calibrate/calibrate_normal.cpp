// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The normal from pairs: arguments and results. */

#include "start/normal_from_pairs.hpp"
#include "arrays/arrays.hpp"
#include "calibrate/calibration_error.hpp"

namespace cv { namespace refract {

static double calibrateNormal(InputArrayOfArrays imagePointsDirect, InputArrayOfArrays imagePointsRefracted,
                              const Camera& camera, OutputArray normal, OutputArray distortionCenter,
                              OutputArray normalCovariance)
{
    const PixelViews direct = readPixelViews(imagePointsDirect, "imagePointsDirect");
    const PixelViews refracted = readPixelViews(imagePointsRefracted, "imagePointsRefracted");
    if (direct.size() != refracted.size())
        CV_Error_(Error::StsUnmatchedSizes, ("imagePointsDirect has %d views, imagePointsRefracted %d; they must agree",
                                             (int)direct.size(), (int)refracted.size()));
    for (size_t i = 0; i < direct.size(); i++)
        if (direct[i].size() != refracted[i].size())
            CV_Error_(Error::StsUnmatchedSizes, ("imagePointsDirect[%d] has %d points, imagePointsRefracted[%d] %d; "
                                                 "they must agree", (int)i, (int)direct[i].size(), (int)i,
                                                 (int)refracted[i].size()));

    const NormalEstimate estimate = normalFromPairs(camera, direct, refracted);
    if (!estimate.undetermined.empty())
        raise(CalibrationError(CalibrationError::UNDETERMINED, "the normal is undetermined: " + estimate.undetermined,
                               estimate.undetermined));
    const Vec3d& n = estimate.normal;
    Mat(n).copyTo(normal);
    if (distortionCenter.needed())
    {
        const Matx33d K = camera.cameraMatrix();
        Mat(Vec2d(K(0, 2) + K(0, 0)*n[0]/n[2], K(1, 2) + K(1, 1)*n[1]/n[2])).copyTo(distortionCenter);
    }
    if (normalCovariance.needed())
        Mat(estimate.covariance).copyTo(normalCovariance);
    return estimate.rms;
}

double calibrateGlassNormal(InputArrayOfArrays imagePointsDirect, InputArrayOfArrays imagePointsRefracted,
                            InputArray cameraMatrix, InputArray distCoeffs, OutputArray normal,
                            OutputArray distortionCenter, OutputArray normalCovariance)
{
    CV_INSTRUMENT_REGION();

    return calibrateGlassNormal(imagePointsDirect, imagePointsRefracted,
                                RefractiveCamera::create(cameraMatrix, distCoeffs), normal, distortionCenter,
                                normalCovariance);
}

double calibrateGlassNormal(InputArrayOfArrays imagePointsDirect, InputArrayOfArrays imagePointsRefracted,
                            const Ptr<RefractiveCamera>& camera, OutputArray normal, OutputArray distortionCenter,
                            OutputArray normalCovariance)
{
    CV_INSTRUMENT_REGION();

    return calibrateNormal(imagePointsDirect, imagePointsRefracted, cameraOf(camera), normal, distortionCenter,
                           normalCovariance);
}

}} // namespace
