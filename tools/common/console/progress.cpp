// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/progress.hpp"
#include "console/table.hpp"

#include <opencv2/core/utility.hpp>
#include <unistd.h>
#include <chrono>
#include <cstdio>
#include <exception>

namespace tools {

using std::chrono::milliseconds;

Progress::Progress(const std::string& what, int total, bool quiet)
    : what_(what), total_(total), terminal_(isatty(STDERR_FILENO) && takesEscapes())
{
    if (!quiet)
        thread_ = std::thread([this] { show(); });
}

Progress::~Progress()
{
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        ended_ = true;
    }
    end_.notify_one();
    if (thread_.joinable())
        thread_.join();
}

void Progress::at(const std::string& name)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    name_ = name;
}

void Progress::step()
{
    const std::lock_guard<std::mutex> lock(mutex_);
    done_++;
}

std::string Progress::text() const
{
    return what_ + " " + std::to_string(done_) + "/" + std::to_string(total_) + (name_.empty() ? "" : ": " + name_);
}

void Progress::show()
{
    std::unique_lock<std::mutex> lock(mutex_);
    milliseconds wait(terminal_ ? 1000 : 5000);
    bool shown = false;
    while (!end_.wait_for(lock, wait, [this] { return ended_; }))
    {
        fprintf(stderr, terminal_ ? "\r\033[K%s" : "... %s\n", text().c_str());
        fflush(stderr);
        shown = true;
        if (terminal_)
            wait = milliseconds(100);
    }
    if (shown && terminal_)
    {
        fprintf(stderr, "\r\033[K");
        fflush(stderr);
    }
}

void inParallel(int count, const std::function<void(int)>& call)
{
    std::vector<std::exception_ptr> errors(count);
    cv::parallel_for_(cv::Range(0, count), [&](const cv::Range& range) {
        for (int i = range.start; i < range.end; i++)
            try
            {
                call(i);
            }
            catch (...)
            {
                errors[i] = std::current_exception();
            }
    }, (double)count);
    for (const std::exception_ptr& error : errors)
        if (error)
            std::rethrow_exception(error);
}

} // namespace tools
