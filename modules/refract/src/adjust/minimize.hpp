// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_MINIMIZE_HPP
#define OPENCV_REFRACT_MINIMIZE_HPP

#include "adjust/problem.hpp"

namespace cv { namespace refract {

const double FIRST_DAMPING = 1e-4;       //!< as Ceres'

/** The least squares near where the problem is.
@return CONVERGED where the step that is left is far below what the noise does; MAX_ITERATIONS where criteria.maxCount
iterations, or all that moved anything, did not come there and the criteria ask for it (EPS); or why it cannot begin, as NO_IMAGE.
The problem is where the fit has come to.
@param damping of a scene's first step; out: of the next: who minimises again from there begins with it
@param leastGain of a scene's cost, relative: it ends where a step would gain less, at a minimum or not; 0: not before */
FitOutcome minimize(Problem& problem, const TermCriteria& criteria, double& damping, double leastGain = 0);
FitOutcome minimize(Problem& problem, const TermCriteria& criteria);

}} // namespace

#endif // OPENCV_REFRACT_MINIMIZE_HPP
