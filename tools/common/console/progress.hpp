// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PROGRESS_HPP
#define REFRACT_TOOLS_PROGRESS_HPP

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace tools {

/* How far the work is and what it is at, on stderr: on a terminal one line that counts up, after a second; elsewhere a line
"... what 3/40: name" every five seconds. */
class Progress
{
public:
    Progress(const std::string& what, int total, bool quiet);
    ~Progress();                            //!< clears the line
    void at(const std::string& name);       //!< what is begun now, a file say; may be called from any thread
    void step();                            //!< one more is done; may be called from any thread
private:
    void show();                            // runs in a thread of its own, as one step may take long
    std::string text() const;

    const std::string what_;
    const int total_;
    const bool terminal_;
    int done_ = 0;
    std::string name_;
    bool ended_ = false;
    std::mutex mutex_;
    std::condition_variable end_;
    std::thread thread_;
};

//! Calls for 0 to count - 1, on all processors; the first error in that order is thrown.
void inParallel(int count, const std::function<void(int)>& call);

} // namespace tools

#endif // REFRACT_TOOLS_PROGRESS_HPP
