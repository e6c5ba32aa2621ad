// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/target_search.hpp"
#include "console/failure.hpp"
#include "target/missing_target.hpp"
#include "target/partial_chessboard.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>

namespace tools {

namespace {

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

TargetSearch::TargetSearch(const std::string& source, const std::vector<std::string>& paths, const Target& target, Channel channel)
    : source_(source), paths_(paths), target_(target), channel_(channel), results_(paths.size()) {}

void TargetSearch::search(const std::vector<int>& which, Target::Effort effort, Progress& progress)
{
    // What else may be in an image is asked for only where nothing is found in any.
    const bool isSizeKnown = std::any_of(results_.begin(), results_.end(), [](const Result& result) { return !result.points.empty(); });
    inParallel((int)which.size(), [&](int k) {
        const int i = which[k];
        progress.at(paths_[i]);
        Result& result = results_[i];
        result.points = detectIn(readGrey(paths_[i], channel_), paths_[i], target_, isSizeKnown ? nullptr : &result.other, effort);
        result.done = effort == Target::THOROUGH || !result.points.empty();
        if (result.done)
            progress.step();
    });
}

bool TargetSearch::glimpse(const std::vector<int>& which, Progress& progress)
{
    std::atomic<bool> any(false);
    inParallel((int)which.size(), [&](int k) {
        const int i = which[k];
        progress.at(paths_[i]);
        if (!any && target_.glimpse(readGrey(paths_[i], channel_)))
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
        const cv::Size seen = lookForChessboard(readGrey(paths_[i], channel_)).size, whole = target_.size();
        if (seen != whole && seen != cv::Size(whole.height, whole.width))
            results_[i].other = longerFirst(seen);
    });
}

void TargetSearch::refuse(const std::vector<int>& which) const
{
    std::vector<Without> images;
    for (int i : which)
        images.push_back({paths_[i], results_[i].other});
    std::sort(images.begin(), images.end(), [](const Without& a, const Without& b) { return a.path < b.path; });
    throw Failure(explainMissing(images, "'" + source_ + "'", paths_.size(), target_, channel_));
}

void TargetSearch::begin(Progress& progress)
{
    const std::vector<int> order = spread((int)paths_.size()), first = part(order, 0, FIRST);
    search(first, Target::HURRIED, progress);
    const auto isFound = [this](int i) { return !results_[i].points.empty(); };
    if (first.empty() || std::any_of(first.begin(), first.end(), isFound))
        return;
    std::vector<Without> images;
    for (int i : first)
        images.push_back({paths_[i], results_[i].other});
    if (first.size() > 1 && !otherChessboard(images).empty())
        refuse(first);
    if (paths_.size() <= FIRST)         // all of them: no other images are worth a search before these are
    {
        searchThoroughly(progress);
        if (std::none_of(first.begin(), first.end(), isFound))
            refuse(first);
        return;
    }
    if (glimpse(part(order, FIRST, GLANCES), progress))
        return;
    lookForOthers(part(order, FIRST, EXPLAINING));
    refuse(part(order, 0, EXPLAINING));
}

void TargetSearch::searchThoroughly(Progress& progress)
{
    std::vector<int> left;
    for (size_t i = 0; i < paths_.size(); i++)
        if (!results_[i].done)
            left.push_back((int)i);
    search(left, Target::THOROUGH, progress);
}

std::vector<std::vector<cv::Point2d>> TargetSearch::finish(Progress& progress)
{
    searchThoroughly(progress);
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
