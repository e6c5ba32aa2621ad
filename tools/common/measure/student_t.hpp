// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_STUDENT_T_HPP
#define REFRACT_TOOLS_STUDENT_T_HPP

/* Expanded uncertainty with few degrees of freedom (GUM, JCGM 100:2008, annex G). */
namespace tools {

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

#endif // REFRACT_TOOLS_STUDENT_T_HPP
