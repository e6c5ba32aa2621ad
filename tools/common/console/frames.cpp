// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/frames.hpp"
#include "console/failure.hpp"
#include "console/images.hpp"
#include "console/view_names.hpp"

#include <opencv2/core/utils/logger.hpp>
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <map>

namespace tools {

namespace fs = std::filesystem;

namespace {

//! A name with a number in it: %d, %4d or %04d; the last of several.
struct NumberedName
{
    std::string before, after;
    size_t digits;                      //!< at least
};

bool readNumberedName(const std::string& pattern, NumberedName& name)
{
    for (size_t at = pattern.rfind('%'); at != std::string::npos; at = at ? pattern.rfind('%', at - 1) : std::string::npos)
    {
        const size_t end = pattern.find_first_not_of("0123456789", at + 1), most = 2;
        if (end == std::string::npos || pattern[end] != 'd')
            continue;
        const size_t first = at + 1 + (pattern[at + 1] == '0');
        if (end - first > most)
            continue;
        const std::string digits = pattern.substr(first, end - first);
        name = {pattern.substr(0, at), pattern.substr(end + 1), digits.empty() ? 1 : std::max<size_t>(1, std::stoul(digits))};
        return true;
    }
    return false;
}

//! left%04d.png is every file left NUMBER .png whose number has four digits or more; in the order of numbers.
bool findNumbered(const std::string& source, std::vector<std::string>& files, std::vector<long>& numbers)
{
    NumberedName named;
    if (fs::exists(source) || !readNumberedName(fs::path(source).filename().string(), named))
        return false;
    const fs::path folder = fs::path(source).has_parent_path() ? fs::path(source).parent_path() : fs::path(".");
    const std::string &before = named.before, &after = named.after;
    const size_t digits = named.digits, most = 9;
    std::map<long, std::string> found;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    {
        const std::string name = entry->path().filename().string();
        if (name.size() < before.size() + after.size() + digits || name.compare(0, before.size(), before) != 0
            || name.compare(name.size() - after.size(), after.size(), after) != 0)
            continue;
        const std::string middle = name.substr(before.size(), name.size() - before.size() - after.size());
        if (middle.size() <= std::min<size_t>(18, std::max(most, digits)) && std::all_of(middle.begin(), middle.end(), [](unsigned char c) {
                return std::isdigit(c); }) && (middle.size() == digits || middle[0] != '0'))
            found[std::stol(middle)] = (fs::path(source).parent_path()/name).string();
    }
    for (const auto& file : found)
    {
        numbers.push_back(file.first);
        files.push_back(file.second);
    }
    if (files.empty())
        throw Failure("no file matches '" + source + "': %d stands for the number, as in left%04d.png for left0012.png");
    return true;
}

std::map<std::string, int> indexOf(const std::vector<std::string>& names, const Frames& frames)
{
    std::map<std::string, int> index;
    for (int i = 0; i < frames.size(); i++)
        if (!index.insert({names[i], i}).second)
            throw Failure("two images of '" + frames.source() + "' are called '" + names[i] + "': give each a name of its "
                          "own, as images of one moment are found by equal names");
    return index;
}

void refuseOneFile(const std::string& first, const std::string& second)
{
    std::error_code ignored;
    if (fs::equivalent(first, second, ignored))
        throw Failure("'" + first + "' is given for both cameras: name an image of each");
}

//! Numbers count from 1 in both, so that a frame more or less shifts all that follow.
void requireEqualLength(const Frames& first, const Frames& second)
{
    if (first.isVideo() && second.isVideo() && first.size() != second.size())
        throw Failure(cv::format("'%s' and '%s' have different numbers of frames, %d and %d: cut them so that equal numbers "
                                 "are of one moment",
                                 first.source().c_str(), second.source().c_str(), first.size(), second.size()));
}

} // namespace

Frames::Frames(const std::string& source, const std::string& viewPattern) : source_(source), viewPattern_(viewPattern)
{
    if (findNumbered(source, files_, numbers_))
        return;
    files_ = expandGlob(source);
    if (!isNamedAsVideo(files_[0]))
        return;
    if (files_.size() > 1)
        throw Failure("'" + source + "' are several videos: give one at a time");
    source_ = files_[0];
    files_.clear();
    // Decoders' remarks about a file that is none, or is cut, are not for users.
    setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    open();
    while (video_.grab())       // what files say of their length is not always true
        count_++;
    if (count_ == 0)
        throw Failure("'" + source_ + "' has no frame that can be read: is it complete?");
    open();
}

void Frames::open()
{
    video_.release();
    if (!video_.open(source_))
        throw Failure("'" + source_ + "' is not a video that can be read: is it complete? If so, turn it into images or into an "
                      ".avi with MJPG");
    video_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);       // as the sensor saw it: the lens does not turn
    next_ = 0;
}

std::string Frames::stem(int i) const
{
    if (!numbered())
        return stemOf(files_[i]);
    return cv::format("frame%06ld", isVideo() ? i + 1L : numbers_[i]);
}

//! Of a video or of numbered images their number.
std::vector<std::string> Frames::moments() const
{
    if (hasPattern())
        return momentsByPattern(files_, viewPattern_);
    if (!numbered())
        return viewNames(files_);
    std::vector<std::string> names;
    for (int i = 0; i < size(); i++)
        names.push_back(stem(i));
    return names;
}

std::string Frames::name(int i) const
{
    return isVideo() ? source_ + cv::format(", frame %d", i + 1) : files_[i];
}

cv::Mat Frames::read(int i, bool withAlpha)
{
    return isVideo() ? readVideo(i) : readImage(files_[i], withAlpha);
}

cv::Mat Frames::readVideo(int i)
{
    if (i < next_)
        open();
    cv::Mat image;
    bool read = true;
    for (; read && next_ < i; next_++)
        read = video_.grab();
    read = read && video_.read(image);
    next_++;
    if (!read || image.empty())
        throw Failure("'" + source_ + cv::format("': frame %d cannot be read", i + 1));
    return image.clone();       // the next one may take its place
}

std::vector<Moment> momentsOf(const std::vector<const Frames*>& cameras)
{
    const int count = (int)cameras.size();
    std::map<std::string, std::vector<int>> byStem;
    std::vector<std::vector<std::string>> names;
    for (const Frames* frames : cameras)
        names.push_back(frames->moments());
    if (std::none_of(cameras.begin(), cameras.end(), [](const Frames* frames) { return frames->hasPattern(); }))
        takeOffCameras(names);          // a pattern says what the moment is
    for (int c = 0; c < count; c++)
    {
        for (int k = 0; k < c; k++)
        {
            if (cameras[k]->isVideo() && cameras[c]->isVideo())
                refuseOneFile(cameras[k]->source(), cameras[c]->source());
            requireEqualLength(*cameras[k], *cameras[c]);
        }
        for (const auto& image : indexOf(names[c], *cameras[c]))
            byStem.insert({image.first, std::vector<int>(count, -1)}).first->second[c] = image.second;
    }
    std::vector<Moment> moments;
    for (const auto& moment : byStem)
        moments.push_back({moment.first, moment.second});
    for (const Moment& moment : moments)
        for (int c = 0; c < count; c++)
            for (int k = 0; k < c; k++)
                if (moment.frames[c] >= 0 && moment.frames[k] >= 0 && !cameras[c]->isVideo() && !cameras[k]->isVideo())
                    refuseOneFile(cameras[k]->files()[moment.frames[k]], cameras[c]->files()[moment.frames[c]]);
    return moments;
}

FramePairs pairsOf(const Frames& first, const Frames& second)
{
    FramePairs result;
    for (const Moment& moment : momentsOf({&first, &second}))
        if (moment.frames[1] < 0)
            result.unpaired1.push_back(moment.stem);
        else if (moment.frames[0] < 0)
            result.unpaired2.push_back(moment.stem);
        else
            result.pairs.push_back({moment.stem, moment.frames[0], moment.frames[1]});
    if (result.pairs.empty())
        throw Failure("no image of '" + first.source() + "' has the name of one of '" + second.source()
                      + "': images of one moment need equal names");
    return result;
}

double whiteOf(const cv::Mat& image)
{
    double largest = 255;
    if (image.depth() != CV_8U)
        cv::minMaxLoc(image.reshape(1), nullptr, &largest);
    return largest;
}

void makeEightBit(cv::Mat& image, double white)
{
    if (image.depth() != CV_8U)
        image.convertTo(image, CV_8U, white > 0 ? 255./white : 1.);
}

void makeEightBit(cv::Mat& image1, cv::Mat& image2)
{
    const double white = std::max(whiteOf(image1), whiteOf(image2));
    makeEightBit(image1, white);
    makeEightBit(image2, white);
}

} // namespace tools
