// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/target_search.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "target/april_grid.hpp"
#include "target/chessboard.hpp"
#include "target/dot_lattice.hpp"
#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <map>
#include <optional>

namespace tools {

namespace {

const size_t TRIED = 2;             // images that a guess is tried on: each takes a second

//! A part of the target has at most its size.
bool mayBePart(cv::Size chessboard, const Target& target)
{
    const cv::Size whole = longerFirst(target.size());
    return !chessboard.empty() && chessboard.width <= whole.width && chessboard.height <= whole.height;
}

std::string quotedNames(const std::vector<ImageWithoutTarget>& images)
{
    std::vector<std::string> paths;
    for (const ImageWithoutTarget& image : images)
        paths.push_back(image.path);
    return listed(paths);
}

//! The size that most of the images show in which a chessboard is seen; empty: there is no such majority.
cv::Size usualSize(const std::vector<ImageWithoutTarget>& images)
{
    std::map<std::pair<int, int>, int> counts;
    int all = 0;
    for (const ImageWithoutTarget& image : images)
        if (!image.chessboard.empty())
        {
            counts[{image.chessboard.width, image.chessboard.height}]++;
            all++;
        }
    for (const auto& entry : counts)
        if (2*entry.second > all && (entry.second > 1 || images.size() == 1))
            return cv::Size(entry.first.first, entry.first.second);
    return cv::Size();
}

//! In at least one of the first images.
bool isFound(const Target& target, const std::vector<ImageWithoutTarget>& images, Channel channel)
{
    const size_t count = std::min(images.size(), TRIED);
    std::vector<char> found(count);
    inParallel((int)count, [&](int i) {
        found[i] = !target.detect(readGrey(images[i].path, channel)).empty(); });
    return std::count(found.begin(), found.end(), true) > 0;
}

//! As large as another. No value: there is no such board.
std::optional<Target> withPattern(const Target& target, const std::string& pattern, const std::string& dictionary, bool partial)
{
    TargetOptions options;
    options.pattern = pattern;
    options.size = target.sizeText();
    options.square = target.square();
    options.dictionary = dictionary;
    options.partial = partial;
    try
    {
        return Target(options);
    }
    catch (const Failure&)          // no such board can be: a dictionary with too few markers
    {
        return std::nullopt;
    }
}

//! Half a board, or a hand before it: what to do.
std::string partAdvice(const std::vector<ImageWithoutTarget>& images, const Target& target, Channel channel)
{
    const std::optional<Target> partial = withPattern(target, "chessboard", TargetOptions().dictionary, true);
    return std::string("keep the whole board in view and uncovered")
           + (partial && isFound(*partial, images, channel)
              ? ", or, with one camera and a hand-held board, add --unpaired --partial, which finds a piece of it in these images"
              : "; what is seen of it is too little for --partial");
}

std::string partText(const std::vector<ImageWithoutTarget>& images, const Target& target, Channel channel)
{
    std::vector<std::string> sizes;
    for (const ImageWithoutTarget& image : images)
        if (mayBePart(image.chessboard, target))
            sizes.push_back(sizeText(image.chessboard));
    std::sort(sizes.begin(), sizes.end());
    sizes.erase(std::unique(sizes.begin(), sizes.end()), sizes.end());
    std::string text;
    for (const std::string& size : sizes)
        text += (text.empty() ? "" : ", ") + size;
    return "only a part of the chessboard of --size=" + target.sizeText() + " is seen in " + quotedNames(images) + " (" + text
           + " inner corners): " + partAdvice(images, target, channel);
}

//! A target with tags: a ChArUco board with the same number of points, or an AprilGrid; empty: none is found.
std::string otherTags(const std::vector<ImageWithoutTarget>& images, const Target& target, Channel channel)
{
    const std::vector<ImageWithoutTarget> one(images.begin(), images.begin() + 1);
    for (const char* dictionary : {"DICT_4X4_250", "DICT_5X5_1000", "DICT_6X6_1000", "DICT_7X7_1000", "DICT_ARUCO_ORIGINAL"})
    {
        const std::optional<Target> tried = withPattern(target, "charuco", dictionary, false);
        if (tried && isFound(*tried, one, channel))
            return std::string("--pattern=charuco --dictionary=") + dictionary;
    }
    if (target.pattern() != Target::APRILGRID && showsAprilTags(readGrey(one[0].path, channel)))
        return "--pattern=aprilgrid (whose --size counts tags)";
    return "";
}

//! Where no chessboard is asked for, nobody has looked for one yet.
cv::Size chessboardIn(const std::vector<ImageWithoutTarget>& images, Channel channel)
{
    std::vector<ImageWithoutTarget> seen(images.begin(), images.begin() + (long)std::min(images.size(), TRIED));
    for (ImageWithoutTarget& image : seen)
        image.chessboard = lookForChessboard(readGrey(image.path, channel));
    return seen.size() > 1 ? usualSize(seen) : seen[0].chessboard;
}

//! A plate of dots of another size, or one of which a row is covered; empty: no image shows one.
std::string otherDots(const std::vector<ImageWithoutTarget>& images, const Target& target, Channel channel)
{
    for (size_t i = 0; i < std::min(images.size(), TRIED); i++)
    {
        bool asymmetric = false;
        const cv::Size size = dotGridIn(readGrey(images[i].path, channel), asymmetric);
        const std::string pattern = asymmetric ? "acircles" : "circles";
        const cv::Size asked = asymmetric ? target.size() : longerFirst(target.size());
        if (!size.empty() && pattern == target.patternName() && size == asked)
            return "of the plate in " + quotedNames({images[i]}) + " too little is seen: at least half of the dots of each outer row and "
                   "column, and three quarters of all, must be in view and uncovered";
        if (!size.empty())
            return "the dots in " + quotedNames({images[i]}) + " look like a plate of " + sizeText(size)
                   + " dots, not --pattern=" + target.patternName() + " --size=" + target.sizeText() + ": give --pattern=" + pattern
                   + " --size=" + sizeText(size) + ", or, if it has more, keep its outer rows and columns in view";
    }
    return "";
}

const size_t FIRST = 3;             // images that are searched before all others
const size_t EXPLAINING = 6;        // images of which is said what they show instead
const size_t GLANCES = 16;          // images without a target in all, after which no more are looked at

//! first, last, middle, quarters, ...: 0 ... count - 1, so that any number of the first of them is spread over all.
std::vector<int> spread(int count)
{
    std::vector<int> order;
    std::vector<char> taken(count);
    const auto take = [&](int i) {
        if (!taken[i])
            order.push_back(i);
        taken[i] = true;
    };
    for (int parts = 1; (int)order.size() < count; parts *= 2)
        for (int k = 0; k <= parts; k++)
            take((int)((int64_t)k*(count - 1)/parts));
    return order;
}

std::vector<int> part(const std::vector<int>& all, size_t from, size_t to)
{
    return std::vector<int>(all.begin() + (long)std::min(from, all.size()), all.begin() + (long)std::min(to, all.size()));
}

} // namespace

std::vector<cv::Point2d> detectIn(const cv::Mat& grey, const std::string& path, const Target& target, cv::Size* other)
{
    try
    {
        return target.detect(grey, other);
    }
    catch (const Failure& e)
    {
        throw Failure("'" + path + "': " + e.what());
    }
}

//! The size of the chessboard that all these images show in place of the one that was asked for; empty if they do not agree.
static cv::Size otherChessboard(const std::vector<ImageWithoutTarget>& images)
{
    const cv::Size other = images[0].chessboard;
    const auto isSame = [&](const ImageWithoutTarget& image) { return image.chessboard == other; };
    const bool agree = std::all_of(images.begin(), images.end(), isSame);
    return agree ? other : cv::Size();
}

std::string explainMissing(const std::vector<ImageWithoutTarget>& images, const std::string& where, size_t all, const Target& target,
                           Channel channel)
{
    const bool isChessboard = target.pattern() == Target::CHESSBOARD && !target.partial();
    const auto parts = (size_t)std::count_if(images.begin(), images.end(), [&](const ImageWithoutTarget& image) {
        return mayBePart(image.chessboard, target); });
    const cv::Size usual = usualSize(images);
    std::vector<ImageWithoutTarget> first(images.begin(), images.begin() + (long)std::min<size_t>(images.size(), 3));
    if (isChessboard && !usual.empty() && !mayBePart(usual, target))
        return otherTargetText(quotedNames(first), target, usual);
    if (isChessboard && 2*parts >= images.size())        // clutter looks like a few squares here and there
    {
        // A smaller board, or one that is covered in the same way everywhere: nothing in the images tells which. But one less in both
        // directions are squares that were counted.
        const std::string other = otherTargetText(quotedNames(first), target, usual);
        if (usual + cv::Size(1, 1) == longerFirst(target.size()))
            return other;
        if (images.size() > 1 && !otherChessboard(images).empty())
            return other + "; or, if the board has more, " + partAdvice(images, target, channel);
        const std::string part = partText(images, target, channel);
        return usual.empty() ? part : part + "; or it is another board: if that is all of it, give --size=" + sizeText(usual);
    }
    const std::string looked = "any image of " + where
        + (images.size() < all ? cv::format(" (%zu of %zu were looked at)", images.size(), all) : "");
    if (target.pattern() == Target::DOTS)
        return "the dots of --target were not found in " + looked + ": at least 40 % of them must be in view, each at least 3 pixels wide; "
               "are x, y, z of --target right-handed, and is the image not mirrored?";
    if (target.partial())
        return "no piece of the chessboard, of at least 5x5 inner corners, was found in " + looked + ": show more of it, check light and "
               "focus";
    const std::string dots = otherDots(images, target, channel);
    if (!dots.empty())
        return dots;
    const std::string other = otherTags(images, target, channel);
    if (!other.empty())
        return "the target in " + quotedNames({images[0]}) + " looks like one of another kind: give " + other + ", or check --size="
               + target.sizeText();
    const cv::Size chessboard = isChessboard ? cv::Size() : chessboardIn(images, channel);
    if (!chessboard.empty())
        return "the target in " + quotedNames(first) + " looks like a chessboard of " + sizeText(chessboard)
               + " inner corners: give --pattern=chessboard --size=" + sizeText(chessboard);
    return "the target was not found in " + looked + ": check --pattern and --size=" + target.sizeText()
           + " (inner corners, dots or tags), light and focus";
}

std::string otherTargetText(const std::string& where, const Target& target, cv::Size other)
{
    return "the chessboard in " + where + " looks like one of " + sizeText(other) + " inner corners, not --size="
        + target.sizeText() + ": give --size=" + sizeText(other) + ", and count inner corners, not squares";
}

TargetSearch::TargetSearch(const std::string& source, const std::vector<std::string>& paths, const Target& target, Channel channel)
    : source_(source), paths_(paths), target_(target), channel_(channel), results_(paths.size()) {}

void TargetSearch::search(const std::vector<int>& which, Progress& progress)
{
    // What else may be in an image is asked for only where nothing is found in any.
    const bool isSizeKnown = std::any_of(results_.begin(), results_.end(), [](const Result& result) { return !result.points.empty(); });
    inParallel((int)which.size(), [&](int k) {
        const int i = which[k];
        progress.at(paths_[i]);
        Result& result = results_[i];
        result.points = detectIn(readGrey(paths_[i], channel_), paths_[i], target_, isSizeKnown ? nullptr : &result.other);
        result.done = true;
        progress.step();
    });
}

bool TargetSearch::isLikelyInAny(const std::vector<int>& which, Progress& progress)
{
    std::atomic<bool> any(false);
    inParallel((int)which.size(), [&](int k) {
        const int i = which[k];
        progress.at(paths_[i]);
        if (!any && target_.isLikelySeen(readGrey(paths_[i], channel_)))
            any = true;
    });
    return any;
}

void TargetSearch::lookForOthers(const std::vector<int>& which)
{
    if (target_.pattern() != Target::CHESSBOARD)
        return;
    inParallel((int)which.size(), [&](int k) {
        const int i = which[k];
        const cv::Size seen = lookForChessboard(readGrey(paths_[i], channel_));
        if (seen != longerFirst(target_.size()))
            results_[i].other = seen;
    });
}

void TargetSearch::refuse(const std::vector<int>& which) const
{
    std::vector<ImageWithoutTarget> images;
    for (int i : which)
        images.push_back({paths_[i], results_[i].other});
    std::sort(images.begin(), images.end(), [](const ImageWithoutTarget& a, const ImageWithoutTarget& b) { return a.path < b.path; });
    throw Failure(explainMissing(images, "'" + source_ + "'", paths_.size(), target_, channel_));
}

void TargetSearch::begin(Progress& progress)
{
    const std::vector<int> order = spread((int)paths_.size()), first = part(order, 0, FIRST);
    search(first, progress);
    const auto isFound = [this](int i) { return !results_[i].points.empty(); };
    if (first.empty() || std::any_of(first.begin(), first.end(), isFound))
        return;
    std::vector<ImageWithoutTarget> images;
    for (int i : first)
        images.push_back({paths_[i], results_[i].other});
    if (first.size() > 1 && !otherChessboard(images).empty())
        refuse(first);
    if (paths_.size() <= FIRST)
        refuse(first);
    if (isLikelyInAny(part(order, FIRST, GLANCES), progress))
        return;
    lookForOthers(part(order, FIRST, EXPLAINING));
    refuse(part(order, 0, EXPLAINING));
}

std::vector<std::vector<cv::Point2d>> TargetSearch::finish(Progress& progress)
{
    std::vector<int> left;
    for (size_t i = 0; i < paths_.size(); i++)
        if (!results_[i].done)
            left.push_back((int)i);
    search(left, progress);
    std::vector<std::vector<cv::Point2d>> points;
    bool any = false;
    for (const Result& result : results_)
    {
        points.push_back(result.points);
        any = any || !result.points.empty();
    }
    if (!any)
        refuse(part(spread((int)paths_.size()), 0, EXPLAINING));
    return points;
}

} // namespace tools
