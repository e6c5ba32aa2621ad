// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/rig_data.hpp"
#include "calibrate/provenance.hpp"
#include "console/failure.hpp"
#include "console/options.hpp"
#include "console/table.hpp"
#include "console/view_names.hpp"
#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

using namespace cv;

namespace tools {

void RigSources::addTo(OptionParser& parser, const std::string& aboutGlass, const std::string& aboutDirect)
{
    parser.addForEach("--direct", direct.data(), MAX_CAMERAS, aboutDirect, "--glass");
    parser.addForEach("--glass", glass.data(), MAX_CAMERAS, aboutGlass).required();
    addViewPattern(parser, viewPattern);
}

std::vector<std::string> RigSources::all() const
{
    std::vector<std::string> given;
    for (const PerCamera<std::string>* sources : {&direct, &glass})
        std::copy_if(sources->begin(), sources->end(), std::back_inserter(given), [](const auto& s) { return !s.empty(); });
    return given;
}

int RigSources::cameraCount() const
{
    int count = 0;
    for (int c = 0; c < MAX_CAMERAS; c++)
        if (!glass[c].empty() || !direct[c].empty())
            count = c + 1;
    return count;
}

bool RigSources::anyDirect() const
{
    return std::any_of(direct.begin(), direct.end(), [](const std::string& source) { return !source.empty(); });
}

std::vector<const DetectedImages*> RigImages::all() const
{
    std::vector<const DetectedImages*> sets;
    for (int c = 0; c < MAX_CAMERAS; c++)
        sets.insert(sets.end(), {&direct[c], &glass[c]});
    return sets;
}

void RigImages::nameSingles()
{
    std::string name;
    for (const DetectedImages* set : all())
        if (set->files.size() > 1 || set->images.size() > 1)
            return;
    for (PerCamera<DetectedImages>* images : {&glass, &direct})
        for (DetectedImages& set : *images)
            for (DetectedImage& image : set.images)
                image.stem = name = name.empty() ? image.stem : name;
}

static int countTaken(const PerCamera<std::vector<Point2d>>& images)
{
    return (int)std::count_if(images.begin(), images.end(), [](const std::vector<Point2d>& pixels) { return !pixels.empty(); });
}

int View::countDirect() const { return countTaken(direct); }

int View::countGlass() const { return countTaken(glass); }

int RigData::countPairs(int camera) const
{
    return (int)std::count_if(views.begin(), views.end(), [=](const View& view) { return view.isPair(camera); });
}

bool RigData::hasDirect() const
{
    return std::any_of(views.begin(), views.end(), [](const View& view) { return view.countDirect() > 0; });
}

int RigData::countPairs() const
{
    int count = 0;
    for (int c = 0; c < cameraCount; c++)
        count += countPairs(c);
    return count;
}

std::vector<std::pair<int, int>> cameraLinks(const RigData& data, bool throughOnly)
{
    const auto common = [&](int a, int b) {
        return std::count_if(data.views.begin(), data.views.end(), [&](const View& view) {
            return (view.hasGlass(a) && view.hasGlass(b)) || (!throughOnly && view.hasDirect(a) && view.hasDirect(b));
        });
    };
    std::vector<std::pair<int, int>> links;
    std::vector<int> placed = {0};
    while ((int)placed.size() < data.cameraCount)
    {
        std::pair<int, int> best;
        std::ptrdiff_t most = 0;
        for (int from : placed)
            for (int to = 0; to < data.cameraCount; to++)
                if (std::find(placed.begin(), placed.end(), to) == placed.end() && common(from, to) > most)
                {
                    best = {from, to};
                    most = common(from, to);
                }
        if (!most)
        {
            std::string alone;
            for (int c = 0; c < data.cameraCount; c++)
                if (std::find(placed.begin(), placed.end(), c) == placed.end())
                    alone += (alone.empty() ? "" : ", ") + std::to_string(c + 1);
            throw Failure((data.cameraCount == 2 ? "both cameras have no view in common, so their relative pose cannot"
                           : "camera " + alone + " has no view in common with the others, so its pose in the rig cannot")
                          + " be found: images of one moment must have equal names in the folders of all cameras");
        }
        links.push_back(best);
        placed.push_back(best.second);
    }
    return links;
}

std::vector<int> allViews(const RigData& data)
{
    std::vector<int> all(data.views.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
}

namespace {

struct GivenImage
{
    int camera;
    bool glass;
    const DetectedImage* image;
};

[[noreturn]] void refuseSame(const GivenImage& given, const GivenImage& first, const char* where)
{
    const bool cameras = first.camera != given.camera;
    const auto of = [&](const GivenImage& g) {
        return cameras ? cv::format("camera %d", g.camera + 1) : (g.glass ? "--glass" : "--direct") + cameraSuffix(g.camera); };
    throw Failure(cv::format("'%s' of %s ('%s') shows the target in %s of '%s' of %s ('%s'): give each %s its own images",
                             given.image->stem.c_str(), of(given).c_str(), given.image->path.c_str(), where, first.image->stem.c_str(),
                             of(first).c_str(), first.image->path.c_str(), cameras ? "camera" : "option"));
}

std::vector<GivenImage> imagesOf(const RigImages& sets)
{
    std::vector<GivenImage> images;
    for (int c = 0; c < MAX_CAMERAS; c++)
        for (bool glass : {false, true})
            for (const DetectedImage& image : (glass ? sets.glass : sets.direct)[c].images)
                if (image.seenCount() >= MIN_POSE_POINTS)
                    images.push_back({c, glass, &image});
    return images;
}

/** No two cameras see a target in the same pixels, nor does one without and with its window. To the last digit that is said of any two
images; of one moment, of two cameras, also where the image was stored anew. */
void requireOwnImages(const RigImages& sets)
{
    std::map<std::vector<std::pair<double, double>>, GivenImage> known;
    std::map<std::string, std::vector<GivenImage>> ofMoment;
    for (const GivenImage& given : imagesOf(sets))
    {
        std::vector<std::pair<double, double>> pixels;
        for (const Point2d& p : given.image->points)
            if (p.x == p.x)
                pixels.emplace_back(p.x, p.y);
        const GivenImage& first = known.insert({pixels, given}).first->second;
        if (first.camera != given.camera || first.glass != given.glass)
            refuseSame(given, first, "the very pixels");
        for (const GivenImage& other : ofMoment[given.image->stem])
            if (other.camera != given.camera && areOfOneImage(other.image->points, given.image->points, USUAL_TOLERANCE))
                refuseSame(given, other, "the pixels (to 0.1 px)");
        ofMoment[given.image->stem].push_back(given);
    }
}

//! By the part of its path that the user says.
void nameByPattern(RigImages& sets, const std::string& pattern)
{
    for (int c = 0; c < MAX_CAMERAS; c++)
        for (DetectedImages* set : {&sets.direct[c], &sets.glass[c]})
        {
            std::vector<DetectedImage*> images;
            std::vector<std::string> paths;
            for (DetectedImage& image : set->images)
                if (!isPointFile(image.path))
                {
                    images.push_back(&image);
                    paths.push_back(image.path);
                }
            const std::vector<std::string> moments = momentsByPattern(paths, pattern);
            for (size_t i = 0; i < images.size(); i++)
                images[i]->stem = moments[i];
        }
}

//! Images of one moment get one name, where each camera has its own in its names.
void nameViews(RigImages& sets)
{
    std::vector<std::vector<std::string>> names;
    std::vector<std::vector<DetectedImage*>> images;
    for (int c = 0; c < MAX_CAMERAS; c++)
    {
        std::vector<DetectedImage*> ofCamera;
        for (DetectedImages* set : {&sets.direct[c], &sets.glass[c]})
            for (DetectedImage& image : set->images)
                if (image.objectPoints.empty())     // of points.csv, views are called what they are called
                    ofCamera.push_back(&image);
        if (ofCamera.empty())
            continue;
        names.emplace_back();
        for (const DetectedImage* image : ofCamera)
            names.back().push_back(image->stem);
        images.push_back(ofCamera);
    }
    takeOffCameras(names);
    for (size_t c = 0; c < images.size(); c++)
        for (size_t i = 0; i < images[c].size(); i++)
            images[c][i]->stem = names[c][i];
}

} // namespace

RigImages readRigImages(const RigSources& sources, const Target* target, const PerCamera<Size>& imageSize, bool quiet)
{
    std::vector<ImageSource> given;
    std::vector<DetectedImages*> places;
    RigImages sets;
    for (int c = 0; c < MAX_CAMERAS; c++)
        for (bool through : {false, true})
        {
            const std::string& source = (through ? sources.glass : sources.direct)[c];
            if (source.empty())
                continue;
            given.push_back({source, imageSize[c], c, through ? "glass images" : "direct images", sources.yFrom});
            places.push_back(&(through ? sets.glass : sets.direct)[c]);
        }
    const std::vector<DetectedImages> found = readDetectedImages(given, target, quiet, sources.channel);
    for (size_t i = 0; i < found.size(); i++)
        *places[i] = found[i];
    sources.viewPattern.empty() ? nameViews(sets) : nameByPattern(sets, sources.viewPattern);
    requireOwnImages(sets);
    return sets;
}

namespace {

int countCameras(const RigImages& sets)
{
    int count = 1;
    for (int c = 0; c < MAX_CAMERAS; c++)
        if (!sets.glass[c].images.empty())
            count = c + 1;
    return count;
}

std::vector<std::vector<Point2d>*> imagesOf(View& view)
{
    std::vector<std::vector<Point2d>*> images;
    for (int c = 0; c < MAX_CAMERAS; c++)
        for (std::vector<Point2d>* pixels : {&view.direct[c], &view.glass[c]})
            if (!pixels->empty())
                images.push_back(pixels);
    return images;
}

void alignImages(const Target& target, View& view)
{
    const std::vector<std::vector<Point2d>*> images = imagesOf(view);
    for (size_t i = 1; i < images.size(); i++)
        *images[i] = target.alignWith(*images[0], *images[i]);
}

//! Puts points with coordinates of their own where the view has these, or at its end.
std::vector<Point2d> matched(const DetectedImage& image, View& view)
{
    using Coordinates = std::tuple<double, double, double>;
    std::map<Coordinates, size_t> indexOf;
    for (size_t i = 0; i < view.objectPoints.size(); i++)
        indexOf.emplace(Coordinates(view.objectPoints[i].x, view.objectPoints[i].y, view.objectPoints[i].z), i);
    std::vector<Point2d> pixels(view.objectPoints.size(), Point2d(NAN, NAN));
    for (size_t i = 0; i < image.points.size(); i++)
    {
        const Point3d& X = image.objectPoints[i];
        const auto place = indexOf.emplace(Coordinates(X.x, X.y, X.z), view.objectPoints.size());
        if (place.second)
        {
            view.objectPoints.push_back(X);
            pixels.emplace_back();
        }
        pixels[place.first->second] = image.points[i];
    }
    return pixels;
}

void moveNear(RigData& data)
{
    std::vector<Point3d> all;
    for (const View& view : data.views)
        all.insert(all.end(), view.objectPoints.begin(), view.objectPoints.end());
    data.origin = cv::refract::NearOrigin(all);
    for (View& view : data.views)
        data.origin.move(view.objectPoints);
}

} // namespace

RigData groupIntoViews(const Target* target, const RigImages& sets, bool unpaired, int fewest)
{
    RigData data;
    data.cameraCount = countCameras(sets);
    std::map<std::pair<std::string, bool>, View> views;
    // Boards first: their points, and where each is, must stand before others are matched with them.
    for (bool board : {true, false})
    {
        for (int c = 0; c < data.cameraCount; c++)
            for (bool through : {false, true})
            {
                const DetectedImages& set = (through ? sets.glass : sets.direct)[c];
                for (const DetectedImage& image : set.images)
                {
                    if (image.seenCount() < fewest || image.objectPoints.empty() != board)
                        continue;
                    View& view = views[{image.stem, unpaired && through}];
                    view.stem = image.stem;
                    if (board)
                    {
                        view.objectPoints = target->objectPoints();
                        view.neighbours = target->neighbours();
                    }
                    (through ? view.glass : view.direct)[c] = board ? image.points : matched(image, view);
                }
            }
        if (board)
            for (auto& entry : views)
                alignImages(*target, entry.second);
    }
    for (int c = 0; c < data.cameraCount; c++)
        data.imageSize[c] = sets.direct[c].images.empty() ? sets.glass[c].imageSize : sets.direct[c].imageSize;
    for (auto& entry : views)
    {
        for (std::vector<Point2d>* pixels : imagesOf(entry.second))
            pixels->resize(entry.second.objectPoints.size(), Point2d(NAN, NAN));
        data.views.push_back(entry.second);
    }
    moveNear(data);
    return data;
}

} // namespace tools
