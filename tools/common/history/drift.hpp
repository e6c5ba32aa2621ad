// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DRIFT_HPP
#define REFRACT_TOOLS_DRIFT_HPP

#include "history/control_chart.hpp"

/* What a history says about one thing that changes with time: which it is, how fast, when it reaches a limit; and how fast a drift
would be found. */
namespace tools {

const double MONTH = 30.4375*86400.;        // seconds

/** What the estimates of one parameter do: stay, grow steadily from the first check or from some time on, or change at once. All checks
share the calibration's error. */
struct Trend
{
    double perMonth, std;               //!< in the chart's unit; NaN: fewer than three times
    double since, sinceStd;             //!< where it began, in seconds (since 1970); NaN: before the first check
    double step;                        //!< after which check it changed at once, and did not grow; NaN: it did not
    int checksSince;                    //!< that: one does not tell a jump from a drift
    double limit;                       //!< the lasting change that brings the EWMA to its limit, in the chart's unit
    /** When it gets there: the expected time, and one standard deviation of slope and beginning to either side; NaN: the slope is not
    larger than twice its own, or it is after the 22nd century. Seconds since 1970. */
    double reached, earliest, latest;
    int among = 1;                      //!< so many parameters it is looked for in: of twenty one seems to have one by chance

    bool isSignificant() const;
};

//! Estimates of one parameter, each at its time. @param start seconds since 1970, of the first check
Trend trendThrough(const std::vector<double>& months, const VectorXd& value, const MatrixXd& covariance, double limit, double start);
std::vector<Trend> trendsOf(const CheckHistory& history, const MatrixXd& covariance, const std::vector<ChartPoint>& points);

//! Where a change's parameters are in a check; -1: its images do not tell.
int rowOf(const CheckRecord& check, const std::vector<ChartedChange>& changes, int change);
//! A change's own estimate: to multiply the rows of its score with.
MatrixXd inverseOf(const CheckRecord& check, int row, int size);

//! The estimate of each parameter by one check, as if nothing else had changed; in the chart's unit. NaN: it does not tell.
struct Estimates
{
    VectorXd value, std;                //!< std: without the calibration's error, which all checks share
};
Estimates estimatesOf(const CheckHistory& history, const CheckRecord& check, const MatrixXd& covariance);

//! One thing that changed, at once or steadily, from some check on.
struct DriftCause
{
    int change;                         //!< of CheckHistory::changes
    bool sinceCalibration;              //!< all checks show it
    size_t since;                       //!< else the last check without it; steadily: where the ramp begins
    bool steady;
    double gain;                        //!< by how much chi^2 falls
    VectorXd value;                     //!< in the chart's unit, as it is now
    MatrixXd covariance;
};

//! The best explanation of all checks by one change, and those that are about as good; the best first. Empty: there is none.
std::vector<DriftCause> driftCauses(const CheckHistory& history, const MatrixXd& covariance);

//! "window of camera 1: tilt has drifted by 0.081 +- 0.012 degrees since 2026-03-01"
std::string sentenceOf(const DriftCause& cause, const CheckHistory& history);

/** Within how many more checks like the last one a drift that begins now is found with a probability of 95 % or more, whatever its
direction; 0: not within LONGEST.
@param perMonth in the chart's unit. @param interval between checks, seconds */
int checksUntilFound(const CheckHistory& history, const MatrixXd& covariance, const ChartLimit& last, int change, double perMonth,
                     double interval);
const int LONGEST = 120;

//! The median time between checks; a month where there are fewer than two.
double intervalOf(const CheckHistory& history);

} // namespace tools

#endif // REFRACT_TOOLS_DRIFT_HPP
