// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_BENCH_GROWTH_HPP
#define REFRACT_BENCH_GROWTH_HPP

namespace bench {

//! Tables of time against points, layers, incidence and views, one thread.
void printGrowth();

} // namespace bench

#endif // REFRACT_BENCH_GROWTH_HPP
