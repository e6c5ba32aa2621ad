// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/tolerance.hpp"
#include "measure/measurement.hpp"
#include "measure/point_error.hpp"
#include "assess/wedge.hpp"
#include "calibrate/image_fit.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include "console/progress.hpp"
#include "console/table.hpp"
#include "math/dense.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double THICKNESS_MM = 0.1;
const double INDEX = 0.001;            // of a given number
const double RADIUS_MM = 0.1;
const double NUDGE_MM = 0.1;
const double SQUARE = 0.001;            // share of it
const double BOW_MM = 0.1;
const int GRID_COLUMNS = 9;

//! One cause: the wrong values that are calibrated with, and how it bends the images (empty: not at all).
struct Cause
{
    std::string name;
    int camera;                         //!< in whose frame tilts are, and its window's if `own`
    bool own;                           //!< of that window alone; else of all
    std::function<void(GlassWindow&)> spoil;
    std::vector<Vec3d> tilts;           //!< of the outer surface, each tried on its own
    bool nudge = false;                 //!< they are not tilts but shifts of the boards seen through the window, camera 1
    std::function<void(std::vector<Point3d>&)> deform = nullptr;        //!< the board that is seen

    bool concerns(const RigModel& rig, int k) const { return !own || rig.sharesWindow(camera, k); }
};

//! One pane before several cameras lies to each as R turns it, and is thicker there by the way along the tilt.
Wedge wedgeBefore(const RigModel& rig, const Cause& cause, int camera, const Vec3d& tilt)
{
    const Matx33d R = rig.extrinsics[camera].R*rig.extrinsics[cause.camera].R.t();             // from the camera whose frame the tilt is in
    const Vec3d T = rig.extrinsics[camera].T - R*rig.extrinsics[cause.camera].T;
    return {R*tilt, tilt.dot(R.t()*T)};
}

//! Points of the working volume as the calibrated rig sees them.
class Volume
{
public:
    explicit Volume(const RigCalibration& c)
    {
        const Calibration truth = calibrationOf(c.fit.rig);
        std::vector<double> ranges;
        const Vec3d depth = workingDepth(c, 0);
        for (double z : {depth[0], 0.5*(depth[0] + depth[2]), depth[2]})
        {
            seen_.push_back(pointsAtRange(truth, gridOver(c.data.imageSize[0], GRID_COLUMNS, grid_), z));
            range_.push_back(z);
        }
    }

    //! Measured by another rig, from images bent by a wedge, minus true; NaN where not seen.
    std::vector<Vec3d> displacements(const RigModel& truth, const RigModel& rig, const Cause& cause, const Vec3d& tilt) const
    {
        const Calibration calibration = calibrationOf(rig);
        std::vector<Vec3d> moved;
        for (size_t k = 0; k < seen_.size(); k++)
        {
            PointsAtRange s = seen_[k];
            for (int c = 0; c < (int)truth.cameras.size(); c++)
                bend(truth, cause, c, s.points, tilt, s.pixels[c]);
            const Measurement m = calibration.single() ? measureOnPlane(calibration, s.pixels[0], Vec4d(0, 0, 1, range_[k]), 0.)
                                                       : measureRig(calibration, s.pixels, 0.);
            for (size_t i = 0; i < m.points.size(); i++)
                moved.push_back(m.points[i] - s.points[i]);
        }
        return moved;
    }

    //! Relative change of the distance from each point to its right and lower neighbour.
    std::vector<double> stretches(const std::vector<Vec3d>& moved) const
    {
        std::vector<double> result;
        for (size_t k = 0; k < seen_.size(); k++)
            for (int row = 0; row < grid_.height; row++)
                for (int column = 0; column < grid_.width; column++)
                    for (const Point& step : {Point(1, 0), Point(0, 1)})
                    {
                        if (column + step.x >= grid_.width || row + step.y >= grid_.height)
                            continue;
                        const int i = row*grid_.width + column, j = i + step.y*grid_.width + step.x;
                        const Vec3d between = seen_[k].points[j] - seen_[k].points[i];
                        const Vec3d change = moved[k*grid_.area() + j] - moved[k*grid_.area() + i];
                        const double stretch = norm(between + change)/norm(between) - 1.;
                        if (stretch == stretch)
                            result.push_back(stretch);
                    }
        return result;
    }

    static void bend(const RigModel& truth, const Cause& cause, int camera, const std::vector<Point3d>& points,
                     const Vec3d& tilt, std::vector<Point2d>& pixels)
    {
        if (cause.nudge || !cause.concerns(truth, camera) || tilt == Vec3d())
            return;
        std::vector<Point3d> inCamera;
        for (const Point3d& X : points)
            inCamera.push_back(Point3d(truth.extrinsics[camera]*Vec3d(X)));
        const std::vector<Point2d> shift = wedgeShift(truth.cameras[camera], inCamera,
                                                      wedgeBefore(truth, cause, camera, tilt));
        for (size_t i = 0; i < pixels.size(); i++)
            pixels[i] += shift[i];
    }

private:
    Size grid_;
    std::vector<PointsAtRange> seen_;
    std::vector<double> range_;
};

//! The observations as they would be had all boards moved between their direct and their glass image.
RigData nudgedData(const RigCalibration& c, const Vec3d& shift)
{
    RigData data = c.data;
    for (size_t k = 0; k < c.fit.views.size(); k++)
        for (int camera = 0; camera < data.cameraCount; camera++)
        {
            std::vector<Point2d>& pixels = data.views[c.fit.views[k]].glass[camera];
            std::vector<Point2d> before, after;
            for (bool moved : {false, true})
            {
                Vec3d rvec = c.fit.rvecs[k], tvec = c.fit.tvecs[k] + (moved ? shift : Vec3d());
                poseInCamera(c.fit.rig, camera, rvec, tvec);
                refractiveProjectPoints(data.views[c.fit.views[k]].objectPoints, rvec, tvec, c.fit.rig.cameras[camera],
                                        moved ? after : before);
            }
            for (size_t i = 0; i < pixels.size(); i++)
                pixels[i] += after[i] - before[i];
        }
    return data;
}

//! The observations as they would be of another board than is taken for given.
RigData deformedData(const RigCalibration& c, const Cause& cause)
{
    RigData data = c.data;
    for (size_t k = 0; k < c.fit.views.size(); k++)
    {
        View& view = data.views[c.fit.views[k]];
        std::vector<Point3d> deformed = view.objectPoints;
        cause.deform(deformed);
        for (int camera = 0; camera < data.cameraCount; camera++)
            for (bool glass : {false, true})
            {
                std::vector<Point2d>& pixels = (glass ? view.glass : view.direct)[camera];
                const Ptr<RefractiveCamera> in = c.fit.rig.cameras[camera];
                const Ptr<RefractiveCamera> by = glass ? in : copyWithWindow(in, GlassWindow());
                Vec3d rvec, tvec;
                poseInCamera(c.fit, k, camera, rvec, tvec);
                std::vector<Point2d> before, after;
                refractiveProjectPoints(view.objectPoints, rvec, tvec, by, before);
                refractiveProjectPoints(deformed, rvec, tvec, by, after);
                for (size_t i = 0; i < pixels.size(); i++)
                    pixels[i] += after[i] - before[i];
            }
    }
    return data;
}

//! The observations as they would be through a wedge.
RigData bentData(const RigCalibration& c, const Cause& cause, const Vec3d& tilt)
{
    if (cause.nudge)
        return nudgedData(c, tilt);
    if (cause.deform)
        return deformedData(c, cause);
    RigData data = c.data;
    for (size_t k = 0; k < c.fit.views.size(); k++)
    {
        const RigidTransform cam1_from_board = transformOf(c.fit.rvecs[k], c.fit.tvecs[k]);
        std::vector<Point3d> points;
        for (const Point3d& X : data.views[c.fit.views[k]].objectPoints)
            points.push_back(Point3d(cam1_from_board*Vec3d(X)));
        for (int camera = 0; camera < data.cameraCount; camera++)
            Volume::bend(c.fit.rig, cause, camera, points, tilt, data.views[c.fit.views[k]].glass[camera]);
    }
    return data;
}

RigModel refit(const RigCalibration& c, const Cause& cause, const Vec3d& tilt)
{
    RigModel start = c.fit.rig.clone();
    for (int k = 0; k < c.data.cameraCount; k++)
        if (cause.spoil && cause.concerns(start, k))
        {
            GlassWindow window = start.cameras[k]->window();
            cause.spoil(window);
            start.cameras[k]->setWindow(window);
        }
    return fitImages(bentData(c, cause, tilt), start, c.fit.views, c.options.flags).rig;
}

double rmsOfAll(const std::vector<double>& values)
{
    double sum = 0.;
    for (double v : values)
        sum += v*v;
    return values.empty() ? NONE : std::sqrt(sum/values.size());
}

//! The worst direction of the tilts: each point moves by a linear map of the tilt.
Tolerance summarise(const Cause& cause, const Volume& volume, const std::vector<std::vector<Vec3d>>& fields)
{
    Tolerance result;
    result.what = cause.name;
    result.done = true;
    std::vector<double> lengths, moves;
    for (size_t i = 0; i < fields[0].size(); i++)
    {
        Eigen::MatrixXd map(3, fields.size());
        for (size_t f = 0; f < fields.size(); f++)
            map.col(f) << fields[f][i][0], fields[f][i][1], fields[f][i][2];
        if (map.allFinite())
            moves.push_back(SingularValues(map).values[0]);
    }
    for (const std::vector<Vec3d>& field : fields)
        lengths.push_back(rmsOfAll(volume.stretches(field)));
    result.rms = rmsOfAll(moves);
    result.worst = moves.empty() ? NONE : *std::max_element(moves.begin(), moves.end());
    result.lengths = *std::max_element(lengths.begin(), lengths.end());
    return result;
}

//! The middle of a board rises, its farthest points stay.
void bow(std::vector<Point3d>& board, double height)
{
    Point3d middle;
    for (const Point3d& X : board)
        middle += X*(1./board.size());
    double farthest = 0.;
    for (const Point3d& X : board)
        farthest = std::max(farthest, norm(X - middle));
    for (Point3d& X : board)
        X.z += height*(1. - std::pow(norm(X - middle)/farthest, 2));
}

//! What no image shows of the target itself, which is calibrated with as given.
std::vector<Cause> causesOfTarget(bool isBoard, double scaleStd, double millimetre)
{
    const auto scale = [](std::vector<Point3d>& board) {
        for (Point3d& X : board)
            X *= 1. + SQUARE;
    };
    const auto bend = [=](std::vector<Point3d>& board) { bow(board, BOW_MM*millimetre); };
    std::vector<Cause> causes;
    if (scaleStd == 0.)
        causes.push_back({isBoard ? "square wrong by 0.1 %" : "coordinates wrong by 0.1 %", 0, false, nullptr, {Vec3d()}, false, scale});
    if (isBoard)
        causes.push_back({"board bent by 0.1 mm", 0, false, nullptr, {Vec3d()}, false, bend});
    return causes;
}

//! ", camera 2", or all that look through it; nothing for a single camera.
std::string whoseWindow(const RigModel& rig, int camera)
{
    std::string list;
    int count = 0;
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        if (rig.sharesWindow(camera, c))
            list += (count++ ? ", " : "") + std::to_string(c + 1);
    if (rig.cameras.size() == 1)
        return "";
    if (count == (int)rig.cameras.size())
        return count == 2 ? ", both cameras" : ", all cameras";
    return (count == 1 ? ", camera " : ", cameras ") + list;
}

double deviationOf(const GivenIndex& given)
{
    return given.isNamed() ? given.deviation : INDEX;
}

std::string wrongIndexBy(const GivenIndex& given)
{
    return format(" wrong by %.2g", deviationOf(given)) + (given.isNamed() ? " (" + given.light() + ")" : "");
}

std::vector<Cause> causesOf(const RigCalibration& c, double millimetre)
{
    std::vector<Cause> causes;
    for (int k = 0; k < c.data.cameraCount; k++)
    {
        const GlassWindow window = c.fit.rig.cameras[k]->window();
        if (window.thickness.empty() || !c.fit.rig.ownsWindow(k))
            continue;
        const std::string whose = whoseWindow(c.fit.rig, k);
        const size_t layer = std::max_element(window.thickness.begin(), window.thickness.end()) - window.thickness.begin();
        const std::string which = window.thickness.size() == 1 ? "" : format(" of layer %zu", layer + 1);
        if (!(c.options.flags & GLASS_FREE_THICKNESS) && c.options.std.thickness == 0.)
            causes.push_back({"thickness" + which + " wrong by 0.1 mm" + whose, k, true, [=](GlassWindow& w) {
                w.thickness[layer] += THICKNESS_MM*millimetre;
            }, {Vec3d()}});
        if (!(c.options.flags & GLASS_FREE_INDEX) && c.options.std.indexOf(layer) == 0.)
        {
            const GivenIndex given = layer < c.options.layers.size() ? c.options.layers[layer] : GivenIndex();
            causes.push_back({"index" + which + wrongIndexBy(given) + whose, k, true, [=](GlassWindow& w) {
                w.index[layer] += deviationOf(given);
            }, {Vec3d()}});
        }
        if (isRound(window) && !(c.options.flags & GLASS_FREE_RADIUS) && c.options.std.radius == 0.)
            causes.push_back({"radius wrong by 0.1 mm" + whose, k, true, [=](GlassWindow& w) {
                w.radius += RADIUS_MM*millimetre;
            }, {Vec3d()}});
        if (!window.wedge.empty() || window.shape != WINDOW_FLAT)
            continue;
        const Vec3d across = normalize(window.normal.cross(Vec3d(0, 1, 0)));
        causes.push_back({"wedge of 1 arc minute between the faces" + whose, k, true, nullptr,
                          {ARC_MINUTE*across, ARC_MINUTE*window.normal.cross(across)}});
    }
    if (c.data.countPairs() && c.options.std.placement == 0.)
    {
        const double shift = NUDGE_MM*millimetre;
        causes.push_back({"boards moved by 0.1 mm between direct and glass", 0, false, nullptr,
                          {Vec3d(shift, 0, 0), Vec3d(0, shift, 0), Vec3d(0, 0, shift)}, true});
    }
    const GlassWindow first = c.fit.rig.cameras[0]->window();
    if (first.innerIndex != first.outerIndex && !(c.options.flags & GLASS_FREE_OUTER_INDEX) &&
        c.options.std.outerIndex == 0.)
        causes.push_back({"index of the scene's medium" + wrongIndexBy(c.options.outer), 0, false, [&](GlassWindow& w) {
            w.outerIndex += deviationOf(c.options.outer);
        }, {Vec3d()}});
    for (const Cause& cause : causesOfTarget(c.square > 0, c.options.std.scale, millimetre))
        causes.push_back(cause);
    return causes;
}

} // namespace

std::vector<Tolerance> analyseTolerances(const RigCalibration& c, double millimetre, bool quiet)
{
    const Volume volume(c);
    const std::vector<Cause> causes = causesOf(c, millimetre);
    Progress progress("trying wrong values", (int)causes.size(), quiet);
    std::vector<Tolerance> result;
    for (const Cause& cause : causes)
    {
        try
        {
            std::vector<std::vector<Vec3d>> fields;
            for (const Vec3d& tilt : cause.tilts)
                fields.push_back(volume.displacements(c.fit.rig, refit(c, cause, tilt), cause, tilt));
            result.push_back(summarise(cause, volume, fields));
        }
        catch (const cv::Exception&)
        {
            Tolerance failed;
            failed.what = cause.name;
            result.push_back(failed);
        }
        progress.step();
    }
    return result;
}

} // namespace tools
