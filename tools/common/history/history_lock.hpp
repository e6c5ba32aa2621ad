// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_HISTORY_LOCK_HPP
#define REFRACT_TOOLS_HISTORY_LOCK_HPP

#include "console/file_lock.hpp"

namespace tools {

/** While it lives, no other check of this history is between reading and writing it: one of two at once would be lost. Waits for the
other; its file, FILE.lock, goes with the last of them. Throws Failure if the other takes too long. */
class HistoryLock
{
public:
    explicit HistoryLock(const std::string& history);

private:
    std::unique_ptr<FileLock> lock_;
};

} // namespace tools

#endif // REFRACT_TOOLS_HISTORY_LOCK_HPP
