// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LIVE_PAIRS_HPP
#define REFRACT_TOOLS_LIVE_PAIRS_HPP

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tools {

/* The files of a glob as they arrive, each once it is complete. One that was of no use comes again when it is written anew. */
class NewFiles
{
public:
    using Clock = std::chrono::steady_clock;

    explicit NewFiles(const std::string& pattern) : pattern_(pattern) {}

    //! The next one that has not changed since the last call; empty: there is none.
    std::string next();
    //! Some have been seen that are not done with.
    bool arePending() const { return pending_; }
    //! It is done with.
    void finish(const std::string& path, bool useful);
    //! It has changed a short time ago, and may still be written.
    bool isNew(const std::string& path) const;
    const std::string& pattern() const { return pattern_; }

private:
    struct State
    {
        std::uintmax_t size;
        std::filesystem::file_time_type time;
        bool operator==(const State& other) const { return size == other.size && time == other.time; }
    };
    struct File
    {
        State state;
        Clock::time_point since;
        bool done, useful;
    };
    bool isDone(const std::string& path, const State& state) const;

    std::string pattern_;
    bool pending_ = false;
    std::map<std::string, File> files_;
};

//! Where images come: one camera, without or through its window.
struct LivePlace
{
    int camera;
    bool glass;
};

//! "camera 2, glass"; of a single camera "glass".
std::string nameOf(const LivePlace& place, int cameras);

/* Which images of one name belong together and are there: the direct and the glass image of a pair, and those of one moment of all cameras.
A direct image may stay alone, for the lens; as soon as there is a glass image of its name, all places are waited for. */
class LivePairs
{
public:
    //! @param places that are watched  @param unpaired equal names of direct and glass images mean nothing
    LivePairs(const std::vector<LivePlace>& places, bool unpaired);

    //! An image came. Says what is complete or waited for; empty: nothing is. @param found the target in it
    std::string add(const std::string& stem, size_t place, bool found);

    //! Names of which all images show the target.
    int complete() const { return complete_; }
    //! False if no image belongs to another: places of one kind of one camera.
    bool areAny() const { return places_.size() > 1 && (pairs_ || cameras_ > 1); }
    bool arePairs() const { return pairs_; }    //!< of direct and glass images
    //! What is still waited for at the end, a sentence each.
    std::vector<std::string> incomplete() const;

private:
    enum Image { NONE, WITHOUT_TARGET, FOUND };
    using Images = std::vector<Image>;          // of each place

    std::vector<size_t> expected(const Images& images) const;
    std::string missing(const Images& images) const;

    std::vector<LivePlace> places_;
    bool pairs_ = false;                        //!< of a direct and a glass image
    int cameras_ = 1, complete_ = 0;
    std::map<std::pair<std::string, bool>, Images> images_;     //!< by name; unpaired: by name and kind
};

} // namespace tools

#endif // REFRACT_TOOLS_LIVE_PAIRS_HPP
