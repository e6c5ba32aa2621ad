// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_BENCH_ARRAYS_HPP
#define REFRACT_BENCH_ARRAYS_HPP

namespace bench {

/** Table of rings of cameras above a tank that look at boards under water through its surface: time, and errors of places and of the
surface against the truth in their stated standard deviations.
@param most cameras of the largest ring, of which each has two and a half times as many boards */
void printArrays(int most);

} // namespace bench

#endif // REFRACT_BENCH_ARRAYS_HPP
