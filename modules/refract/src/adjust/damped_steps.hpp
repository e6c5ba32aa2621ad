// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_DAMPED_STEPS_HPP
#define OPENCV_REFRACT_DAMPED_STEPS_HPP

#include "adjust/reduced_cost.hpp"

namespace cv { namespace refract {

/** Levenberg's and Marquardt's steps on a scene's reduced cost, by the sparse factor of its equations: Ceres would form them again from
their root. */
struct DampedSteps
{
    double equations;       //!< how many there are
    double change;          //!< of the cost, relative, that ends them
    double damping;         //!< of the first step; out: of the next
    int iterations;         //!< at most; out: how many were made
    bool isConverged;       //!< out: the last would not change the cost by more
    double leastGain = 0;   //!< of the cost, relative: less is worth no step; 0: down to what cannot matter
    double rounding = 1e-12;        //!< of a residual, pixels

    //! What rounding changes of so many squares, and points leave that are optimised by themselves.
    static double unseenOf(double squares, double equations, double rounding);
    //! From the state of the cost, which was linearised there. The state is where they end.
    void run(ReducedCost& cost);
};

}} // namespace

#endif // OPENCV_REFRACT_DAMPED_STEPS_HPP
