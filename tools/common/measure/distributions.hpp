// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DISTRIBUTIONS_HPP
#define REFRACT_TOOLS_DISTRIBUTIONS_HPP

/* Tails and quantiles of chi^2, F and Student's t. */
namespace tools {

//! P(chi^2 > x) of so many degrees of freedom, a finite sum; 1 for x <= 0.
double upperTailChiSquared(int dof, double x);

//! Its logarithm, where it is too small for a number, too.
double logUpperTailChiSquared(int dof, double x);

//! The z-score that is as rare, both tails taken: P(|z| > score) = P(chi^2 > x). The root of x for one degree of freedom.
double zScoreOfChiSquared(int dof, double x);

/** P(F > x) with 2m and v degrees of freedom, a finite sum:

    P(F > x) = w^(v/2) sum over j < m of (v/2)_j / j! (1 - w)^j,     w = 1 / (1 + 2 m x / v)

for m = 1 it is (1 + 2 x / v)^(-v/2). */
double upperTailF(int m, double v, double x);

/** The same with any number of numerator degrees of freedom. An odd one begins with that of one, Student's t, by Wallace's normal
approximation (Annals of Mathematical Statistics 30, 1959), and goes on as the sum does: within 1e-3 of itself from v = 20 on. */
double upperTailAnyF(int k, double v, double x);

//! The x that F with k and v degrees of freedom exceeds with this probability.
double quantileF(int k, double v, double probability);

//! The same as upperTailAnyF where the numerator has the noncentrality lambda.
double upperTailNoncentralF(int k, double v, double lambda, double x);

/* Expanded uncertainty with few degrees of freedom (GUM, JCGM 100:2008, annex G). */

const double COVERAGE = 0.9545;         // of two standard deviations of a normal law, as EA-4/02 has it

//! P(|t| <= x) with so many degrees of freedom; infinity: the normal law.
double withinStudentT(double x, double dof);

/** The factor k that covers a share of Student's t: 2 for COVERAGE and infinitely many degrees of freedom. As the GUM (G.4.1) has
it, what is after the decimal point of dof is left out; below 1 there is no answer but infinity. */
double coverageFactor(double dof, double coverage = COVERAGE);

/** Effective degrees of freedom (Welch and Satterthwaite) of a sum of a part with so many of them and one with infinitely many.
@param total variance @param part of it that has dof */
double effectiveDof(double total, double part, double dof);

} // namespace tools

#endif // REFRACT_TOOLS_DISTRIBUTIONS_HPP
