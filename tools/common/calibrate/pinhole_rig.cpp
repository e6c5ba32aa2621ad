#include "calibrate/pinhole_rig.hpp"
#include "calibrate/pinhole_camera.hpp"
#include "console/cli.hpp"
#include <opencv2/calib3d.hpp>

using namespace cv;

namespace tools {

namespace {

const size_t MIN_VIEWS = 3;         // of a flat board, to determine a lens

//! Corners that both cameras saw through their windows, moment by moment.
void commonCorners(const RigData& data, const std::vector<int>& moments, std::vector<std::vector<Point3f>>& object,
                   std::vector<std::vector<Point2f>> image[2])
{
    for (int moment : moments)
    {
        const Moment& m = data.moments[moment];
        if (!m.hasGlass(0) || !m.hasGlass(1))
            continue;
        object.emplace_back();
        for (int c = 0; c < 2; c++)
            image[c].emplace_back();
        for (size_t i = 0; i < data.objectPoints.size(); i++)
        {
            if (std::isnan(m.glass[0][i].x) || std::isnan(m.glass[1][i].x))
                continue;
            object.back().emplace_back(data.objectPoints[i]);
            for (int c = 0; c < 2; c++)
                image[c].back().emplace_back(m.glass[c][i]);
        }
    }
}

} // namespace

int pinholeCoefficients(const refract::RefractiveCamera& camera)
{
    const String model = camera.lensModel();
    if (model != "opencv" && model.find("LENSMODEL_") != 0)
        throw Failure("cv::calibrateCamera knows no lens '" + model + "'");
    return camera.lensParameters().rows - 4;
}

CameraCalibration calibratePinholeThroughGlass(const RigData& data, int camera, const std::vector<int>& moments,
                                               int coefficients)
{
    std::vector<std::vector<Point2d>> views;
    for (int i : moments)
        if (data.moments[i].hasGlass(camera))
            views.push_back(data.moments[i].glass[camera]);
    if (views.size() < MIN_VIEWS)
        throw Failure("--pinhole-out needs at least 3 images through the window for each camera");
    CameraCalibration result;
    result.camera = calibratePinhole(data.objectPoints, views, data.imageSize[camera], coefficients, result.rms);
    return result;
}

Calibration calibratePinholeRig(const RigData& data, const std::vector<int>& moments, int coefficients)
{
    Calibration rig;
    for (int c = 0; c < data.cameraCount; c++)
        rig.cameras.push_back(calibratePinholeThroughGlass(data, c, moments, coefficients));
    rig.rms = rig.cameras[0].rms;
    if (!rig.stereo())
        return rig;

    std::vector<std::vector<Point3f>> object;
    std::vector<std::vector<Point2f>> image[2];
    commonCorners(data, moments, object, image);
    if (object.empty())
        throw Failure("--pinhole-out needs a moment that both cameras see through their windows");
    Mat K[2], D[2], E, F;
    for (int c = 0; c < 2; c++)
    {
        K[c] = rig.cameras[c].camera->cameraMatrix();
        D[c] = rig.cameras[c].camera->distCoeffs();
    }
    rig.rms = stereoCalibrate(object, image[0], image[1], K[0], D[0], K[1], D[1], data.imageSize[0], rig.R, rig.T, E, F,
                              CALIB_FIX_INTRINSIC);
    return rig;
}

} // namespace tools
