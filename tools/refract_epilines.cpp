// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/measured_causes.hpp"
#include "measure/consistency.hpp"
#include "calibrate/rig_model.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"
#include "console/images.hpp"
#include "console/csv.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "report/drawing.hpp"
#include "target/target_search.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

static const char MANUAL[] = R"(Draws where the partners of image points can lie in the other raw image.

  refract_epilines calib.yml IMAGE1 IMAGE2 --size=6x5 --square=39 --out=picture.png    corners of a target
  refract_epilines calib.yml IMAGE1 IMAGE2 --points=FILE --out=picture.png             your points: 'u v' a line

Left the points in image 1, right their curves in image 2 (solid), each in its colour, and where the curve would run if
the windows were ignored (dashed). With a target, its points in image 2 are marked too, and the table says how far they
lie from their curves: next to 0 if the calibration is right.

Exit code: 0 done, 1 could not do it, 2 the picture is written, but most points of the target contradict the calibration.)";

namespace {

using namespace tools;
using cv::Point2d;

struct Options
{
    std::string calibration, image1, image2, points, depth, out;
    TargetOptions target;
    bool noWindow = false;
};

double distanceTo(const Curve& curve, const Point2d& p)
{
    double smallest = std::numeric_limits<double>::infinity();
    for (size_t i = 1; i < curve.size(); i++)
    {
        const Point2d side = curve[i] - curve[i - 1];
        const double at = std::min(1., std::max(0., (p - curve[i - 1]).dot(side)/side.dot(side)));
        smallest = std::min(smallest, cv::norm(p - curve[i - 1] - at*side));
    }
    return smallest;
}

void addRow(Table& table, const std::string& name, const std::vector<Curve>& curves, const std::vector<Point2d>& partners)
{
    double squares = 0, largest = 0;
    int count = 0;
    for (size_t i = 0; i < partners.size(); i++)
    {
        const double distance = distanceTo(curves[i], partners[i]);
        if (!std::isfinite(distance))
            continue;
        squares += distance*distance;
        largest = std::max(largest, distance);
        count++;
    }
    table.add({name, std::to_string(count), format("%.3f", std::sqrt(squares/count)), format("%.3f", largest)});
}

//! Around a target as far before and behind it as keeps the curves of its points apart; else all that both can see.
cv::Vec2d usualDepthRange(const Calibration& rig, const std::vector<Point2d>& points, const std::vector<Point2d>& partners)
{
    double near = std::numeric_limits<double>::infinity(), far = 0;
    if (!partners.empty())
        for (const cv::Point3d& p : measureRig(rig, {points, partners}, 0.).points)
            if (p.z > 0)
            {
                near = std::min(near, p.z);
                far = std::max(far, p.z);
            }
    if (far > 0)
        return cv::Vec2d(0.92*near, 1.08*far);
    return cv::Vec2d(cv::norm(rig.extrinsics[1].t), std::numeric_limits<double>::infinity());
}

cv::Mat readRaw(const std::string& path, const Calibration& rig, int camera)
{
    const cv::Mat image = readGrey(path, rig.channel);
    requireSize(image, path, rig.cameras[camera].camera->imageSize());
    return image;
}

std::vector<Point2d> requireIn(const cv::Mat& image, const std::string& path, const Target& target)
{
    cv::Size other;
    const std::vector<Point2d> points = detectIn(image, path, target, &other);
    if (!other.empty())
        throw Failure(otherTargetText("'" + path + "'", target, other));
    if (points.empty())
        throw Failure("the target was not found in '" + path + "': check --pattern and --size, or give --points=FILE");
    return points;
}

//! Empty, or what is wrong if most of the target's points in both images contradict the calibration.
std::string contradictionOf(const Calibration& rig, const Target& target, const std::vector<Point2d>& points,
                            const std::vector<Point2d>& partners)
{
    const double sigma = pixelSigmaOf(rig);
    Measurement measured = measureRig(rig, {points, partners}, sigma);
    checkConsistency(rig, sigma, measured);
    if (2*measured.contradicting() <= measured.seenPoints())
        return "";
    View view;
    view.objectPoints = target.objectPoints();
    view.neighbours = target.neighbours();
    view.glass[0] = points;
    view.glass[1] = partners;
    const std::string cause = causesOf(rig, {view}, sigma);
    return format("%d of %d points are off their curves by more than noise and calibration explain: ", measured.contradicting(),
                  measured.seenPoints())
        + (cause.empty() ? "are the images of one moment, of this rig, and in its cameras' order?" : "what explains them: " + cause);
}

//! A typing error in a file of points makes a curve that is nowhere.
void warnOfPointsOutside(const std::vector<Point2d>& points, const cv::Mat& image, const Options& options, const Command& command)
{
    const cv::Rect2d area(-0.5, -0.5, image.cols, image.rows);
    std::vector<std::string> outside;
    for (size_t i = 0; i < points.size(); i++)
        if (!area.contains(points[i]))
            outside.push_back(format("%zu (%g %g)", i + 1, points[i].x, points[i].y));
    if (!outside.empty())
        command.warn(format("'%s': %zu of %zu points are outside '%s', which is %s: ", options.points.c_str(), outside.size(),
                            points.size(), options.image1.c_str(), sizeText(image.size()).c_str()) + listed(outside));
}

void addOptions(OptionParser& parser, Options& options)
{
    parser.add("calib.yml", options.calibration, "of a stereo pair, what refract_calib wrote").required();
    parser.add("IMAGE1", options.image1, "of camera 1").required();
    parser.add("IMAGE2", options.image2, "of camera 2, of the same moment").required();
    parser.add("--points", options.points, "file with points of image 1");
    options.target.addTo(parser, false);
    parser.add("--depth", options.depth, "near,far: z of the scene in the frame of camera 1; far may be inf (default: "
               "around the target; with --points from the distance of the cameras to inf)");
    parser.add("--out", options.out, "picture to write").required();
    parser.addFlag("--no-window", options.noWindow, "calib.yml has no glass_window, and there is none");
}

} // namespace

int refract_epilines_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        const Options options = parsed(command, addOptions);
        if (options.points.empty() == !options.target.given())
            throw Failure("give either --points=FILE or a target (--size, --square)");

        Calibration rig = readCalibration(options.calibration, options.noWindow, command);
        checkOutputs({{"--out", options.out, OUTPUT_PICTURE}},
                     {options.calibration, options.image1, options.image2, options.points, command.settings()});
        if (rig.single())
            throw Failure("'" + options.calibration + "' has one camera; epipolar curves need a calibrated pair "
                          "(refract_calib --direct2 --glass2)");
        rig = firstTwoCameras(rig);
        const cv::Mat image1 = readRaw(options.image1, rig, 0);
        const cv::Mat image2 = readRaw(options.image2, rig, 1);
        std::vector<Point2d> points, partners;
        std::string contradiction;
        if (options.target.given())
        {
            const Target target(options.target);
            points = requireIn(image1, options.image1, target);
            partners = target.alignWith(points, requireIn(image2, options.image2, target));
            contradiction = contradictionOf(rig, target, points, partners);
        }
        else
        {
            points = readPixels(options.points);
            warnOfPointsOutside(points, image1, options, command);
        }

        const cv::Vec2d depth = options.depth.empty() ? usualDepthRange(rig, points, partners)
                                                      : parseDepthRange(options.depth, "--depth");
        const std::vector<Curve> curves = curvesOf(rig, points, depth);
        const std::vector<Curve> ignored = curvesOf(withoutWindows(rig), points, depth);
        writeImage(options.out, epipolarPicture(image1, image2, points, partners, curves, ignored));
        if (!command.quiet() && !partners.empty())
        {
            Table table({"distance of the partners from their curves, px", "points", "RMS", "largest"});
            addRow(table, "windows ignored", ignored, partners);
            addRow(table, "through the windows", curves, partners);
            table.print(std::cout);
        }
        if (!contradiction.empty())
            command.warn(contradiction);
        return contradiction.empty() ? DONE : LIMIT_NOT_MET;
    });
}
