// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/rig_data.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>
#include <set>

using namespace cv;

namespace tools {

namespace {

const double ONE_IMAGE_PX = 1e-4;       // corners that agree so well are the same image: two shots differ by their noise
const double PARALLEL_DEG = 5.;
const int FEW_BOARDS = 3;               // to say that all are parallel
const double USUAL_FOCAL = 1.5;         // in image widths: tilts need no better

std::set<std::string> stemsOf(const DetectedImages& set, bool found)
{
    std::set<std::string> stems;
    for (const DetectedImage& image : set.images)
        stems.insert(image.stem);
    for (size_t i = 0; !found && i < set.withoutTarget.size(); i++)
        stems.insert(stemOf(set.withoutTarget[i]));
    return stems;
}

std::set<std::string> stemsOf(const std::vector<std::string>& paths)
{
    std::set<std::string> stems;
    for (const std::string& path : paths)
        stems.insert(stemOf(path));
    return stems;
}

std::vector<std::string> common(const std::set<std::string>& a, const std::set<std::string>& b)
{
    std::vector<std::string> both;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
    return both;
}

std::string examples(const std::set<std::string>& stems)
{
    std::string text;
    int count = 0;
    for (const std::string& stem : stems)
    {
        if (++count > 3)
            return text + ", ...";
        text += (text.empty() ? "'" : ", '") + stem + "'";
    }
    return text;
}

std::string noPairText(const std::string& suffix, const std::set<std::string>& direct, const std::set<std::string>& glass)
{
    return "no image of --direct" + suffix + " (" + examples(direct) + ") has the name of one of --glass" + suffix + " ("
           + examples(glass) + "), so there is no pair: where the board did not move between the two images, give them the same file "
           "name in two folders; if it did (hand-held), add --unpaired";
}

bool areOneImage(const DetectedImage& a, const DetectedImage& b)
{
    if (a.points.size() != b.points.size())
        return false;
    for (size_t i = 0; i < a.points.size(); i++)
    {
        if (seen(a.points[i]) != seen(b.points[i]))
            return false;
        if (seen(a.points[i]) && norm(a.points[i] - b.points[i]) > ONE_IMAGE_PX)
            return false;
    }
    return a.seenCount() > 0;
}

void noticeDuplicates(const RigImages& sets, std::vector<std::string>& notices)
{
    struct Named { const DetectedImage* image; std::string name; };
    std::vector<Named> all;
    for (int c = 0; c < MAX_CAMERAS; c++)
        for (bool through : {false, true})
            for (const DetectedImage& image : (through ? sets.glass : sets.direct)[c].images)
                all.push_back({&image, "'" + image.path + "'"});
    std::vector<std::pair<std::string, std::string>> repeated;      // one image and a later one
    for (size_t i = 0; i < all.size(); i++)
    {
        const auto first = std::find_if(all.begin(), all.begin() + i, [&](const Named& other) {
            return areOneImage(*all[i].image, *other.image); });
        if (first != all.begin() + i)
            repeated.push_back({first->name, all[i].name});
    }
    if (repeated.empty())
        return;
    const size_t FEW = 3;
    std::string text;
    for (size_t i = 0; i < std::min(FEW, repeated.size()); i++)
        text += (i ? ", " : "") + repeated[i].first + " and " + repeated[i].second;
    if (repeated.size() > FEW)
        text += format(", and %zu more", repeated.size() - FEW);
    notices.push_back((repeated.size() == 1 ? std::string("one image is") : format("%zu images are", repeated.size()))
                      + " given more than once (the same corners to 0.0001 px), so that the +- are too small; leave out what stands twice: "
                      + text);
}

//! Unit normal of the board in the frame of the camera, roughly: for a usual lens, without its distortion. 0: it has none.
Vec3d boardNormal(const std::vector<Point3d>& object, const std::vector<Point2d>& pixels, Size size)
{
    std::vector<Point2d> board, directions;
    for (size_t i = 0; i < pixels.size(); i++)
        if (seen(pixels[i]))
        {
            if (object[i].z != object[0].z)
                return Vec3d();
            board.emplace_back(object[i].x, object[i].y);
            directions.push_back((pixels[i] - 0.5*Point2d(size))/(USUAL_FOCAL*size.width));
        }
    const Mat H = board.size() < 4 ? Mat() : findHomography(board, directions);
    if (H.empty())
        return Vec3d();
    const Matx33d h = H;
    return normalize(Vec3d(h(0, 0), h(1, 0), h(2, 0)).cross(Vec3d(h(0, 1), h(1, 1), h(2, 1))));
}

//! Largest angle between a board and the middle one, degrees; enough boards: otherwise NaN.
double tiltSpreadDeg(const RigData& data, int camera, bool through)
{
    std::vector<Vec3d> normals;
    Vec3d middle;
    for (const View& view : data.views)
    {
        const Vec3d normal = boardNormal(view.objectPoints, (through ? view.glass : view.direct)[camera], data.imageSize[camera]);
        if (normal == Vec3d())
            continue;
        normals.push_back(normal[2] < 0 ? -normal : normal);
        middle += normals.back();
    }
    if ((int)normals.size() < FEW_BOARDS)
        return NAN;
    double spread = 0.;
    for (const Vec3d& n : normals)
        spread = std::max(spread, std::atan2(norm(n.cross(middle)), n.dot(middle))*180./CV_PI);
    return spread;
}

void noticeParallel(const RigData& data, std::vector<std::string>& notices)
{
    for (int c = 0; c < data.cameraCount; c++)
        for (bool through : {false, true})
        {
            const double spread = tiltSpreadDeg(data, c, through);
            if (!(spread < PARALLEL_DEG) || (through && data.countPairs(c)))     // pairs determine the window all the same
                continue;
            notices.push_back((data.cameraCount == 1 ? "" : format("camera %d: ", c + 1))
                + format("all boards in the %s are parallel within %.1f deg: ", through ? "images through the window"
                         : "direct images", spread)
                + (through ? "they hardly determine the window's tilt" : "they hardly determine the focal length")
                + ". Tilt the board by 10 to 35 degrees, to all sides");
        }
}

//! Of the images of a camera that do not show the target, those of whose names other cameras have one that does.
size_t seenByOthers(const RigImages& sets, int camera, bool through)
{
    std::set<std::string> seenElsewhere;
    for (int c = 0; c < MAX_CAMERAS; c++)
        for (const DetectedImage& image : c == camera ? std::vector<DetectedImage>() : (through ? sets.glass : sets.direct)[c].images)
            seenElsewhere.insert(stemOf(image.path));
    const std::vector<std::string>& without = (through ? sets.glass : sets.direct)[camera].withoutTarget;
    return (size_t)std::count_if(without.begin(), without.end(), [&](const std::string& path) {
        return seenElsewhere.count(stemOf(path)); });
}

void noticeNotFound(const RigImages& sets, std::vector<std::string>& notices)
{
    for (int c = 0; c < MAX_CAMERAS; c++)
        for (bool through : {false, true})
        {
            const DetectedImages& set = (through ? sets.glass : sets.direct)[c];
            const size_t found = set.images.size(), count = found + set.withoutTarget.size();
            if (2*found >= count)
                continue;
            const std::string few = format("the target was found in only %zu of %zu ", found, count)
                + (through ? "images through the window" : "direct images") + (c ? format(" of camera %d", c + 1) : "");
            const size_t elsewhere = seenByOthers(sets, c, through);
            notices.push_back(few + (2*elsewhere < set.withoutTarget.size()
                ? ": check --pattern and --size (count the inner corners, dots or tags), light and focus"
                : format("; other cameras saw it at %zu of the moments without: where all of it is in view, check light and focus",
                         elsewhere)));
        }
}

} // namespace

void requirePairs(const RigImages& sets)
{
    for (int c = 0; c < MAX_CAMERAS; c++)
    {
        const DetectedImages &direct = sets.direct[c], &glass = sets.glass[c];
        if (direct.images.empty() || glass.images.empty() || !common(stemsOf(direct, true), stemsOf(glass, true)).empty())
            continue;
        const std::string suffix = cameraSuffix(c);
        const std::set<std::string> directStems = stemsOf(direct, false), glassStems = stemsOf(glass, false);
        const std::vector<std::string> lost = common(directStems, glassStems);
        if (!lost.empty())
            throw Failure(format("the target was not found in both images of any of the %zu pair(s) of --direct%s and --glass%s "
                                 "('%s'): check light and focus, or say --unpaired if no pairs are meant", lost.size(),
                                 suffix.c_str(), suffix.c_str(), lost.front().c_str()));
        if (direct.images.size() > 1 && glass.images.size() > 1)
            throw Failure(noPairText(suffix, directStems, glassStems));
    }
}

void requirePairNames(const RigSources& sources)
{
    for (int c = 0; c < MAX_CAMERAS; c++)
    {
        const std::string &direct = sources.direct[c], &glass = sources.glass[c];
        if (direct.empty() || glass.empty() || isPointFile(direct) || isPointFile(glass))
            continue;
        const std::set<std::string> directStems = stemsOf(expandGlob(direct)), glassStems = stemsOf(expandGlob(glass));
        if (directStems.size() > 1 && glassStems.size() > 1 && common(directStems, glassStems).empty())
            throw Failure(noPairText(cameraSuffix(c), directStems, glassStems));
    }
}

std::vector<std::string> noticesOf(const RigImages& sets, const RigData& data)
{
    std::vector<std::string> notices;
    noticeNotFound(sets, notices);
    noticeDuplicates(sets, notices);
    noticeParallel(data, notices);
    return notices;
}

} // namespace tools
