// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DRIFT_HPP
#define REFRACT_TOOLS_DRIFT_HPP

#include "history/control_chart.hpp"

/* All that a history says, for the terminal and the page: its charts, and after an alarm what changed. */
namespace tools {

//! Where a change's parameters are in a check; -1: its images do not tell.
int rowOf(const CheckRecord& check, const std::vector<ChartedChange>& changes, int change);

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

struct HistoryResult
{
    std::vector<ChartPoint> points;     //!< of each check
    std::vector<DriftCause> causes;     //!< of an alarm of the last check; else empty

    bool isAlarm() const { return points.back().isAlarm(); }
    //! Which charts the last check is beyond.
    std::vector<std::string> chartsBeyond(const CheckHistory& history) const;
};

/** @param covariance of the calibrated parameters, in the order of withWedges()
@param falseAlarm probability of an alarm at a check, if nothing changed */
HistoryResult chartHistory(const CheckHistory& history, const MatrixXd& covariance, double falseAlarm);

//! "a; or b", the best three.
std::string causesIn(const HistoryResult& result, const CheckHistory& history);

} // namespace tools

#endif // REFRACT_TOOLS_DRIFT_HPP
