// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/new_files.hpp"
#include "console/images.hpp"

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

} // namespace tools
