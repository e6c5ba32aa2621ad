// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/live_pairs.hpp"
#include "console/images.hpp"
#include <opencv2/core.hpp>
#include <algorithm>

namespace tools {

namespace fs = std::filesystem;

const auto PATIENCE = std::chrono::seconds(2);          // with a file that cannot be read: it may still be written

bool NewFiles::isDone(const std::string& path, const State& state) const
{
    const auto found = files_.find(path);
    return found != files_.end() && found->second.done && (found->second.useful || found->second.state == state);
}

std::string NewFiles::next()
{
    pending_ = false;
    for (const std::string& path : matchingFiles(pattern_))
    {
        std::error_code gone;
        const State state = {fs::file_size(path, gone), gone ? fs::file_time_type() : fs::last_write_time(path, gone)};
        if (gone || isDone(path, state))
            continue;
        pending_ = true;
        const auto known = files_.find(path);
        if (known != files_.end() && !known->second.done && known->second.state == state)
            return path;
        files_[path] = {state, Clock::now(), false, false};
    }
    return "";
}

void NewFiles::finish(const std::string& path, bool useful)
{
    files_.at(path).done = true;
    files_.at(path).useful = useful;
}

bool NewFiles::isNew(const std::string& path) const
{
    return Clock::now() - files_.at(path).since < PATIENCE;
}

std::string nameOf(const LivePlace& place, int cameras)
{
    return (cameras > 1 ? cv::format("camera %d, ", place.camera + 1) : "") + (place.glass ? "glass" : "direct");
}

LivePairs::LivePairs(const std::vector<LivePlace>& places, bool unpaired) : places_(places)
{
    bool kinds[2] = {false, false};
    for (const LivePlace& place : places)
    {
        kinds[place.glass] = true;
        cameras_ = std::max(cameras_, place.camera + 1);
    }
    pairs_ = !unpaired && kinds[0] && kinds[1];
}

std::vector<size_t> LivePairs::expected(const Images& images) const
{
    bool came[2] = {false, false};
    for (size_t i = 0; i < places_.size(); i++)
        came[places_[i].glass] = came[places_[i].glass] || images[i] != NONE;
    std::vector<size_t> places;
    for (size_t i = 0; i < places_.size(); i++)
        if (came[places_[i].glass] || (pairs_ && came[1]))
            places.push_back(i);
    return places;
}

//! "camera 2's glass image"; empty: nothing.
std::string LivePairs::missing(const Images& images) const
{
    std::string text;
    for (size_t i : expected(images))
        if (images[i] != FOUND)
            text += (text.empty() ? "" : " and ") + (cameras_ > 1 ? cv::format("camera %d's ", places_[i].camera + 1) : "its ")
                    + (places_[i].glass ? "glass image" : "direct image")
                    + (images[i] == WITHOUT_TARGET ? " (the board was not found in it: take it again)" : "");
    return text;
}

std::string LivePairs::add(const std::string& stem, size_t place, bool found)
{
    if (!areAny())
        return "";
    Images& images = images_.emplace(std::make_pair(stem, !pairs_ && places_[place].glass), Images(places_.size(), NONE)).first->second;
    const bool wasComplete = images[place] == FOUND;
    images[place] = found ? FOUND : WITHOUT_TARGET;
    const std::vector<size_t> all = expected(images);
    const std::string gaps = missing(images);
    if (!gaps.empty())
        return "'" + stem + "' waits for " + gaps;
    const bool onlyDirect = std::none_of(all.begin(), all.end(), [&](size_t i) { return places_[i].glass; });
    const std::string by = cameras_ > 1 && all.size() > 1 ? " of all cameras" : "";
    if (onlyDirect && pairs_)
        return "'" + stem + "'" + (by.empty() ? "" : " is complete" + by + ";") + " is for the lens, or waits for its glass image";
    complete_ += !wasComplete;
    return (pairs_ ? cv::format("pair %d complete: '", complete_) : cv::format("view %d complete: '", complete_)) + stem + "'"
           + (pairs_ ? ", direct and glass" : "") + by;
}

std::vector<std::string> LivePairs::incomplete() const
{
    std::vector<std::string> sentences;
    for (const auto& entry : images_)
        if (!missing(entry.second).empty())
            sentences.push_back("'" + entry.first.first + "' lacks " + missing(entry.second));
    return sentences;
}

} // namespace tools
