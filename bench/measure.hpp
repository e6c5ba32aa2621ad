// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// One row of the table: ours and its peers, run alternately in one process on one pinned thread.
#ifndef REFRACT_BENCH_MEASURE_HPP
#define REFRACT_BENCH_MEASURE_HPP

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace bench {

typedef std::function<void()> Work;

struct Row
{
    std::string key, work, peerName;
    double target[2];           //!< ratio to reach with AVX-512 and with AVX2; 0 = none
    int count;                  //!< points (curves, pixels, calls) in one run
    Work ours, peer;
    Work scalar, mrcal;         //!< may be empty
    double bytes;               //!< read and written per point, for the memory floor; 0 = none
    std::string unit;           //!< of the error
    double tolerance;           //!< largest error that is right
    //! Largest error and number of answers, of what `ours` and `peer` left behind.
    std::function<double()> error, peerError;
    std::function<int()> successes;
    bool threads = false;       //!< measure by the clock, not by this thread's processor time
};

struct Times { double ours, peer, scalar, mrcal, memory, ratio; };     //!< ns per point, medians; NaN = not measured

/** Processor time of this thread: what else runs on the machine does not count. The ratio is the median of the rounds'
ratios; a round runs ours, peer, scalar, mrcal, memory one after the other. */
Times measure(const Row& row, int rounds);

//! Processor time of one run after the first, median of rounds.
double medianSeconds(const Work& work, int rounds);

//! Of all threads of this process so far: what else runs on the machine does not count.
double processorSeconds();

//! Keeps the process on the given number of processors.
void pin(int processors);

//! Heap allocations of this process so far.
long allocations();

} // namespace bench

#endif // REFRACT_BENCH_MEASURE_HPP
