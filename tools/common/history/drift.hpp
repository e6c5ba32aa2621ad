// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DRIFT_HPP
#define REFRACT_TOOLS_DRIFT_HPP

#include "history/check_history.hpp"

/* All that a history says, for the terminal and the page: its charts, and after an alarm what changed. */
namespace tools {

/* Control charts of a history of checks: for each parameter an EWMA of its innovations, each over its standard deviation (Roberts 1959),

    z_t = lambda u_t + (1 - lambda) z_(t-1),     var z_t = lambda^2 + (1 - lambda)^2 var z_(t-1),    var z_0 = 0,

and of all of them Hotelling's T^2, which is chi^2. Charts overlap, so their limits are those of one probability: at each check the
largest excursion of all charts exceeds it with the stated probability, if nothing changed and no chart exceeded its limit before. Then
the number of checks to a false alarm is geometric, as that of a single chart of independent values (dynamic probability limits, Zhang
and Woodall, Quality and Reliability Engineering International 31, 2015). They come from draws of the innovations through the same
charts, always the same ones; each draw has a noise of its own, as far as the calibration's residuals leave it open. */

/* What is new in each check. The calibration's own error dp is one for all checks,

    score_t = G_t change_t + D_t dp + noise_t,      cov(dp) = C,    cov(noise_t) = G_t - D_t C D_t^T,

so that checks are not independent of each other and it does not average out. Each check is therefore held against what the calibration
and all checks before it say of dp, as if nothing had changed (a Kalman filter whose state is constant). What is left, the innovation,
is independent of all others, and normal with the covariance V_t, exactly. */

//! Of one check. Rows: the parameters of CheckRecord::changes, one change after the other.
struct Innovation
{
    MatrixXd value;             //!< a column each scenario
    MatrixXd root, inverse;     //!< V = root root^T, and its pseudo-inverse: changes may look alike
    //! The same for each change by itself, as if nothing else had changed.
    MatrixXd alone;
    MatrixXd rootAlone;         //!< of its covariance
    VectorXd stdAlone;

    int rank() const { return (int)root.cols(); }
};

class InnovationFilter
{
public:
    //! @param covariance of the calibrated parameters; zeros: they are exact
    explicit InnovationFilter(const MatrixXd& covariance, Eigen::Index scenarios = 1);

    //! @param scores of the scenarios, of which the first is usually what was seen
    Innovation add(const CheckRecord& check, const std::vector<ChartedChange>& changes, const MatrixXd& scores);

private:
    MatrixXd C0_, C_, mean_;
};

const double EWMA_WEIGHT = 0.2;         // lambda

//! All charts after one check.
struct ChartPoint
{
    VectorXd ewma;              //!< of each parameter, in its chart's direction, over its standard deviation; NaN: not yet seen
    VectorXd std;               //!< of its innovation; NaN where this check does not tell
    std::vector<bool> seen;     //!< whether it does
    double t2 = 0.;
    int dof = 0;                //!< of T^2
    double critical = 0.;       //!< probability of a chart's limit, two-sided
    double limit = 0., limitT2 = 0.;

    double probabilityOf(int parameter) const;
    double probabilityOfT2() const;
    bool isBeyond(int parameter) const { return probabilityOf(parameter) < critical; }
    bool isBeyondT2() const { return probabilityOfT2() < critical; }
    bool isAlarm() const;
};

//! The limits of all checks; they depend on what checks tell, not on what they found.
struct ChartLimit
{
    double critical, limit, limitT2;
};
std::vector<ChartLimit> chartLimits(const CheckHistory& history, const MatrixXd& covariance, double falseAlarm);

//! @param limits of chartLimits. @param covariance of the calibrated parameters, in the order of withWedges()
std::vector<ChartPoint> controlCharts(const CheckHistory& history, const MatrixXd& covariance, const std::vector<ChartLimit>& limits);

//! Where the parameters of each change begin; one more at the end.
std::vector<int> firstParameters(const std::vector<ChartedChange>& changes);
//! The parameters of a check, in its order.
std::vector<int> parametersOf(const CheckRecord& check, const std::vector<ChartedChange>& changes);

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

//! What the page says beside the charts.
struct HistoryFacts
{
    std::string calibration;            //!< its file
    double falseAlarm;
    std::string verdict;                //!< of the last check
    bool isGood;
    std::string unseen;                 //!< what no such check shows; may be empty
};

//! The charts as one HTML page that needs no other file. Throws Failure if gnuplot fails.
std::string historyPage(const CheckHistory& history, const HistoryResult& result, const MatrixXd& covariance, const HistoryFacts& facts);

} // namespace tools

#endif // REFRACT_TOOLS_DRIFT_HPP
