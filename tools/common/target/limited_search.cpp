// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/limited_search.hpp"

#include <signal.h>
#include <sys/mman.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <new>
#include <thread>

namespace tools {

namespace {

//! What the child leaves its parent.
struct Result
{
    size_t count;
    cv::Point2f points[1];      // and on
};

class SharedResult
{
public:
    explicit SharedResult(size_t most) : bytes_(sizeof(Result) + most*sizeof(cv::Point2f))
    {
        memory_ = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        if (memory_ == MAP_FAILED)
            throw std::bad_alloc();
    }
    ~SharedResult() { munmap(memory_, bytes_); }
    SharedResult(const SharedResult&) = delete;
    SharedResult& operator=(const SharedResult&) = delete;
    Result* get() const { return static_cast<Result*>(memory_); }
private:
    size_t bytes_;
    void* memory_;
};

//! The child: only its calling thread is left, so OpenCV must not wait for others.
[[noreturn]] void searchAndEnd(int seconds, size_t most, const std::function<std::vector<cv::Point2f>()>& search, Result* result)
{
    const rlimit processor = {(rlim_t)seconds, (rlim_t)seconds + 1}, none = {0, 0};
    setrlimit(RLIMIT_CPU, &processor);
    setrlimit(RLIMIT_CORE, &none);
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);       // nobody waits for its result any more
#endif
    try
    {
        cv::setNumThreads(1);
        const std::vector<cv::Point2f> points = search();
        result->count = std::min(most, points.size());
        std::copy_n(points.begin(), result->count, result->points);
    }
    catch (...)
    {
        _exit(1);
    }
    _exit(0);
}

//! True if the child came to its end in time.
bool await(pid_t child, int seconds)
{
    using namespace std::chrono;
    const auto end = steady_clock::now() + std::chrono::seconds(seconds);
    for (milliseconds pause(1);; pause = std::min(2*pause, milliseconds(20)))
    {
        int status = 0;
        if (waitpid(child, &status, WNOHANG) != 0)
            return WIFEXITED(status) && WEXITSTATUS(status) == 0;
        if (steady_clock::now() > end)
        {
            kill(child, SIGKILL);
            waitpid(child, &status, 0);
            return false;
        }
        std::this_thread::sleep_for(pause);
    }
}

} // namespace

std::vector<cv::Point2f> searchLimited(int seconds, size_t most, const std::function<std::vector<cv::Point2f>()>& search)
{
    const SharedResult shared(most);
    const pid_t child = fork();
    if (child == 0)
        searchAndEnd(seconds, most, search, shared.get());
    if (child < 0 || !await(child, 4*seconds))
        return {};
    const Result* result = shared.get();
    return std::vector<cv::Point2f>(result->points, result->points + result->count);
}

} // namespace tools
