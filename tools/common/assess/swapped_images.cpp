// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/change_naming.hpp"
#include "calibrate/units.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "diagnose/calibration_input.hpp"
#include <algorithm>
#include <cmath>
#include <functional>

using namespace cv;

namespace tools {

namespace {

using Pixels = std::vector<Point2d>;

const char* const STATES[] = {"direct images", "images through the window", "images"};      // of ImageState

//! What happened to an image, and how the numbers of a symmetrical board may have followed it.
struct Transform
{
    const char* what;
    ImageTurn turn;
    std::vector<ImageTurn> renumberings;
};

const Transform TRANSFORMS[] = {
    {"turned by 180 degrees", {true, true, false}, {{false, false, false}, {true, true, false}}},
    {"mirrored (left and right exchanged)", {true, false, false}, {{false, false, false}, {true, false, false}, {false, true, false}}},
    {"mirrored (top and bottom exchanged)", {false, true, false}, {{false, false, false}, {true, false, false}, {false, true, false}}},
    {"turned by 90 degrees to the left", {false, true, true}, {{false, false, false}, {false, true, true}, {true, false, true}}},
    {"turned by 90 degrees to the right", {true, false, true}, {{false, false, false}, {false, true, true}, {true, false, true}}}};

Pixels undone(const Pixels& pixels, const ImageTurn& turn, const std::vector<int>& numbers, Size size)
{
    Pixels result(pixels.size());
    for (size_t i = 0; i < pixels.size(); i++)
        result[numbers[i]] = undone(turn, pixels[i], size);
    return result;
}

class SwappedImages
{
public:
    SwappedImages(const RigModel& rig, const std::vector<View>& views) : rig_(rig), views_(views), count_((int)rig.cameras.size())
    {
        addTransforms();
        addExchangedStates();
        addExchangedCameras();
    }
    std::vector<Undone> all;

private:
    void addTransforms()
    {
        for (int c = count_ > 1 ? -1 : 0; c < count_; c++)
            for (ImageState state : {ALL_IMAGES, DIRECT_IMAGES, GLASS_IMAGES})
            {
                const bool hasBoth = hasAny(c, DIRECT_IMAGES) && hasAny(c, GLASS_IMAGES);
                if (!hasAny(c, state) || (state != ALL_IMAGES && !hasBoth))
                    continue;
                for (const Transform& transform : TRANSFORMS)
                    for (const ImageTurn& renumbering : transform.renumberings)
                        addTransform(c, state, transform, renumbering);
            }
    }

    bool hasAny(int c, ImageState state) const
    {
        for (int k = 0; k < count_; k++)
            if ((c < 0 || c == k) && hasImages(views_, k, state))
                return true;
        return false;
    }

    void addTransform(int c, ImageState state, const Transform& transform, const ImageTurn& renumbering)
    {
        std::vector<View> views = views_;
        for (View& view : views)
        {
            const std::vector<int> numbers = renumbered(view.objectPoints, renumbering);
            if (numbers.size() != view.objectPoints.size())
                return;
            for (int k = 0; k < count_; k++)
            {
                const Size size = rig_.cameras[k]->imageSize();
                if (c >= 0 && c != k)
                    continue;
                if (size.empty() || (transform.turn.swap && size.width != size.height))
                    return;
                if (state != GLASS_IMAGES && view.hasDirect(k))
                    view.direct[k] = undone(view.direct[k], transform.turn, numbers, size);
                if (state != DIRECT_IMAGES && view.hasGlass(k))
                    view.glass[k] = undone(view.glass[k], transform.turn, numbers, size);
            }
        }
        all.push_back({STATES[state] + ofCamera(c, count_) + " " + transform.what, c, views});
    }

    void addExchangedStates()
    {
        for (int c = count_ > 1 ? -1 : 0; c < count_; c++)
        {
            if (!hasAny(c, DIRECT_IMAGES) || !hasAny(c, GLASS_IMAGES))
                continue;
            std::vector<View> views = views_;
            exchangeStates(views, c);
            all.push_back({"direct images and images through the window" + ofCamera(c, count_) + " exchanged", c, views});
        }
    }

    void addExchangedCameras()
    {
        for (int b = 1; b < count_; b++)
            for (int a = 0; a < b; a++)
                for (ImageState state : {ALL_IMAGES, DIRECT_IMAGES, GLASS_IMAGES})
                {
                    const bool hasBoth = (hasImages(views_, a, DIRECT_IMAGES) || hasImages(views_, b, DIRECT_IMAGES))
                                         && (hasImages(views_, a, GLASS_IMAGES) || hasImages(views_, b, GLASS_IMAGES));
                    if ((!hasImages(views_, a, state) && !hasImages(views_, b, state)) || (state != ALL_IMAGES && !hasBoth))
                        continue;
                    std::vector<View> views = views_;
                    exchangeCameras(views, a, b, state);
                    all.push_back({std::string(STATES[state]) + format(" of cameras %d and %d exchanged", a + 1, b + 1), -1, views});
                }
    }

    const RigModel& rig_;
    const std::vector<View>& views_;
    const int count_;
};

//! Each view in parts that have a pose of their own. @param partOf by camera, and whether through the window
Undone split(const std::vector<View>& views, const std::string& name, const std::function<int(int, bool)>& partOf, int parts)
{
    Undone result{name, -1, {}};
    for (const View& view : views)
        for (int part = 0; part < parts; part++)
            addPart(view, [&](int camera, bool glass) { return partOf(camera, glass) == part; }, result.views);
    result.poses = (int)(result.views.size() - views.size());
    return result;
}

std::vector<ViewObservations> withoutWindows(std::vector<ViewObservations> views, const std::vector<int>& cameras)
{
    for (ViewObservations& view : views)
        for (ImageOfView& image : view.images)
            image.glass = image.glass && std::count(cameras.begin(), cameras.end(), image.camera) == 0;
    return views;
}

//! Points as all cameras that look through windows see them over how they are given, the middling distance of two; NaN: no two do.
double measuredSize(const RigModel& rig, const std::vector<View>& views)
{
    std::vector<double> ratios;
    for (const View& view : views)
    {
        std::vector<Pixels> pixels(view.glass.begin(), view.glass.begin() + (int)rig.cameras.size());
        for (Pixels& ofCamera : pixels)
            ofCamera.resize(view.objectPoints.size(), Point2d(NAN, NAN));
        const std::vector<Point3d> points = view.countGlass() > 1 ? triangulate(rig, pixels) : std::vector<Point3d>();
        for (size_t i = 1; i < points.size(); i++)
        {
            const double ratio = norm(points[i] - points[i - 1])/norm(view.objectPoints[i] - view.objectPoints[i - 1]);
            if (std::isfinite(ratio))
                ratios.push_back(ratio);
        }
    }
    return ratios.empty() ? NAN : median(ratios);
}

} // namespace

std::vector<Undone> imagesWithoutWindows(const RigModel& rig, const std::vector<ViewObservations>& views)
{
    std::vector<Undone> all;
    for (const std::vector<int>& cameras : camerasWithoutWindows(rig))
        all.push_back({takenWithoutWindow(cameras, (int)rig.cameras.size()), cameras.size() > 1 ? -1 : cameras[0], {}, 0,
                       withoutWindows(views, cameras)});
    return all;
}

std::vector<Undone> boardOfOtherSize(const RigModel& rig, const std::vector<View>& views, const std::string& unit)
{
    const double FAR = 1.2;             // times: what is nearer a fit finds
    const double size = measuredSize(rig, views);
    if (!(std::max(size, 1./size) > FAR))
        return {};
    const std::string unitOfBoard = unitSeen(size, unit);
    const std::string times = format("%.4g times that given", size);
    Undone undone{"square of the board (--square) " + (unitOfBoard.empty() ? times : "given in " + unitOfBoard + ": it is " + times), -1,
                  views};
    undone.freed = changeOfSquare();    // several cameras hardly tell it as well as the fit
    for (View& view : undone.views)
        for (Point3d& X : view.objectPoints)
            X *= size;
    return {undone};
}

std::vector<Undone> swappedImages(const RigModel& rig, const std::vector<View>& views)
{
    return SwappedImages(rig, views).all;
}

std::vector<Undone> unrelatedImages(const RigModel& rig, const std::vector<View>& views)
{
    const int cameras = (int)rig.cameras.size();
    std::vector<Undone> all;
    const auto add = [&](const Undone& undone) {
        if (undone.poses > 0)
            all.push_back(undone);
    };
    add(split(views, "images of different cameras that are not of one moment", [](int c, bool) { return c; }, cameras));
    add(split(views, "the board not in one place in the direct and the glass image of a pair (it was moved each time)",
              [](int, bool glass) { return glass ? 1 : 0; }, 2));
    return all;
}

} // namespace tools
