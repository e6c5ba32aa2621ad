// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/round_window.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"
#include "measure/point_error.hpp"
#include "measure/vector_length.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

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
    return plusMinus(tiltDegrees(window), windowStd(c.fit, camera).normalDeg[0]) + " degrees";
}

} // namespace tools
