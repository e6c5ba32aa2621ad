// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Where the linearised problem foretells the gain, the damping falls fast: along a strip of views the weak ways, its bending, have a
millionth of the information that the views next to each other have, and any damping that is seen by it makes them creep. */

#include "adjust/damped_steps.hpp"
#include <opencv2/core/utils/logger.hpp>

namespace cv { namespace refract {

namespace {

const double LEAST = 1e-18;         // of the damping: the weakest way of a strip of 3000 views has 1e-14 of the strongest's information
const double MOST = 1e16;
const double FIRST_AFTER_FAILURE = 1e-8;
const double LEFT_BY_POINTS = 1e-12;        // of the squares, by steps of their own (StepControl)
const double LEFT_OF_NOISE = 5e-7;          // of the variance; a minimum is where 1e-6 is left, or what is not seen

//! @param ratio of the gain to what was foretold
double dampingAfter(double damping, double ratio)
{
    const double GOOD = 0.9, FAIR = 0.25;
    return std::max(LEAST, damping*(ratio > GOOD ? 1e-2 : ratio > FAIR ? 0.3 : 2));
}

//! Of the squares. @param before where the step begins
double gainThere(ReducedCost& cost, double before)
{
    return cost.optimize() ? before - cost.squaredError() : -std::numeric_limits<double>::infinity();
}

/** Along a curved valley a step goes too far, and a damped one creeps: a part of it gains more than that, and needs no other factor. The
cost is where it ends.
@return the gain; not positive: no part has one to speak of */
double gainOfPart(ReducedCost& cost, const Eigen::VectorXd& step, double before, double foretold)
{
    double gain = 0;
    for (double part : { 0.5, 0.25 })
    {
        cost.restore();
        cost.setStep(part*step);
        gain = gainThere(cost, before);
        if (gain > 0.25*part*(2 - part)*foretold)
            return gain;
    }
    return std::min(gain, 0.);
}

} // namespace

double DampedSteps::unseenOf(double squares, double equations, double rounding)
{
    return 2*rounding*std::sqrt(squares) + rounding*rounding*equations + LEFT_BY_POINTS*squares;
}

void DampedSteps::run(ReducedCost& cost)
{
    const int most = iterations;
    const double WEAK = 1e-6;       // damping that hides nothing
    double growth = 4;              // of the damping: failures in a row make it grow faster
    isConverged = false;
    for (iterations = 0; iterations < most && damping < MOST && cost.linearize(); iterations++)
    {
        const double squares = cost.squaredError();
        double foretold;
        const Eigen::VectorXd step = dampedStep(cost.information(), damping, foretold);
        cost.setStep(step);
        // Too little to matter, or to be seen: of exact data, also of those that were printed with some digits, it is rounding.
        const double unseen = unseenOf(squares, equations, rounding);
        const double negligible = std::max(leastGain, std::min(0.1*change, LEFT_OF_NOISE/equations));
        if (foretold <= std::max(squares*negligible, unseen))
        {
            cost.restore();
            isConverged = damping <= WEAK;
            if (isConverged)
                return;
            damping *= 1e-2;
            continue;
        }
        const double gain = gainThere(cost, squares);
        CV_LOG_INFO(NULL, "refract: squares " << squares << ", damping " << damping << ", gain " << gain << " of " << foretold);
        isConverged = damping <= WEAK && std::abs(gain) <= change*squares;
        if (gain > 1e-3*foretold || (isConverged && gain >= 0))
        {
            damping = dampingAfter(damping, gain/foretold);
            growth = 4;
        }
        else if (!(gainOfPart(cost, step, squares, foretold) > 0))
        {
            cost.restore();
            damping = std::max(FIRST_AFTER_FAILURE, growth*damping);
            growth *= 4;
        }
        if (isConverged)
            return;
    }
}

}} // namespace
