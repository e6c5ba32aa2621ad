// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/live_views.hpp"
#include "target/next_view.hpp"

#include "console/cli.hpp"
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <ostream>
#include <set>
#include <thread>

namespace tools {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

const auto STEP = std::chrono::milliseconds(100);
const auto PATIENCE = std::chrono::seconds(2);          // with a file that cannot be read: it may still be written

std::string patternIn(const std::string& folder, const std::vector<std::string>& patterns)
{
    if (!fs::is_directory(folder))
        throw Failure("--watch=" + folder + ": there is no such folder; make it, and let the camera write into it");
    for (const std::string& pattern : patterns)
    {
        const fs::path parent = fs::path(pattern).has_parent_path() ? fs::path(pattern).parent_path() : fs::path(".");
        std::error_code ignored;
        if (!pattern.empty() && fs::equivalent(parent, folder, ignored))
            return pattern;
    }
    throw Failure("--watch=" + folder + ": it is not the folder of --direct or --glass, which say which images of it to take, as in "
                  "--watch=direct --direct='direct/*.png'");
}

//! Files that match and have not been looked at.
class NewFiles
{
public:
    explicit NewFiles(const std::string& pattern) : pattern_(pattern) {}

    //! The next one whose size has not changed since the last call; empty: there is none.
    std::string next()
    {
        pending_ = false;
        for (const std::string& path : matchingFiles(pattern_))
        {
            std::error_code ignored;
            const auto size = fs::file_size(path, ignored);
            if (done_.count(path))
                continue;
            pending_ = true;
            const bool isComplete = sizes_.count(path) && sizes_[path] == size;
            if (!isComplete)
                since_[path] = Clock::now();
            sizes_[path] = size;
            if (isComplete)
                return path;
        }
        return "";
    }
    //! Some have been seen that are not done with.
    bool arePending() const { return pending_; }
    void finish(const std::string& path) { done_.insert(path); }
    //! It has grown a short time ago.
    bool isNew(const std::string& path) const { return Clock::now() - since_.at(path) < PATIENCE; }

private:
    std::string pattern_;
    bool pending_ = false;
    std::set<std::string> done_;
    std::map<std::string, std::uintmax_t> sizes_;
    std::map<std::string, Clock::time_point> since_;
};

//! What became of one image, and of all so far.
class Watcher
{
public:
    Watcher(const Target& target, std::ostream& out) : target_(target), out_(out) {}

    void take(const std::string& name, const cv::Mat& grey)
    {
        if (!views_)
        {
            size_ = grey.size();
            views_ = std::make_unique<NextView>(target_, size_);
        }
        if (grey.size() != size_)
            return say(name, cv::format("%dx%d pixels, the first image has %dx%d: all must have one size", grey.cols, grey.rows,
                                        size_.width, size_.height));
        const std::vector<cv::Point2d> points = target_.detect(grey);
        int found = 0;
        for (const cv::Point2d& p : points)
            found += seen(p);
        if (found)
            views_->add(points);
        say(name, found ? cv::format("board found, %d of %d points", found, target_.count()) : "board not found");
    }
    void say(const std::string& name, const std::string& what)
    {
        const std::string advice = views_ ? views_->advice() : "hold the board into the picture";
        out_ << fs::path(name).filename().string() << ": " << what << cv::format(" (%d so far). Next: ", count())
             << (advice.empty() ? "that is enough, more do no harm" : advice) << std::endl;
    }
    int count() const { return views_ ? views_->count() : 0; }

private:
    const Target& target_;
    std::ostream& out_;
    cv::Size size_;
    std::unique_ptr<NextView> views_;
};

} // namespace

void WatchOptions::addTo(CLI::App& app)
{
    CLI::Option* watch = app.add_option("--watch", folder, "that of --direct or --glass: wait while the camera fills it, say of each "
                                        "image whether the board was found and what the next should show, then calibrate");
    app.add_option("--watch-count", count, "end with so many images that show the board")->needs(watch)->check(CLI::PositiveNumber);
    app.add_option("--watch-quiet", quietSeconds, "end when no image has come for so many seconds")->needs(watch)
        ->check(moreThanZero())->capture_default_str();
}

void watchImages(const WatchOptions& options, const std::vector<std::string>& patterns, const Target& target, Channel channel,
                 std::ostream& out)
{
    const std::string pattern = patternIn(options.folder, patterns);
    NewFiles files(pattern);
    Watcher watcher(target, out);
    out << "Waiting for " << pattern << std::endl;
    const auto quiet = std::chrono::duration<double>(options.quietSeconds);
    for (Clock::time_point last = Clock::now(); ; )
    {
        const std::string path = files.next();
        if (path.empty() && !files.arePending() && Clock::now() - last >= quiet)
            break;
        if (path.empty())
        {
            std::this_thread::sleep_for(STEP);
            continue;
        }
        try
        {
            watcher.take(path, readGrey(path, channel));
        }
        catch (const Failure& e)
        {
            if (files.isNew(path))
            {
                std::this_thread::sleep_for(STEP);
                continue;
            }
            watcher.say(path, std::string(e.what()) + "; take it out of the folder before the watch ends");
        }
        files.finish(path);
        last = Clock::now();
        if (options.count > 0 && watcher.count() >= options.count)
            break;
    }
    out << cv::format("%d images show the board", watcher.count()) << "\n\n";
}

} // namespace tools
