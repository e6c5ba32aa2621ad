// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/leftovers.hpp"

#include <signal.h>
#include <unistd.h>
#include <atomic>
#include <cstdlib>
#include <cstring>

namespace tools {

namespace {

// A signal handler may neither lock nor allocate: names wait here.
const int SLOTS = 256;
std::atomic<char*> names[SLOTS];

const int SIGNALS[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE};

void removeAndEnd(int signalNumber)
{
    char* taken[SLOTS];
    for (int i = 0; i < SLOTS; i++)
        taken[i] = names[i].exchange(nullptr);
    for (char* name : taken)            // files first, so that their folders are empty
        if (name)
            unlink(name);
    for (char* name : taken)
        if (name)
            rmdir(name);
    raise(signalNumber);                // its usual action again, so that the caller learns of it
}

} // namespace

Leftover::Leftover(const std::string& path) : slot_(-1)
{
    char* const name = strdup(path.c_str());
    for (int i = 0; name && i < SLOTS; i++)
    {
        char* none = nullptr;
        if (names[i].compare_exchange_strong(none, name))
        {
            slot_ = i;
            return;
        }
    }
    free(name);
}

Leftover::~Leftover()
{
    if (slot_ >= 0)
        free(names[slot_].exchange(nullptr));
}

void removeLeftoversOnSignals()
{
    struct sigaction action = {};
    action.sa_handler = removeAndEnd;
    action.sa_flags = (int)(SA_RESETHAND | SA_NODEFER);
    for (int signalNumber : SIGNALS)
    {
        struct sigaction old = {};
        sigaction(signalNumber, nullptr, &old);
        if (old.sa_handler == SIG_DFL)
            sigaction(signalNumber, &action, nullptr);
    }
}

void leaveLeftoversToParent()
{
    for (int signalNumber : SIGNALS)
    {
        struct sigaction old = {};
        sigaction(signalNumber, nullptr, &old);
        if (old.sa_handler == removeAndEnd)
            signal(signalNumber, SIG_DFL);
    }
}

} // namespace tools
