// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "history/history_lock.hpp"
#include "console/failure.hpp"
#include <chrono>
#include <thread>

namespace tools {

HistoryLock::HistoryLock(const std::string& history)
{
    const int SECONDS = 300, TRIES_A_SECOND = 10;
    for (int i = 0; i < SECONDS*TRIES_A_SECOND; i++)
    {
        lock_ = FileLock::tryOnce(history + ".lock");
        if (lock_)
            return;
        std::this_thread::sleep_for(std::chrono::milliseconds(1000/TRIES_A_SECOND));
    }
    throw Failure("another check has kept '" + history + "' for " + std::to_string(SECONDS/60) + " minutes: wait for it, or end it");
}

} // namespace tools
