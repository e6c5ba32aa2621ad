// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/starting_model.hpp"
#include "calibrate/given_window.hpp"
#include "calibrate/pinhole_camera.hpp"
#include "calibrate/priors.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! A lens with as many coefficients as another has, the rest of its own being 0.
Ptr<RefractiveCamera> withCoefficientsOf(const Ptr<RefractiveCamera>& lens, const Ptr<RefractiveCamera>& other)
{
    const Ptr<RefractiveCamera> result = other->clone();
    const Mat parameters = lens->lensParameters();
    result->setLensParameters(parameters.rowRange(0, result->lensParameters().rows));
    return result;
}

Ptr<RefractiveCamera> startLens(const RigData& data, const RigOptions& options, int camera, LensSource& source)
{
    if (options.known[camera])
        return options.known[camera];
    const std::string suffix = cameraSuffix(camera);
    std::vector<TargetView> views = targetViewsOf(data, camera, false);
    source.kind = LensSource::FROM_DIRECT;
    if (views.empty())
    {
        if (!(options.flags & GLASS_FREE_INTRINSICS))
            throw Failure("there are no images for the lens: give --direct" + suffix + " images or --camera" + suffix
                          + ", or --free=intrinsics to find the lens through the window");
        views = targetViewsOf(data, camera, true);    // a pinhole through the glass is a good start
        source.kind = LensSource::FROM_GLASS;
    }
    source.views = (int)views.size();
    if (!determineLens(views))
        throw Failure(format("camera %d: %d image(s) to calibrate the lens from are too few: give at least 3 (better 10 or "
                             "more, tilted to all sides), or --camera%s", camera + 1, source.views, suffix.c_str()));
    const Ptr<RefractiveCamera> pinhole = calibratePinhole(views, data.imageSize[camera], options.carriedCoefficients(camera),
                                                           options.flags, source.rms);
    return source.kind == LensSource::FROM_GLASS && !options.lensThroughWindow.empty()
        ? withCoefficientsOf(options.lensThroughWindow[camera], pinhole) : pinhole;
}

//! A lens with many coefficients, overfitted, may fold the image over itself; then nothing else can work.
void checkLens(const RigData& data, const Ptr<RefractiveCamera>& lens, int camera, const LensSource& source)
{
    int outside = 0;
    for (bool glass : {false, true})
        for (const TargetView& view : targetViewsOf(data, camera, glass))
        {
            Mat origins, directions;
            std::vector<uchar> status;
            refractiveUnprojectPoints(view.pixels, origins, directions, lens, status);
            outside += (int)std::count(status.begin(), status.end(), (uchar)REFRACT_OUTSIDE_LENS_MODEL);
        }
    if (outside)
        throw Failure(format("camera %d: %d corners lie where the lens model is not one-to-one: ", camera + 1, outside)
                      + (source.kind == LensSource::FROM_FILE ? "--camera does not belong to these images"
                         : "these images do not determine that many coefficients; choose a smaller --lens (opencv5, opencv4) "
                           "or show the target in the image's corners too"));
}

struct BoardInBoth
{
    const std::vector<Point3d>* object;
    RigidTransform cam1_from_object, cam2_from_object;
};

double relativePoseError(const std::vector<BoardInBoth>& boards, const RigidTransform& cam2_from_cam1)
{
    // The median over the boards, as single-view poses of a flat board may be mirrored.
    std::vector<double> errors;
    for (const BoardInBoth& b : boards)
    {
        double sum = 0.;
        for (const Point3d& X : *b.object)
        {
            const Vec3d there = cam2_from_cam1.apply(b.cam1_from_object.apply(Vec3d(X))), here = b.cam2_from_object.apply(Vec3d(X));
            sum += norm(there - here, NORM_L2SQR)/here.dot(here);
        }
        errors.push_back(sum);
    }
    return median(errors);
}

//! Camera 1 -> camera 2: of the boards, the one that fits the others best.
RigidTransform placeByBest(const std::vector<BoardInBoth>& boards)
{
    RigidTransform best;
    double least = std::numeric_limits<double>::infinity();
    for (const BoardInBoth& b : boards)
    {
        const RigidTransform cam2_from_cam1 = fromTo(b.cam1_from_object, b.cam2_from_object);
        const double error = relativePoseError(boards, cam2_from_cam1);
        if (error < least)
        {
            least = error;
            best = cam2_from_cam1;
        }
    }
    return best;
}

//! Without the windows, for direct images.
RigModel bareOf(const RigModel& rig)
{
    RigModel bare = rig;
    for (Ptr<RefractiveCamera>& camera : bare.cameras)
        camera = copyWithWindow(camera, GlassWindow());
    return bare;
}

//! Boards seen by both cameras, in one state.
std::vector<BoardInBoth> boardsInBoth(const RigData& data, const RigModel& rig, int camera1, int camera2, bool glass)
{
    std::vector<BoardInBoth> boards;
    for (const View& view : data.views)
    {
        const PerCamera<std::vector<Point2d>>& images = glass ? view.glass : view.direct;
        BoardInBoth b;
        b.object = &view.objectPoints;
        if (solveView(view, rig.cameras[camera1], images[camera1], b.cam1_from_object) &&
            solveView(view, rig.cameras[camera2], images[camera2], b.cam2_from_object))
            boards.push_back(b);
    }
    return boards;
}

//! The same where the boards' poses to camera 1 are known.
std::vector<BoardInBoth> boardsAtKnownPoses(const RigData& data, const RigModel& rig, int camera, bool glass)
{
    std::vector<BoardInBoth> boards;
    for (const View& view : data.views)
    {
        BoardInBoth b;
        b.object = &view.objectPoints;
        b.cam1_from_object = transformOf(view.pose->rvec, view.pose->tvec);
        if (solveView(view, rig.cameras[camera], (glass ? view.glass : view.direct)[camera], b.cam2_from_object))
            boards.push_back(b);
    }
    return boards;
}

//! Where each camera is, from single boards (direct images first, any lens).
void startExtrinsics(const RigData& data, bool posesKnown, RigModel& rig)
{
    const RigModel bare = bareOf(rig);
    std::vector<std::pair<int, int>> links;
    for (int c = 1; posesKnown && c < data.cameraCount; c++)
        links.push_back({0, c});
    if (!posesKnown)
        links = cameraLinks(data, false);
    for (const auto& link : links)
    {
        std::vector<BoardInBoth> boards;
        for (bool glass : {false, true})
            if (boards.empty())
            {
                const RigModel& seenBy = glass ? rig : bare;
                boards = posesKnown ? boardsAtKnownPoses(data, seenBy, link.second, glass)
                                    : boardsInBoth(data, seenBy, link.first, link.second, glass);
            }
        if (boards.empty())
            throw Failure(format("no view of the target gives camera %d a pose: check the points, --size and --square",
                                 link.second + 1));
        rig.extrinsics[link.second] = placeByBest(boards)*rig.extrinsics[link.first];
    }
}

} // namespace

bool solveView(const View& view, const Ptr<RefractiveCamera>& camera, const std::vector<Point2d>& pixels, RigidTransform& pose)
{
    if (pixels.empty())
        return false;
    Vec3d rvec, tvec;
    if (!refractiveSolvePnP(view.objectPoints, pixels, camera, rvec, tvec))
        return false;
    pose = transformOf(rvec, tvec);
    return true;
}

int RigOptions::carriedCoefficients(int camera) const
{
    const bool isOpen = lensCoefficients != FISHEYE_LENS && !leftOut.empty() && !leftOut[camera].empty();
    return isOpen ? leftOut[camera].rows - INTRINSICS : lensCoefficients;
}

GlassWindow RigOptions::windowOf(int camera) const
{
    GlassWindow own = window;
    if (!places.empty())
        placeOf(camera).putInto(own);
    return own;
}

bool RigOptions::hasMaterials() const
{
    return GivenWindow{window, layers, inner, outer}.hasMaterials();
}

double startDistance(const RigData& data, double square)
{
    if (square > 0)
        return square;
    const double SHARE = 0.1;           // of the target
    double width = 0.;
    for (const View& view : data.views)
        for (const Point3d& X : view.objectPoints)
            width = std::max(width, norm(X - view.objectPoints[0]));
    return SHARE*width;
}

//! The initial values, with the cameras and the windows at the places where a fit has them.
static RigModel placedAs(const RigModel& start, const RigModel& found)
{
    RigModel rig = start.clone();
    rig.extrinsics = found.extrinsics;
    for (size_t c = 0; c < rig.cameras.size(); c++)
    {
        GlassWindow window = rig.cameras[c]->window();
        const GlassWindow there = found.cameras[c]->window();
        window.normal = there.normal;
        window.distance = there.distance;
        window.center = there.center;
        window.axis = there.axis;
        rig.cameras[c]->setWindow(window);
    }
    return rig;
}

RigModel startModel(const RigData& data, const RigOptions& given, std::vector<LensSource>& lensSources, const RigModel* found)
{
    RigOptions options = given;
    RigModel rig;
    lensSources.assign(data.cameraCount, LensSource());
    for (int c = 0; c < data.cameraCount; c++)
    {
        Ptr<RefractiveCamera> lens = startLens(data, options, c, lensSources[c]);
        const Size known = lens->imageSize();
        if (!known.empty() && known != data.imageSize[c])
            throw Failure(format("--camera%s was calibrated on %dx%d images, but the images here are %dx%d", cameraSuffix(c).c_str(),
                                 known.width, known.height, data.imageSize[c].width, data.imageSize[c].height));
        checkLens(data, copyWithWindow(lens, GlassWindow()), c, lensSources[c]);
        rig.add(copyWithWindow(lens, options.windowOf(c)));
        rig.cameras.back()->setImageSize(data.imageSize[c]);
    }
    rig.windows = options.windows;
    if (!found)
        startExtrinsics(data, options.flags & GLASS_USE_POSES, rig);
    if (options.std.isDistanceOpen)
    {
        options = withOpenDistance(data, rig, options);
        for (int c = 0; c < data.cameraCount; c++)
            rig.cameras[c] = copyWithWindow(rig.cameras[c], options.windowOf(c));
    }
    for (int c = 0; c < data.cameraCount; c++)
        rig.known.push_back(knownOf(*rig.cameras[c], options, c));
    rig.targetCovariance = targetCovarianceOf(data, rig, options.std);
    return found ? placedAs(rig, *found) : rig;
}

} // namespace tools
