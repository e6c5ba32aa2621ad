#include "progress.hpp"

#include <unistd.h>
#include <cstdio>

namespace tools {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

Progress::Progress(const std::string& what, int total, bool quiet)
    : what_(what), total_(total), enabled_(!quiet && isatty(STDERR_FILENO)),
      start_(steady_clock::now()), last_(start_)
{
}

Progress::~Progress()
{
    if (shown_)
        fprintf(stderr, "\r\033[K");
}

void Progress::step()
{
    const std::lock_guard<std::mutex> lock(mutex_);
    ++done_;
    const auto now = steady_clock::now();
    if (!enabled_ || now - start_ < milliseconds(1000) || (shown_ && now - last_ < milliseconds(100)))
        return;
    fprintf(stderr, "\r\033[K%s %d/%d", what_.c_str(), done_, total_);
    fflush(stderr);
    last_ = now;
    shown_ = true;
}

} // namespace tools
