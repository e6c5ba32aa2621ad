// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/detected_images.hpp"
#include "console/failure.hpp"
#include "console/progress.hpp"
#include "target/corners_vnl.hpp"
#include "target/points_csv.hpp"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <map>
#include <set>

namespace tools {

int DetectedImage::seenCount() const
{
    return (int)std::count_if(points.begin(), points.end(), seen);
}

const DetectedImage* DetectedImages::find(const std::string& stem) const
{
    const auto found = std::find_if(images.begin(), images.end(), [&](const DetectedImage& image) { return image.stem == stem; });
    return found == images.end() ? nullptr : &*found;
}

namespace {

std::string sizeText(cv::Size size)
{
    return std::to_string(size.width) + "x" + std::to_string(size.height);
}

void addImage(DetectedImages& set, const std::string& path, const std::vector<cv::Point2d>& points)
{
    if (points.empty())
        set.withoutTarget.push_back(path);
    else
        set.images.push_back({stemOf(path), path, points, {}});
}

//! What came of one image.
struct Search
{
    std::vector<cv::Point2d> points;
    cv::Size image, otherTarget;        //!< otherTarget: see Target::detect
    std::exception_ptr error;
};

void search(const std::vector<std::string>& paths, const std::vector<int>& which, const Target& target, Channel channel,
            std::vector<Search>& results, Progress& progress)
{
    cv::parallel_for_(cv::Range(0, (int)which.size()), [&](const cv::Range& range) {
        for (int k = range.start; k < range.end; k++)
        {
            const int i = which[k];
            progress.at(paths[i]);
            try
            {
                const cv::Mat grey = readGrey(paths[i], channel);
                results[i].image = grey.size();
                results[i].points = target.detect(grey, &results[i].otherTarget);
            }
            catch (...)
            {
                results[i].error = std::current_exception();
            }
            progress.step();
        }
    }, (double)which.size());
}

//! The size of the target that all these images show in place of the one that was asked for; empty if they do not agree.
cv::Size otherTargetIn(const std::vector<Search>& results, const std::vector<int>& which)
{
    const cv::Size other = results[which[0]].otherTarget;
    const bool agree = std::all_of(which.begin(), which.end(), [&](int i) { return results[i].otherTarget == other; });
    return agree ? other : cv::Size();
}

//! The images of one camera must have one size; those that differ from the most are to blame.
void requireOneSize(const std::vector<std::string>& paths, const std::vector<Search>& results, cv::Size known)
{
    std::map<std::pair<int, int>, std::vector<std::string>> pathsOf;
    for (size_t i = 0; i < paths.size(); i++)
        pathsOf[{results[i].image.width, results[i].image.height}].push_back(paths[i]);
    const auto nameOf = [](const auto& entry) { return sizeText(cv::Size(entry.first.first, entry.first.second)); };
    for (const auto& entry : pathsOf)
        if (!known.empty() && nameOf(entry) != sizeText(known))
            throw Failure("'" + entry.second[0] + "' is " + nameOf(entry) + " pixels, not " + sizeText(known) + " as the calibration "
                          "or --image-size says: use the images of this camera, not resized");
    if (pathsOf.size() < 2)
        return;
    const auto most = std::max_element(pathsOf.begin(), pathsOf.end(), [](const auto& a, const auto& b) {
        return a.second.size() < b.second.size(); });
    for (const auto& entry : pathsOf)
        if (entry.first != most->first)
            throw Failure("'" + entry.second[0] + "' is " + nameOf(entry) + " pixels, "
                          + (most->second.size() > 1 ? std::to_string(most->second.size()) + " other images" : "'" + most->second[0] + "'")
                          + (most->second.size() > 1 ? " are " : " is ") + nameOf(*most)
                          + ": all images of a camera must have one size");
}

/* Images are read and searched in parallel; the result and the error reported do not depend on the order. The first, the
middle and the last come first: if all three show a target of another size, it need not be looked for in the others. */
DetectedImages detectInImages(const std::vector<std::string>& paths, const Target& target, cv::Size imageSize, bool quiet, Channel channel)
{
    const int count = (int)paths.size();
    std::vector<int> samples, others;
    for (int i = 0; i < count; i++)
        (i == 0 || i == count/2 || i == count - 1 ? samples : others).push_back(i);
    std::vector<Search> results(count);
    {
        Progress progress("searching images for the target", count, quiet);
        search(paths, samples, target, channel, results, progress);
        if (samples.size() > 2 && !otherTargetIn(results, samples).empty())
            throw Failure(otherTargetText("'" + paths[samples[0]] + "', '" + paths[samples[1]] + "' and '" + paths[samples[2]]
                                          + "'", target, otherTargetIn(results, samples)));
        search(paths, others, target, channel, results, progress);
    }
    for (const Search& result : results)
        if (result.error)
            std::rethrow_exception(result.error);
    requireOneSize(paths, results, imageSize);

    DetectedImages set;
    set.files = paths;
    set.imageSize = results[0].image;
    for (int i = 0; i < count; i++)
        addImage(set, paths[i], results[i].points);
    if (set.images.empty() && !otherTargetIn(results, samples).empty())
        throw Failure(otherTargetText("'" + paths[0] + "'", target, otherTargetIn(results, samples)));
    return set;
}

//! A corner found at the border may lie a little beyond it; one of another image size lies far.
void requireInside(const std::string& path, const std::string& image, const std::vector<cv::Point2d>& points, cv::Size size)
{
    const double BEYOND = 1.;
    const cv::Rect2d allowed(-BEYOND, -BEYOND, size.width + 2*BEYOND, size.height + 2*BEYOND);
    for (const cv::Point2d& p : points)
        if (seen(p) && !allowed.contains(p))
            throw Failure("'" + path + "': a point of '" + image + "' is at " + cv::format("(%g, %g)", p.x, p.y)
                          + ", outside of an image of " + sizeText(size) + ": check --image-size, or the size that the "
                          "calibration says");
}

std::string extensionOf(const std::string& path) { return std::filesystem::path(path).extension().string(); }

DetectedImages imagesOfPointFile(const std::string& path, const Target* target, cv::Size imageSize)
{
    if (imageSize.empty())
        throw Failure("'" + path + "' does not say how large the images are: add --image-size=WIDTHxHEIGHT");
    DetectedImages set;
    set.files = {path};
    set.imageSize = imageSize;
    if (extensionOf(path) == ".csv")
        set.images = readPointsCsv(path);
    else
        for (const auto& image : readCornersVnl(path, target->count()))
            addImage(set, image.first, image.second);
    for (const DetectedImage& image : set.images)
        requireInside(path, extensionOf(path) == ".csv" ? image.stem : image.path, image.points, imageSize);
    return set;
}

void requireDistinctStems(const DetectedImages& set, const std::string& source)
{
    std::set<std::string> stems;
    for (const DetectedImage& image : set.images)
        if (!stems.insert(image.stem).second)
            throw Failure("two images of '" + source + "' are called '" + image.stem
                          + "': each needs a name of its own, as equal names mean images of one moment");
}

} // namespace

bool isPointFile(const std::string& source)
{
    return extensionOf(source) == ".vnl" || extensionOf(source) == ".csv";
}

DetectedImages readDetectedImages(const std::string& source, const Target* target, cv::Size imageSize, bool quiet, Channel channel)
{
    if (!target && extensionOf(source) != ".csv")
        throw Failure("'" + source + "' shows a target that must be known: give --size and --square (only a points.csv brings its "
                      "own coordinates)");
    const DetectedImages set = isPointFile(source) ? imagesOfPointFile(source, target, imageSize)
                                            : detectInImages(expandGlob(source), *target, imageSize, quiet, channel);
    if (set.images.empty())
        throw Failure("the target was not found in any image of '" + source + "': check --pattern and --size="
                      + sizeText(target->size()) + " (inner corners or dots), light and focus");
    requireDistinctStems(set, source);
    return set;
}

std::string otherTargetText(const std::string& where, const Target& target, cv::Size other)
{
    return "the chessboard in " + where + " looks like one of " + sizeText(other) + " inner corners, not --size="
        + sizeText(target.size()) + ": give --size=" + sizeText(other) + ", and count inner corners, not squares";
}

} // namespace tools
