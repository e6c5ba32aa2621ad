// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_F_DISTRIBUTION_HPP
#define REFRACT_TOOLS_F_DISTRIBUTION_HPP

/* The F distribution with an even number of numerator degrees of freedom, where its tail is a finite sum:

    P(F > x) = w^(v/2) sum over j < m of (v/2)_j / j! (1 - w)^j,     w = 1 / (1 + 2 m x / v)

for 2m and v degrees of freedom; for m = 1 it is (1 + 2 x / v)^(-v/2). */
namespace tools {

//! P(F > x) with 2m and v degrees of freedom.
double upperTailF(int m, double v, double x);

/** The same with any number of numerator degrees of freedom. An odd one begins with that of one, Student's t, by Wallace's normal
approximation (Annals of Mathematical Statistics 30, 1959), and goes on as the sum does: within 1e-3 of itself from v = 20 on. */
double upperTailAnyF(int k, double v, double x);

//! The x that F with k and v degrees of freedom exceeds with this probability.
double quantileF(int k, double v, double probability);

//! The same as upperTailAnyF where the numerator has the noncentrality lambda.
double upperTailNoncentralF(int k, double v, double lambda, double x);

} // namespace tools

#endif // REFRACT_TOOLS_F_DISTRIBUTION_HPP
