// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/live_rig.hpp"
#include "calibrate/live_pairs.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/options.hpp"
#include "target/board_quality.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <ostream>
#include <thread>

namespace tools {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

const auto STEP = std::chrono::milliseconds(100);

std::string bytesOf(const std::string& path)
{
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
}

//! One source that is watched.
struct WatchedSource
{
    LivePlace place;
    NewFiles files;
    DetectedImages found;
    std::unique_ptr<NextView> views;        //!< null: no image has come
};

bool isIn(const std::string& pattern, const std::string& folder)
{
    const fs::path parent = fs::path(pattern).has_parent_path() ? fs::path(pattern).parent_path() : fs::path(".");
    std::error_code ignored;
    return fs::equivalent(parent, folder, ignored);
}

class RigWatcher
{
public:
    RigWatcher(const WatchOptions& options, const WatchedRig& rig, RigSources& sources, std::ostream& out)
        : options_(options), rig_(rig), out_(out), watched_(takeWatched(options, sources)), cameras_(rig.sources.cameraCount()),
          pairs_(places(), rig.unpaired) {}

    void run()
    {
        for (const WatchedSource& source : watched_)
            out_ << "Waiting for " << source.files.pattern() << std::endl;
        const auto quiet = std::chrono::duration<double>(options_.quietSeconds);
        for (Clock::time_point last = Clock::now(); !isEnough(); )
        {
            bool pending = false, any = false;
            for (size_t i = 0; i < watched_.size() && !isEnough(); i++)
            {
                const std::string path = watched_[i].files.next();
                pending = pending || watched_[i].files.arePending();
                any = (!path.empty() && look(i, path)) || any;
            }
            if (!any && !pending && toAssess_)          // not while other images wait to be looked at
                assess();
            else if (any)
                last = Clock::now();
            else if (!pending && Clock::now() - last >= quiet)
                break;
            else
                std::this_thread::sleep_for(STEP);
        }
        end();
    }

    RigImages images() const
    {
        RigImages sets;
        for (const WatchedSource& source : watched_)
        {
            DetectedImages& set = (source.place.glass ? sets.glass : sets.direct)[source.place.camera];
            set = source.found;
            std::sort(set.images.begin(), set.images.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
            std::sort(set.withoutTarget.begin(), set.withoutTarget.end());
            std::sort(set.files.begin(), set.files.end());
        }
        return sets;
    }

    //! The same; throws Failure if a source has none.
    RigImages imagesWithTarget() const
    {
        for (const WatchedSource& source : watched_)
            if (source.found.files.empty())
                throw Failure("no image has come for '" + source.files.pattern() + "' within --watch-quiet seconds: does the camera write "
                              "into that folder, and under such names?");
            else if (source.found.images.empty())
                throw Failure("no image that came for '" + source.files.pattern() + "' shows the target: check --pattern and --size="
                              + rig_.target.sizeText() + ", light and focus");
        return images();
    }

private:
    static std::vector<WatchedSource> takeWatched(const WatchOptions& options, RigSources& sources)
    {
        std::vector<WatchedSource> watched;
        for (const std::string& folder : options.folders)
            if (!fs::is_directory(folder))
                throw Failure("--watch=" + folder + ": there is no such folder; make it, and let the camera write into it");
        std::vector<char> used(options.folders.size());
        for (int c = 0; c < MAX_CAMERAS; c++)
            for (bool glass : {false, true})
            {
                std::string& source = (glass ? sources.glass : sources.direct)[c];
                bool taken = options.folders.empty() && !source.empty() && !isPointFile(source);
                for (size_t f = 0; f < options.folders.size(); f++)
                    if (!source.empty() && isIn(source, options.folders[f]))
                    {
                        used[f] = true;
                        taken = true;
                    }
                if (!taken)
                    continue;
                requireFolder(source);
                watched.push_back({{c, glass}, NewFiles(source), {}, nullptr});
                source.clear();
            }
        for (size_t f = 0; f < used.size(); f++)
            if (!used[f])
                throw Failure("--watch=" + options.folders[f] + ": it is not the folder of --direct or --glass, which say which images of "
                              "it to take, as in --watch=direct --direct='direct/*.png'; --watch alone takes all of them");
        for (const std::string& source : sources.all())     // the others must be there, which is not to be told at the end
            if (!isPointFile(source))
                expandGlob(source);
        if (watched.empty())
            throw Failure("--watch waits for images, but --direct and --glass name files of points: leave it out");
        return watched;
    }

    static void requireFolder(const std::string& pattern)
    {
        const fs::path folder = fs::path(pattern).parent_path();
        if (!folder.empty() && !fs::is_directory(folder))
            throw Failure("--watch: there is no folder '" + folder.string() + "' for '" + pattern + "': make it, and let the camera write "
                          "into it");
    }

    std::vector<LivePlace> places() const
    {
        std::vector<LivePlace> all;
        for (const WatchedSource& source : watched_)
            all.push_back(source.place);
        return all;
    }

    int count() const
    {
        size_t images = 0;
        for (const WatchedSource& source : watched_)
            images += source.found.images.size();
        return (int)images;
    }

    bool isEnough() const
    {
        return enough_ || (options_.count > 0 && count() >= options_.count)
               || (options_.pairs > 0 && pairs_.complete() >= options_.pairs);
    }

    //! False if the file is to be tried again.
    bool look(size_t i, const std::string& path)
    {
        WatchedSource& source = watched_[i];
        try
        {
            const cv::Mat grey = readGrey(path, rig_.sources.channel);
            requireColour(path, rig_.sources.channel);
            const std::string fault = faultOf(i, path, grey);
            if (fault.empty())
                take(i, path, grey);
            else
                say(source, path, fault + ": left out");
            source.files.finish(path, fault.empty() && isTaken(source, path));
        }
        catch (const Failure& e)
        {
            if (source.files.isNew(path))
                return false;
            say(source, path, std::string(e.what()) + ": left out");
            source.files.finish(path, false);
        }
        return true;
    }

    static bool isTaken(const WatchedSource& source, const std::string& path)
    {
        return std::any_of(source.found.images.begin(), source.found.images.end(), [&](const auto& image) { return image.path == path; });
    }

    //! Why the image cannot be one of these; empty: it can.
    std::string faultOf(size_t i, const std::string& path, const cv::Mat& grey)
    {
        const WatchedSource& source = watched_[i];
        for (const WatchedSource& other : watched_)
            if (other.place.camera == source.place.camera && !other.found.files.empty() && other.found.imageSize != grey.size())
                return cv::format("%dx%d pixels, the first image has %dx%d: all must have one size", grey.cols, grey.rows,
                                  other.found.imageSize.width, other.found.imageSize.height);
        const DetectedImage* const sameName = source.found.find(stemOf(path));
        if (sameName)
            return "'" + sameName->path + "' has the same name: each image needs one of its own";
        const std::string bytes = bytesOf(path);
        const auto copies = contents_.equal_range(std::hash<std::string>()(bytes));
        for (auto copy = copies.first; copy != copies.second; ++copy)
            if (copy->second != path && bytesOf(copy->second) == bytes)
                return "a copy of '" + copy->second + "'";
        contents_.emplace(std::hash<std::string>()(bytes), path);
        return "";
    }

    void take(size_t i, const std::string& path, const cv::Mat& grey)
    {
        WatchedSource& source = watched_[i];
        if (!source.views)
        {
            source.found.imageSize = grey.size();
            source.views = std::make_unique<NextView>(rig_.target, grey.size());
        }
        std::vector<std::string> &files = source.found.files, &without = source.found.withoutTarget;
        if (std::find(files.begin(), files.end(), path) == files.end())
            files.push_back(path);
        without.erase(std::remove(without.begin(), without.end(), path), without.end());
        cv::Size other;
        const std::vector<cv::Point2d> points = rig_.target.detect(grey, &other);
        std::string words = "board not found";
        if (points.empty())
            without.push_back(path);
        if (points.empty() && !other.empty())
            words += cv::format(", of a chessboard %dx%d inner corners are seen", other.width, other.height);
        if (!points.empty())
        {
            source.found.images.push_back({stemOf(path), path, points, {}});
            source.views->add(points);
            const BoardQuality quality = boardQuality(grey, points, rig_.target);
            words = cv::format("board found, %d of %d points, ", source.found.images.back().seenCount(), rig_.target.count())
                    + quality.words() + (quality.complaint().empty() ? "" : "; " + quality.complaint());
        }
        const int before = pairs_.complete();
        const std::string about = pairs_.add(stemOf(path), i, !points.empty());
        say(source, path, words);
        if (!about.empty())
            out_ << "    " << about << std::endl;
        if (!points.empty() && (pairs_.complete() > before || !pairs_.areAny()))
            toAssess_ = (bool)rig_.assess;
    }

    void assess()
    {
        toAssess_ = false;
        const Sufficiency sufficiency = rig_.assess(images());
        if (!sufficiency.words.empty())
            out_ << "    " << sufficiency.words << std::endl;
        enough_ = sufficiency.isEnough;
    }

    void say(const WatchedSource& source, const std::string& path, const std::string& what)
    {
        const std::string where = watched_.size() > 1 ? nameOf(source.place, cameras_) + ", " : "", advice = adviceFor(source);
        out_ << where << fs::path(path).filename().string() << ": " << what
             << cv::format(" (%zu so far). Next: ", source.found.images.size())
             << (advice.empty() ? "that is enough, more do no harm" : advice) << std::endl;
    }

    //! Of direct images the lens asks for coverage; of pairs a few are enough.
    std::string adviceFor(const WatchedSource& source) const
    {
        if (source.place.glass && pairs_.arePairs())
            return pairs_.complete() < ENOUGH_PAIRS ? cv::format("%d more pairs, near and far, each tilted in another way",
                                                                 ENOUGH_PAIRS - pairs_.complete()) : "";
        return source.views ? source.views->advice() : "hold the board into the picture";
    }

    void end()
    {
        for (const std::string& sentence : pairs_.incomplete())
            out_ << sentence << std::endl;
        out_ << cv::format("%d images show the board", count())
             << (pairs_.areAny() ? cv::format(", %d %s complete", pairs_.complete(), pairs_.arePairs() ? "pairs are" : "views are") : "")
             << "\n\n";
    }

    const WatchOptions& options_;
    const WatchedRig& rig_;
    std::ostream& out_;
    std::vector<WatchedSource> watched_;
    int cameras_;
    LivePairs pairs_;
    std::multimap<size_t, std::string> contents_;      //!< hash of a file's bytes -> its path
    bool enough_ = false, toAssess_ = false;
};

} // namespace

void WatchOptions::addTo(OptionParser& parser)
{
    Option watch = parser.addCallback("--watch", [this](const std::vector<std::string>& values) {
        given = true;
        for (const std::string& value : values)
            if (!value.empty() && value != "true")          // --watch alone, and in a settings file
                folders.push_back(value);
    }, "wait while cameras fill the folders of all --direct and --glass, or only this one (repeatable); say of each image whether "
       "the board was found, how sharp it is and what the next should show, then calibrate").mayBeAlone().typeName("[FOLDER]");
    parser.add("--watch-count", count, "end with so many images that show the board").needs(watch).check(isCount());
    parser.add("--watch-pairs", pairs, "end with so many names of which all images have come and show the board").needs(watch)
        .check(isCount());
    parser.add("--watch-quiet", quietSeconds, "end when no image has come for so many seconds").needs(watch)
        .check(moreThanZero()).captureDefault();
}

RigImages watchRig(const WatchOptions& options, const WatchedRig& rig, RigSources& sources, std::ostream& out)
{
    RigWatcher watcher(options, rig, sources, out);
    watcher.run();
    return watcher.imagesWithTarget();
}

} // namespace tools
