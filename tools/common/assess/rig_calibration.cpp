// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/rig_calibration.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>
#include <set>

using namespace cv;
using namespace cv::refract;

namespace tools {

std::vector<Rejected> rejectedOf(const RigCalibration& calibration)
{
    std::vector<Rejected> all = calibration.fewPoints;
    all.insert(all.end(), calibration.outliers.rejected.begin(), calibration.outliers.rejected.end());
    return all;
}

Rms rmsOf(const RigCalibration& calibration, int camera, bool glass, int view)
{
    Rms rms;
    double sum = 0.;
    std::set<int> views;
    for (const Residual& r : calibration.residuals)
        if (r.camera == camera && r.glass == glass && (view < 0 || r.view == view))
        {
            sum += r.error.dot(r.error);
            rms.points++;
            views.insert(r.view);
        }
    rms.views = (int)views.size();
    if (rms.points)
        rms.px = std::sqrt(sum/rms.points);
    return rms;
}

Rms rmsOfCamera(const RigCalibration& calibration, int camera)
{
    const Rms glass = rmsOf(calibration, camera, true), direct = rmsOf(calibration, camera, false);
    Rms both;
    both.points = glass.points + direct.points;
    both.views = glass.views + direct.views;
    double sum = 0.;
    for (const Rms& part : {glass, direct})
        if (part.points)
            sum += part.px*part.px*part.points;
    if (both.points)
        both.px = std::sqrt(sum/both.points);
    return both;
}

std::string SecondSolution::sentence() const
{
    return format("a second solution fits nearly as well: %s (%.4f, %.4f, %.4f), RMS %.4f px against %.4f px (%.1f standard "
                  "deviations worse; below 3 the data do not exclude it). Take a pair, or boards at other tilts", of.c_str(),
                  normal[0], normal[1], normal[2], rms, fitRms, excess);
}

std::optional<SecondSolution> secondSolution(const RigCalibration& calibration, int camera)
{
    const Mat row = calibration.fit.otherMinima.row(camera);
    const double excess = row.at<double>(3);
    if (std::isnan(excess))
        return std::nullopt;
    const Vec3d normal(row.ptr<double>());
    const std::string of = placeName(calibration.fit.rig.cameras[camera]->window());
    const auto rmsWith = [&](double rms, double dof) { return rms*std::sqrt(1. + excess*excess/dof); };
    // The search that knows of it had all images where none is direct;
    const Fit& fit = calibration.fit;
    if (std::none_of(calibration.residuals.begin(), calibration.residuals.end(), [](const Residual& r) { return !r.glass; }))
        return SecondSolution{normal, of, excess, rmsWith(fit.rms, fit.dof), fit.rms};
    // else those of one camera, that with most points, and their poses and the normal to fit.
    Rms seen = rmsOf(calibration, camera, true);
    for (int other = 0; other < calibration.data.cameraCount; other++)
        if (fit.rig.sharesWindow(camera, other) && rmsOf(calibration, other, true).points > seen.points)
            seen = rmsOf(calibration, other, true);
    return SecondSolution{normal, of, excess, rmsWith(seen.px, 2.*seen.points - 6.*seen.views - 2.), seen.px};
}

double coverage(const RigCalibration& calibration, int camera)
{
    const int COLUMNS = 8, ROWS = 6;
    const Size size = calibration.data.imageSize[camera];
    std::set<int> cells;
    for (const Residual& r : calibration.residuals)
        if (r.camera == camera && r.glass)
            cells.insert((int)(r.pixel.y*ROWS/size.height)*COLUMNS + (int)(r.pixel.x*COLUMNS/size.width));
    return (double)cells.size()/(COLUMNS*ROWS);
}

std::optional<CalibratedVolume> calibratedVolume(const RigCalibration& calibration)
{
    const Fit& fit = calibration.fit;
    std::optional<CalibratedVolume> volume;
    for (size_t k = 0; k < fit.views.size(); k++)
    {
        const View& view = calibration.data.views[fit.views[k]];
        Vec3d rvec = fit.rvecs[k], tvec = fit.tvecs[k];
        poseInImage(fit.rig, 0, true, rvec, tvec);
        const RigidTransform cam1_from_board = transformOf(rvec, tvec);
        const std::vector<Point3d> object = pointsOfTarget(fit.rig, view.objectPoints);
        for (size_t i = 0; i < object.size(); i++)
        {
            const auto sees = [i](const std::vector<Point2d>& pixels) { return i < pixels.size() && seen(pixels[i]); };
            if (std::none_of(view.glass.begin(), view.glass.end(), sees))
                continue;
            const Point3d X = cam1_from_board*Vec3d(object[i]);
            if (!volume)
                volume = CalibratedVolume{X, X};
            volume->least = {std::min(volume->least.x, X.x), std::min(volume->least.y, X.y), std::min(volume->least.z, X.z)};
            volume->most = {std::max(volume->most.x, X.x), std::max(volume->most.y, X.y), std::max(volume->most.z, X.z)};
        }
    }
    return volume;
}

Vec3d workingDepth(const RigCalibration& calibration, int camera)
{
    std::vector<double> depths;
    const Fit& fit = calibration.fit;
    for (size_t k = 0; k < fit.views.size(); k++)
    {
        const View& view = calibration.data.views[fit.views[k]];
        if (!view.hasGlass(camera))
            continue;
        Vec3d rvec, tvec;
        poseInCamera(fit, k, camera, rvec, tvec);
        const RigidTransform cam_from_board = transformOf(rvec, tvec);
        for (const Point3d& X : view.objectPoints)
            depths.push_back((cam_from_board*Vec3d(X))[2]);
    }
    std::sort(depths.begin(), depths.end());
    return depths.empty() ? Vec3d(NONE, NONE, NONE) : Vec3d(depths.front(), depths[depths.size()/2], depths.back());
}

} // namespace tools
