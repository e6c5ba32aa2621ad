// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/rig_calibration.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/point_error.hpp"
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
            const Point3d X = cam1_from_board.apply(Vec3d(object[i]));
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
            depths.push_back(cam_from_board.apply(Vec3d(X))[2]);
    }
    std::sort(depths.begin(), depths.end());
    return depths.empty() ? Vec3d(NONE, NONE, NONE) : Vec3d(depths.front(), depths[depths.size()/2], depths.back());
}

namespace {

const double AS_WELL = 1.02;            // times the RMS: a window that gains less than two percent of it
const int COLUMNS = 9;

//! Of a tube: across its axis.
double offsetStdOf(const Fit& fit, int camera, const GlassWindow& window)
{
    const ParameterColumns at = columnsOf(fit.rig, camera);
    const Mat covariance = fit.covariance(Rect(at.center, at.center, 3, 3));
    const Vec3d along = window.shape == WINDOW_TUBE ? window.axis : Vec3d();
    const Mat across = Mat::eye(3, 3, CV_64F) - Mat(along)*Mat(along).t();
    return lengthOf(toEigen(across*Mat(window.center)), toEigen(across*covariance*across.t())).std;
}

} // namespace

double tiltStdDegrees(const Fit& fit, int camera)
{
    const Vec3d n = fit.rig.cameras[camera]->window().normal;
    const int at = columnsOf(fit.rig, camera).normal;
    const double sine = std::hypot(n[0], n[1]), tilt = std::atan2(sine, n[2]);
    const Vec2d to = sine > 0. ? Vec2d(n[0], n[1])/sine : Vec2d(1., 0.);
    const double turn = sine > 0. ? tilt/sine : 1.;
    // The tilt as a rotation vector, along the tilt and across it, by the normal.
    const Matx23d byNormal(to[0]*n[2], to[1]*n[2], -sine, -to[1]*turn, to[0]*turn, 0.);
    const Mat covariance = Mat(byNormal)*fit.covariance(Rect(at, at, 3, 3))*Mat(byNormal).t();
    return lengthOf(Eigen::Vector2d(tilt, 0.), toEigen(covariance)).std*180./CV_PI;
}

namespace {

//! From where pixels see points without the window to where they see them with it.
void moveOf(const RigCalibration& c, int camera, RoundWindow& result)
{
    const Ptr<RefractiveCamera>& through = c.fit.rig.cameras[camera];
    const Ptr<RefractiveCamera> bare = copyWithWindow(through, GlassWindow());
    Size grid;
    const std::vector<Point2d> pixels = gridOver(c.data.imageSize[camera], COLUMNS, grid);
    std::vector<Point3d> with, without;
    std::vector<Point2d> seen;
    const Vec4d plane(0, 0, 1, result.depth);
    refractivePointsOnPlane(pixels, with, through, plane);
    refractivePointsOnPlane(pixels, without, bare, plane);
    refractiveProjectPoints(with, Vec3d(), Vec3d(), bare, seen);
    for (size_t i = 0; i < pixels.size(); i++)
    {
        result.px = std::fmax(result.px, norm(seen[i] - pixels[i]));
        result.length = std::fmax(result.length, norm(with[i] - without[i]));
    }
}

} // namespace

bool RoundWindow::isNeedless() const { return ignoredPx < AS_WELL*withPx; }

std::string RoundWindow::offsetWords(const std::string& unit) const
{
    return plusMinus(offset, offsetStd) + " " + unit + " from the camera, which moves points by up to "
        + format("%.2g px (%.2g %s at z = %.4g %s)", px, length, unit.c_str(), depth, unit.c_str());
}

std::string RoundWindow::needless(const std::string& unit) const
{
    if (!isNeedless())
        return "";
    return format("that the %s has to be modelled: with it ignored, each board where it then fits best, the images fit as well (%.3f px, "
                  "with it %.3f px). It moves points by up to %.2g %s, nearly all alike", shape.c_str(), ignoredPx, withPx, length,
                  unit.c_str()) + (shape == "dome" ? ": a camera in the centre of a dome sees as without one" : "");
}

std::optional<RoundWindow> roundWindowOf(const RigCalibration& c, int camera)
{
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    if (!isRound(window))
        return std::nullopt;
    RoundWindow result{nameOfShape(window), offsetOf(window), offsetStdOf(c.fit, camera, window), 0., 0., workingDepth(c, camera)[1],
                       rmsOf(c, camera, true).px, c.baselines.glassIgnored[camera]};
    moveOf(c, camera, result);
    return result;
}

std::string placeInWords(const RigCalibration& c, int camera)
{
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    if (isRound(window))
        return plusMinus(offsetOf(window), offsetStdOf(c.fit, camera, window)) + " " + c.unit;
    return plusMinus(tiltDegrees(window), tiltStdDegrees(c.fit, camera)) + " degrees";
}

} // namespace tools
