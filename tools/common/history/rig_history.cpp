// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "history/rig_history.hpp"
#include "console/lines.hpp"
#include "console/table.hpp"
#include <cmath>

namespace tools {

namespace {

const double DAY = 86400.;

std::string dayAt(double seconds) { return timeAt(seconds).substr(0, 10); }
std::string monthAt(double seconds) { return timeAt(seconds).substr(0, 7); }

} // namespace

std::vector<std::string> HistoryResult::chartsBeyond(const CheckHistory& history) const
{
    const ChartPoint& last = points.back();
    const std::vector<int> first = firstParameters(history.changes);
    std::vector<std::string> names;
    for (size_t c = 0; c < history.changes.size(); c++)
        for (int i = first[c]; i < first[c + 1]; i++)
            if (last.isBeyond(i))
            {
                const std::string axis = history.changes[c].axes[i - first[c]];
                names.push_back(history.changes[c].name + (axis.empty() ? "" : " " + axis));
            }
    if (last.isBeyondT2())
        names.push_back("T^2 of all");
    return names;
}

std::string HistoryResult::mainTrend(const CheckHistory& history) const
{
    const std::vector<int> first = firstParameters(history.changes);
    std::string text;
    double clearest = 0.;
    for (size_t c = 0; c < history.changes.size(); c++)
        for (int i = first[c]; i < first[c + 1]; i++)
        {
            const double ratio = std::abs(trends[i].perMonth)/trends[i].std;
            if (!trends[i].isSignificant() || !(ratio > clearest) || (!causes.empty() && causes[0].change != (int)c))
                continue;
            clearest = ratio;
            const ChartedChange& change = history.changes[c];
            const std::string axis = change.axes[i - first[c]];
            text = change.name + (axis.empty() ? "" : " " + axis) + ": " + trendText(trends[i], history, change.unit);
        }
    return text;
}

HistoryResult chartHistory(const CheckHistory& history, const MatrixXd& covariance, double falseAlarm,
                           const std::map<std::string, double>& drifts)
{
    HistoryResult result;
    const std::vector<ChartLimit> limits = chartLimits(history, covariance, falseAlarm);
    result.points = controlCharts(history, covariance, limits);
    result.trends = trendsOf(history, covariance, result.points);
    result.interval = intervalOf(history);
    if (result.isAlarm())
        result.causes = driftCauses(history, covariance);
    for (int c : history.checks.back().changes)
    {
        const auto drift = drifts.find(history.changes[c].name);
        if (drift != drifts.end())
            result.found.push_back({c, drift->second,
                                    checksUntilFound(history, covariance, limits.back(), c, drift->second, result.interval)});
    }
    return result;
}

std::string causesIn(const HistoryResult& result, const CheckHistory& history)
{
    const size_t MOST = 3;
    std::vector<std::string> sentences;
    for (const DriftCause& cause : result.causes)
        sentences.push_back(sentenceOf(cause, history));
    return alternatives(sentences, MOST);
}

std::string foundText(const FoundDrift& found, const CheckHistory& history, double interval)
{
    const ChartedChange& change = history.changes[found.change];
    const std::string drift = change.name + cv::format(": a drift of %.3g", found.perMonth) + (change.unit.empty() ? "" : " " + change.unit)
        + " a month that begins now is ";
    const std::string every = cv::format(", one every %.3g days", interval/86400.), plural = found.checks == 1 ? "" : "s";
    return found.checks ? drift + cv::format("found within %d check", found.checks) + plural + every + ", with a probability of 95 %"
                        : drift + cv::format("not sure to be found within %d checks", LONGEST) + every + ": take more pairs at each";
}

std::string trendText(const Trend& trend, const CheckHistory& history, const std::string& unit)
{
    if (std::isnan(trend.perMonth))
        return "three checks at different times show one";
    if (trend.step == trend.step)
        return "changed after " + dayAt(trend.step) + (trend.checksSince > 1 ? ", at once: no trend"
                                                                             : "; at once or steadily, the next check tells");
    const std::string since = std::isnan(trend.since) ? "" : " since " + dayAt(trend.since)
        + cv::format(" +- %.0f days", std::max(1., trend.sinceStd/DAY));
    const std::string value = plusMinus(trend.perMonth, trend.std) + (unit.empty() ? "" : " " + unit) + " a month" + since;
    if (!trend.isSignificant())
        return value + ": none";
    if (std::isnan(trend.reached))
        return value;
    if (trend.latest < secondsOf(history.checks.back().time))
        return value + ", beyond the limit of " + cv::format("%.2g", trend.limit) + " since " + monthAt(trend.reached) + " ("
            + monthAt(trend.earliest) + " to " + monthAt(trend.latest) + ")";
    return value + ", at the limit of " + cv::format("%.2g", trend.limit) + " in " + monthAt(trend.reached) + " (" + monthAt(trend.earliest)
        + " to " + monthAt(trend.latest) + ")";
}

} // namespace tools
