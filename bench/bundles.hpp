// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_BENCH_BUNDLES_HPP
#define REFRACT_BENCH_BUNDLES_HPP

namespace bench {

/** Table of whole bundle adjustments in processor time of all threads: time, memory, how far the windows are from the truth in their
standard deviations. OpenCV has nothing to stand beside them. */
void printBundles();

} // namespace bench

#endif // REFRACT_BENCH_BUNDLES_HPP
