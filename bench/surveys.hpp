// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_BENCH_SURVEYS_HPP
#define REFRACT_BENCH_SURVEYS_HPP

namespace bench {

/** Table of strips of images of a sea floor through a flat port, adjusted from lists of observations: time, memory, how the time grows
with the views, errors of poses and points against the truth in their stated standard deviations.
@param least views of the shortest strip, @param most of the longest
@param isArea lines side by side in place of a strip */
void printSurveys(int least, int most, bool isArea);

/** Errors against the truth over stated of as many strips with other seeds, through the port and without a window. */
void printManySurveys(int views, int strips);

} // namespace bench

#endif // REFRACT_BENCH_SURVEYS_HPP
