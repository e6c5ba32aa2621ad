#ifndef REFRACT_TOOLS_PROGRESS_HPP
#define REFRACT_TOOLS_PROGRESS_HPP

#include <chrono>
#include <mutex>
#include <string>

namespace tools {

//! One line on stderr that counts up; only on a terminal, and only if the work takes longer than a second.
class Progress
{
public:
    Progress(const std::string& what, int total, bool quiet);
    ~Progress();                //!< clears the line
    void step();                //!< one more is done; may be called from any thread
private:
    std::string what_;
    int total_, done_ = 0;
    bool enabled_, shown_ = false;
    std::chrono::steady_clock::time_point start_, last_;
    std::mutex mutex_;
};

} // namespace tools

#endif // REFRACT_TOOLS_PROGRESS_HPP
