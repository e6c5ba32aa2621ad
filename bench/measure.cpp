// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <sched.h>
#include <time.h>

static std::atomic<long> allocationCount;

// glibc's own names of what is replaced here, to count heap allocations.
extern "C" {
void* __libc_malloc(size_t);
void* __libc_memalign(size_t, size_t);
void* malloc(size_t size) { ++allocationCount; return __libc_malloc(size); }
int posix_memalign(void** p, size_t alignment, size_t size)
{
    allocationCount++;
    *p = __libc_memalign(alignment, size);
    return *p ? 0 : 12;
}
}

namespace bench {

long allocations() { return allocationCount; }

void pin(int processors)
{
    cpu_set_t set;
    CPU_ZERO(&set);
    for (int i = 0; i < processors; i++)
        CPU_SET(i, &set);
    sched_setaffinity(0, sizeof set, &set);
}

static double now(clockid_t clock)
{
    timespec t;
    clock_gettime(clock, &t);
    return t.tv_sec + 1e-9*t.tv_nsec;
}

double processorSeconds() { return now(CLOCK_PROCESS_CPUTIME_ID); }

//! Seconds of one run, from as many as fill the time.
static double seconds(const Work& work, clockid_t clock, double least = 2e-3)
{
    if (!work)
        return std::numeric_limits<double>::quiet_NaN();
    const double start = now(clock);
    double total = 0;
    int runs = 0;
    do
    {
        work();
        runs++;
        total = now(clock) - start;
    } while (total < least);
    return total/runs;
}

static double median(std::vector<double> v)
{
    std::sort(v.begin(), v.end());
    return v.size() % 2 ? v[v.size()/2] : 0.5*(v[v.size()/2 - 1] + v[v.size()/2]);
}

double medianSeconds(const Work& work, int rounds)
{
    std::vector<double> times;
    work();
    for (int round = 0; round < rounds; round++)
        times.push_back(seconds(work, CLOCK_THREAD_CPUTIME_ID));
    return median(times);
}

//! Reading and writing as many bytes as the row does, and nothing else.
static Work memoryWork(double bytes)
{
    if (bytes <= 0)
        return Work();
    auto from = std::make_shared<std::vector<char> >((size_t)(bytes/2), 1);
    auto to = std::make_shared<std::vector<char> >(from->size());
    return [=] { std::memcpy(to->data(), from->data(), from->size()); };
}

Times measure(const Row& row, int rounds)
{
    const Work memory = memoryWork(row.bytes*row.count);
    const int MEMORY = 4;
    const Work* works[] = { &row.ours, &row.peer, &row.scalar, &row.mrcal, &memory };
    const clockid_t clock = row.threads ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID;
    std::vector<double> times[5], ratio;
    for (const Work* work : works)      // first touch, tables, thread pools
        if (*work)
            (*work)();
    for (int round = 0; round < rounds; round++)
    {
        for (int k = 0; k < 5; k++)
            times[k].push_back(seconds(*works[k], clock, k == MEMORY ? 0 : 2e-3));     // a copy that runs again is of the cache
        ratio.push_back(times[0].back()/times[1].back());
    }
    const auto perPoint = [&](int k) { return *works[k] ? median(times[k])/row.count*1e9 : times[k][0]; };
    return { perPoint(0), perPoint(1), perPoint(2), perPoint(3), perPoint(4), median(ratio) };
}

} // namespace bench
