// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/calibration_input.hpp"
#include <algorithm>

using namespace cv;
using namespace cv::refract;

namespace tools {

bool hasImages(const std::vector<View>& views, int camera, ImageState state)
{
    return std::any_of(views.begin(), views.end(), [=](const View& view) {
        return (state != GLASS_IMAGES && view.hasDirect(camera)) || (state != DIRECT_IMAGES && view.hasGlass(camera)); });
}

Point2d undone(const ImageTurn& turn, Point2d p, Size size)
{
    if (turn.swap)
        std::swap(p.x, p.y);
    return Point2d(turn.flipX ? size.width - 1. - p.x : p.x, turn.flipY ? size.height - 1. - p.y : p.y);
}

std::vector<int> renumbered(const std::vector<Point3d>& board, const ImageTurn& by)
{
    if (board.empty())
        return {};
    Vec3d low = board[0], high = board[0];
    for (const Point3d& X : board)
        for (int axis = 0; axis < 3; axis++)
        {
            low[axis] = std::min(low[axis], Vec3d(X)[axis]);
            high[axis] = std::max(high[axis], Vec3d(X)[axis]);
        }
    const double near = 1e-6*norm(high - low);
    const Vec3d middle = 0.5*(low + high);
    std::vector<int> numbers;
    for (const Point3d& X : board)
    {
        Vec3d there = Vec3d(X) - middle;
        if (by.swap)
            std::swap(there[0], there[1]);
        there = Vec3d(by.flipX ? -there[0] : there[0], by.flipY ? -there[1] : there[1], there[2]) + middle;
        const auto found = std::find_if(board.begin(), board.end(), [&](const Point3d& Y) { return norm(Vec3d(Y) - there) <= near; });
        if (found == board.end())
            return {};
        numbers.push_back(int(found - board.begin()));
    }
    return numbers;
}

void exchangeStates(std::vector<View>& views, int camera)
{
    for (View& view : views)
        for (int c = 0; c < MAX_CAMERAS; c++)
            if (camera < 0 || camera == c)
                std::swap(view.direct[c], view.glass[c]);
}

void exchangeCameras(std::vector<View>& views, int a, int b, ImageState state)
{
    for (View& view : views)
    {
        if (state != GLASS_IMAGES)
            std::swap(view.direct[a], view.direct[b]);
        if (state != DIRECT_IMAGES)
            std::swap(view.glass[a], view.glass[b]);
    }
}

void addPart(const View& view, const std::function<bool(int camera, bool glass)>& belong, std::vector<View>& views)
{
    View part = view;
    for (int c = 0; c < MAX_CAMERAS; c++)
    {
        if (!belong(c, false))
            part.direct[c].clear();
        if (!belong(c, true))
            part.glass[c].clear();
    }
    if (part.countDirect() > 0 || part.hasGlass())
        views.push_back(part);
}

bool hasPairs(const RigData& data)
{
    return data.countPairs() > 0;
}

CalibrationInput oneCamera(const CalibrationInput& input, int camera)
{
    CalibrationInput one = input;
    one.data.cameraCount = 1;
    one.data.imageSize[0] = input.data.imageSize[camera];
    one.options.known[0] = input.options.known[camera];
    one.options.knownCovariance[0] = input.options.knownCovariance[camera];
    if (!one.options.leftOut.empty())
        one.options.leftOut = {input.options.leftOut[camera]};
    if (one.options.places.size() > 1)
        one.options.places = {input.options.places[camera]};
    one.options.windows.clear();
    one.options.flags &= ~GLASS_USE_POSES;      // they are of camera 1
    one.data.views.clear();
    for (const View& view : input.data.views)
        addPart(view, [=](int c, bool) { return c == camera; }, one.data.views);
    exchangeCameras(one.data.views, 0, camera, ALL_IMAGES);
    return one;
}

std::vector<Explanation> bestBelow(double most, const std::vector<Explanation>& tried)
{
    double best = most;
    for (const Explanation& e : tried)
        best = std::min(best, e.px);
    std::vector<Explanation> explaining;
    for (const Explanation& e : tried)
        if (e.px < most && e.px <= EXPLAINS_AS_WELL*best)
            explaining.push_back(e);
    return explaining;
}

std::vector<Explanation> withoutFreer(const std::vector<Explanation>& explaining)
{
    std::vector<Explanation> kept;
    for (const Explanation& e : explaining)
        if (kept.empty() || e.px < kept.back().px)
            kept.push_back(e);
    return kept;
}

} // namespace tools
