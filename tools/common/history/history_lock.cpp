// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "history/history_lock.hpp"
#include "console/failure.hpp"
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace tools {

HistoryLock::HistoryLock(const std::string& history) : file_(history + ".lock")
{
    const int SECONDS = 300, TRIES_A_SECOND = 10;
    for (int i = 0; i < SECONDS*TRIES_A_SECOND; i++)
    {
        if (tryOnce())
            return;
        std::this_thread::sleep_for(std::chrono::milliseconds(1000/TRIES_A_SECOND));
    }
    throw Failure("another check has kept '" + history + "' for " + std::to_string(SECONDS/60) + " minutes: wait for it, or end it");
}

//! The file that was opened must still be the one of that name: the other takes it away with itself.
bool HistoryLock::tryOnce()
{
    descriptor_ = open(file_.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
    if (descriptor_ < 0)
        throw Failure("cannot write '" + file_ + "', which keeps two checks at once apart: " + std::strerror(errno));
    struct stat opened = {}, named = {};
    if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0 && fstat(descriptor_, &opened) == 0 && stat(file_.c_str(), &named) == 0
        && opened.st_ino == named.st_ino)
        return true;
    close(descriptor_);
    descriptor_ = -1;
    return false;
}

HistoryLock::~HistoryLock()
{
    if (descriptor_ < 0)
        return;
    unlink(file_.c_str());
    close(descriptor_);
}

} // namespace tools
