// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_NEW_FILES_HPP
#define REFRACT_TOOLS_NEW_FILES_HPP

#include <chrono>
#include <filesystem>
#include <map>
#include <string>

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

} // namespace tools

#endif // REFRACT_TOOLS_NEW_FILES_HPP
