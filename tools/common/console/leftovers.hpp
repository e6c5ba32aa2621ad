// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LEFTOVERS_HPP
#define REFRACT_TOOLS_LEFTOVERS_HPP

#include <string>

/* Temporary files that must not outlive the tool, whatever ends it: destructors remove them after an exception, but not after Ctrl-C, a
kill, or a pipe that nobody reads any more. */
namespace tools {

//! While it lives, a signal that ends the tool removes the file or the empty folder. It need not be there yet.
class Leftover
{
public:
    explicit Leftover(const std::string& path);
    ~Leftover();
    Leftover(const Leftover&) = delete;
    Leftover& operator=(const Leftover&) = delete;
private:
    int slot_;          //!< -1: all are taken
};

//! From now on; SIGINT, SIGTERM, SIGHUP and SIGPIPE then end the tool as before. One that the caller ignores stays ignored.
void removeLeftoversOnSignals();

//! Of a child process, which must not remove what is its parent's.
void leaveLeftoversToParent();

} // namespace tools

#endif // REFRACT_TOOLS_LEFTOVERS_HPP
