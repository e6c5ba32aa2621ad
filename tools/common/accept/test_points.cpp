// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/test_points.hpp"
#include "calibrate/provenance.hpp"
#include "console/csv.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "measure/consistency.hpp"
#include "measure/measured_views.hpp"
#include "measure/measurement.hpp"
#include "measure/measured_doubts.hpp"
#include <algorithm>
#include <limits>
#include <set>

namespace tools {

namespace {

//! The points that count, measured by this calibration.
Measurement measurementOf(const TestPoints& points, const Calibration& calibration)
{
    RigPixels pixels(calibration.cameras.size());
    for (const TestPoint& point : points.points)
        for (size_t c = 0; c < pixels.size() && point.status == 0; c++)
            pixels[c].push_back(point.pixels[c]);
    return measureRig(calibration, pixels, pixelSigmaOf(calibration));
}

//! Stated, and nothing of these points refutes it.
std::vector<std::string> remarksOfStated(const TestPoints& points, double stated, double calibrated, double shown)
{
    const std::string given = format("--pixel-sigma=%.3g", stated);
    if (!points.havePixels && points.haveSigma)
        return {given + " is not used: the points have no pixels, and sx, sy, sz say their noise"};
    if (!(stated < calibrated))
        return {};
    const std::string less = given + format(" is less than the %.2g px of the calibration's residuals", calibrated);
    return {shown > 0. ? less + format("; the points' own rays miss each other by as much as %.2g px make", shown)
                       : less + ", and nothing in these points supports it"};
}

void add(const View& view, const Measurement& m, TestPoints& points)
{
    for (size_t i = 0; i < m.points.size(); i++)
    {
        TestPoint point{view.stem, std::to_string(i), m.points[i], {}, m.sigma[i], m.status[i]};
        for (const std::vector<cv::Point2d>& pixels : m.pixels)
            point.pixels.push_back(pixels[i]);
        points.points.push_back(point);
    }
}

} // namespace

PixelNoise pixelNoiseOf(const Calibration& calibration, const TestPoints& points, double stated)
{
    const double calibrated = pixelSigmaOf(calibration);
    if (!points.havePixels || calibration.single())
    {
        const double none = std::numeric_limits<double>::quiet_NaN();
        return stated > 0 ? PixelNoise{stated, remarksOfStated(points, stated, calibrated, none)} : PixelNoise{calibrated, {}};
    }
    const ShownNoise shown(calibration, measurementOf(points, calibration));
    if (stated > 0 && shown.refutes(stated))
        throw Failure(format("--pixel-sigma=%.3g: the pixels of '", stated) + points.source
                      + format("' have a noise of %.2g px, as the rays of a point miss each other by that much; leave it out, or give what "
                               "is so", shown.sigma()));
    if (stated > 0)
        return {stated, remarksOfStated(points, stated, calibrated, shown.sigma())};
    if (!(calibrated > 0) || !shown.isMoreThan(calibrated))
        return {calibrated, {}};
    return {shown.sigma(), {format("The pixels of these points are noisier than those of the calibration, %.2g px in place of %.2g px: U "
                                   "has the larger one", shown.sigma(), calibrated)}};
}

BoardPoints measureBoards(const Calibration& calibration, const std::vector<std::string>& images, const Target& target, double pixelSigma,
                          bool quiet)
{
    MeasuredFiles files;
    files.images = images;
    const RigImages sets = readGlassImages(files, true, calibration, &target, quiet);
    BoardPoints result;
    result.points.source = images[0];
    result.points.havePixels = result.points.haveSigma = true;
    for (const DetectedImages& set : sets.glass)
        result.files.insert(result.files.end(), set.files.begin(), set.files.end());
    for (const View& view : groupIntoViews(&target, sets, false, 1).views)
    {
        if (view.countGlass() < 2)
            continue;
        Measurement m = measureRig(calibration, glassPixels(view, (int)calibration.cameras.size()), pixelSigma);
        forgetOutside(calibration, m);
        checkConsistency(calibration, pixelSigma, m);
        add(view, m, result.points);
    }
    if (result.points.points.empty())
        throw Failure("no two cameras have images of one name with the target: images of one moment need equal names");
    return result;
}

static const double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> TestPoints::images() const
{
    std::vector<std::string> names;
    std::set<std::string> there;
    for (const TestPoint& point : points)
        if (there.insert(point.image).second)
            names.push_back(point.image);
    return names;
}

RigPixels TestPoints::pixelsOf(const std::string& image, size_t cameras) const
{
    RigPixels pixels(cameras);
    for (const TestPoint& point : points)
        for (size_t c = 0; c < cameras && point.image == image; c++)
            pixels[c].push_back(point.pixels[c]);
    return pixels;
}

TestPoints readTestPoints(const std::string& path, size_t cameras)
{
    const CsvTable table(path, {"id", "x", "y", "z"}, "a file of measured points");
    TestPoints result;
    result.source = path;
    result.havePixels = table.find("u1") >= 0 && table.find("v1") >= 0;
    result.haveSigma = table.find("sx") >= 0 && table.find("sy") >= 0 && table.find("sz") >= 0;
    const bool hasImage = table.find("image") >= 0, hasStatus = table.find("status") >= 0;
    if (table.find(format("u%zu", cameras + 1)) >= 0 && cameras >= 2)
        throw Failure(format("'%s' has pixels of camera %zu, the calibration has %zu cameras: are they of one rig?", path.c_str(),
                             cameras + 1, cameras));
    std::set<std::pair<std::string, std::string>> names;
    for (const CsvTable::Row& row : table.rows())
    {
        const auto number = [&](const std::string& name) { return table.numberOrNone(row, name); };
        TestPoint point;
        point.image = hasImage ? table.textOrNone(row, "image") : "";
        point.id = table.text(row, "id");
        point.X = {number("x"), number("y"), number("z")};
        for (size_t c = 0; c < cameras; c++)
        {
            const std::string u = format("u%zu", c + 1), v = format("v%zu", c + 1);
            const bool there = table.find(u) >= 0 && table.find(v) >= 0;
            point.pixels.push_back(there ? table.pixelOrNone(row, u, v) : cv::Point2d(NOT_KNOWN, NOT_KNOWN));
        }
        point.sigma = result.haveSigma ? cv::Vec3d(number("sx"), number("sy"), number("sz")) : cv::Vec3d::all(NOT_KNOWN);
        for (int i = 0; i < 3; i++)
            if (point.sigma[i] < 0)
                throw Failure(table.where(row) + ": sx, sy and sz are standard deviations, not below 0");
        point.status = hasStatus ? (int)table.number(row, "status") : 0;
        if (!names.emplace(point.image, point.id).second)
            throw Failure(table.where(row) + ": the id '" + point.id + "'" + (hasImage ? " of the image '" + point.image + "'" : "")
                          + " stands twice: give each point a name of its own");
        result.points.push_back(point);
    }
    return result;
}

std::vector<std::string> namesThatCalibrated(const std::vector<std::string>& images, const Calibration& calibration)
{
    std::vector<std::string> names;
    for (const std::string& image : images)
        if (std::any_of(calibration.provenance.images.begin(), calibration.provenance.images.end(),
                        [&](const CalibrationImage& used) { return !image.empty() && used.name == image; }))
            names.push_back(image);
    return names;
}

/** Where an image shows its points: in the pixels that stand beside them, or, of points without, where the calibration has them. Those
of an image that calibrated come out where they went in, but for what their rays missed each other by. */
static RigPixels shownBy(const TestPoints& points, const std::string& image, const Calibration& calibration)
{
    RigPixels pixels = points.pixelsOf(image, calibration.cameras.size());
    std::vector<cv::Point3d> there;
    for (const TestPoint& point : points.points)
        if (point.image == image)
            there.push_back(point.X);
    for (size_t c = 0; c < pixels.size() && !points.havePixels; c++)
        cv::refract::refractiveProjectPoints(there, rotationVector(calibration.extrinsics[c].R), calibration.extrinsics[c].t,
                                             calibration.cameras[c].camera, pixels[c]);
    return pixels;
}

bool requireOtherImages(const TestPoints& points, const std::vector<std::string>& images, const Calibration& calibration)
{
    const std::vector<CalibrationImage>& calibrating = calibration.provenance.images;
    if (calibrating.empty())
        return false;
    const double tolerance = sameImageTolerance(pixelSigmaOf(calibration));
    std::vector<std::string> used;
    std::vector<CalibrationImage> shown;
    for (const std::string& image : images)
    {
        const RigPixels pixels = shownBy(points, image, calibration);
        bool calibrated = false;
        for (size_t c = 0; c < pixels.size(); c++)
        {
            shown.push_back({image, (int)c, "", meanOfSeen(pixels[c]), pixels[c]});
            calibrated = calibrated || findImage(calibrating, (int)c, pixels[c], tolerance);
        }
        if (calibrated)
            used.push_back(image);
    }
    if (used.empty())
        used = movedAlike(calibrating, shown, tolerance);
    if (!used.empty())
        throw Failure("these images calibrated, stored anew or cropped perhaps, or their targets were not moved since, so that they prove "
                      "nothing: " + listed(used) + ". Take others, with the length standard where nothing was calibrated");
    return points.havePixels;
}

} // namespace tools
