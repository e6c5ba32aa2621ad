// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RIG_HISTORY_HPP
#define REFRACT_TOOLS_RIG_HISTORY_HPP

#include "history/drift.hpp"
#include <map>

/* All that the charts of a history say, for the terminal and the page. */
namespace tools {

//! A drift that would be found.
struct FoundDrift
{
    int change;
    double perMonth;            //!< the drift, in the chart's unit
    int checks;                 //!< within so many, with 95 %; 0: not within LONGEST
};

struct HistoryResult
{
    std::vector<ChartPoint> points;     //!< of each check
    std::vector<Trend> trends;          //!< of each parameter
    std::vector<DriftCause> causes;     //!< of an alarm of the last check; else empty
    std::vector<FoundDrift> found;      //!< of each window that may drift
    double interval;                    //!< between checks, seconds

    bool isAlarm() const { return points.back().isAlarm(); }
    //! Which charts the last check is beyond.
    std::vector<std::string> chartsBeyond(const CheckHistory& history) const;
    //! "window of camera 1: tilt x: 0.021 +- 0.002 degrees a month ...": the clearest of the best cause, or of all; empty: there is none.
    std::string mainTrend(const CheckHistory& history) const;
};

/** @param covariance of the calibrated parameters, in the order of withWedges()
@param falseAlarm probability of an alarm at a check, if nothing changed
@param drifts of a window's tilt or centre, by the chart's name, that should be found: a month, in the chart's unit */
HistoryResult chartHistory(const CheckHistory& history, const MatrixXd& covariance, double falseAlarm,
                           const std::map<std::string, double>& drifts);

//! "a; or b", the best three.
std::string causesIn(const HistoryResult& result, const CheckHistory& history);
//! "a drift of the window of camera 1: tilt of 0.02 degrees a month that begins now is found within 5 checks, one every 30 days"
std::string foundText(const FoundDrift& found, const CheckHistory& history, double interval);
//! "0.0123 +- 0.0021 degrees a month, at the limit of 0.03 in 2027-03 (2027-01 to 2027-07)"; "no trend: ..."
std::string trendText(const Trend& trend, const CheckHistory& history, const std::string& unit);

} // namespace tools

#endif // REFRACT_TOOLS_RIG_HISTORY_HPP
