// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "history/drift.hpp"
#include "history/history_template.hpp"
#include "console/table.hpp"
#include "report/page_template.hpp"
#include "report/plot.hpp"
#include <cmath>

namespace tools {

namespace {

const double DAY = 86400.;
const char* const COLOURS[] = {"#0284c7", "#d97706", "#7c3aed"};

//! Seconds beside the first and the last check.
double roomOf(const CheckHistory& history)
{
    return std::max(DAY, 0.04*(secondsOf(history.checks.back().time) - secondsOf(history.checks.front().time)));
}

//! A time axis with room to both sides.
void setTimes(Plot& plot, const CheckHistory& history)
{
    const double first = secondsOf(history.checks.front().time), last = secondsOf(history.checks.back().time), room = roomOf(history);
    // A label is at a date, within the picture, and there are as many as have room.
    const size_t LABELS = 6, every = (history.checks.size() + LABELS - 1)/LABELS;
    plot << "set xtics time\nset format x '%Y-%m-%d' timedate\nset xtics rotate by -25 left offset -2,0 (";
    for (size_t t = 0; t < history.checks.size(); t += every)
        plot << (t ? ", " : "") << cv::format("%.0f", secondsOf(history.checks[history.checks.size() - 1 - t].time));
    plot << ")\n"
         << "set xrange [" << cv::format("%.0f", first - room) << ':' << cv::format("%.0f", last + room) << "]\n";
}

//! The EWMA over its standard deviation, and under it the estimates.
std::string changeFigure(const CheckHistory& history, const HistoryResult& result, const MatrixXd& covariance, int c)
{
    const ChartedChange& change = history.changes[c];
    const int first = firstParameters(history.changes)[c];
    Plot plot(620, 430);
    std::vector<std::vector<double>> limits;
    for (size_t t = 0; t < history.checks.size(); t++)
        limits.push_back({secondsOf(history.checks[t].time), result.points[t].limit});
    plot.data("limits", limits);
    std::string ewma, values;
    for (int axis = 0; axis < change.size(); axis++)
    {
        std::vector<std::vector<double>> rows, beyond;
        for (size_t t = 0; t < history.checks.size(); t++)
        {
            const ChartPoint& point = result.points[t];
            if (!point.seen[first + axis])
                continue;
            const Estimates e = estimatesOf(history, history.checks[t], covariance);
            rows.push_back({secondsOf(history.checks[t].time), point.ewma[first + axis], e.value[first + axis], e.std[first + axis]});
            if (point.isBeyond(first + axis))
                beyond.push_back(rows.back());
        }
        const std::string name = "axis" + std::to_string(axis), style = cv::format(" linecolor rgb '%s'", COLOURS[axis]);
        plot.data(name, rows);
        ewma += ", $" + name + " using 1:2 with linespoints pointtype 7 pointsize 0.5" + style
            + (change.axes[axis].empty() ? " notitle" : " title " + Plot::quoted(change.axes[axis]));
        // Bars of one check stand side by side.
        const double aside = 0.15*roomOf(history)*(axis - 0.5*(change.size() - 1));
        values += (axis ? ", " : "") + Plot::withBars(name, cv::format("($1%+.0f)", aside), 3, 4, COLOURS[axis]);
        if (beyond.empty())
            continue;
        plot.data(name + "beyond", beyond);
        ewma += ", $" + name + "beyond using 1:2 with points pointtype 6 pointsize 1.2 linewidth 2 linecolor rgb '#dc2626' notitle";
    }
    setTimes(plot, history);
    plot << "set multiplot\nset lmargin at screen 0.15\nset rmargin at screen 0.94\nset xzeroaxis linecolor rgb '#94a3b8'\n"
         << "set offsets 0, 0, graph 0.06, graph 0.06\nset format x ''\nset tmargin at screen 0.91\nset bmargin at screen 0.56\n"
         << "set ylabel 'EWMA / sigma'\nset key at graph 0.5,1.14 center horizontal\n"
         << "plot $limits using 1:2 with lines linecolor rgb '#dc2626' dashtype 2 title 'limit', $limits using 1:(-$2) with lines "
            "linecolor rgb '#dc2626' dashtype 2 notitle" << ewma << "\n"
         << "set format x '%Y-%m-%d' timedate\nset tmargin at screen 0.51\nset bmargin at screen 0.16\nset ylabel "
         << Plot::quoted(change.unit.empty() ? "estimate" : change.unit) << "\nplot " << values << "\nunset multiplot\n";
    return plot.svg();
}

//! T^2 has other degrees of freedom where a check tells of other things: over its limit.
std::string t2Figure(const CheckHistory& history, const HistoryResult& result)
{
    Plot plot(1240, 260);
    std::vector<std::vector<double>> rows, beyond;
    for (size_t t = 0; t < history.checks.size(); t++)
    {
        const ChartPoint& p = result.points[t];
        rows.push_back({secondsOf(history.checks[t].time), p.t2/p.limitT2});
        if (p.isBeyondT2())
            beyond.push_back(rows.back());
    }
    plot.data("all", rows);
    plot.data("beyond", beyond);
    setTimes(plot, history);
    plot << "set yrange [0:*]\nset ylabel 'T^2 / limit'\nset lmargin 12\nset rmargin 8\nset bmargin 4\nunset key\n"
         << "plot 1 with lines linecolor rgb '#dc2626' dashtype 2, $all using 1:2 with linespoints pointtype 7 pointsize 0.5 "
         << "linecolor rgb '" << COLOURS[0] << "'";
    if (!beyond.empty())
        plot << ", $beyond using 1:2 with points pointtype 6 pointsize 1.2 linewidth 2 linecolor rgb '#dc2626'";
    plot << '\n';
    return plot.svg();
}

std::vector<Json> estimateRows(const CheckHistory& history, const HistoryResult& result, const MatrixXd& covariance)
{
    const std::vector<int> first = firstParameters(history.changes);
    const Estimates last = estimatesOf(history, history.checks.back(), covariance);
    std::vector<Json> list;
    for (size_t c = 0; c < history.changes.size(); c++)
        for (int i = first[c]; i < first[c + 1]; i++)
        {
            const ChartedChange& change = history.changes[c];
            const ChartPoint& point = result.points.back();
            const std::string axis = change.axes[i - first[c]];
            list.push_back({{"name", change.name + (axis.empty() ? "" : ", " + axis)},
                            {"ewma", std::isnan(point.ewma[i]) ? "-" : cv::format("%+.2f", point.ewma[i])},
                            {"class", point.isBeyond(i) ? "missed" : ""},
                            {"value", std::isnan(last.value[i]) ? "-" : plusMinus(last.value[i], last.std[i])
                                      + (change.unit.empty() ? "" : " " + change.unit)}});
        }
    return list;
}

std::vector<Json> checkRows(const CheckHistory& history, const HistoryResult& result)
{
    std::vector<Json> list;
    for (size_t t = 0; t < history.checks.size(); t++)
    {
        const CheckRecord& check = history.checks[t];
        const ChartPoint& p = result.points[t];
        std::string images;
        for (const CheckedImage& image : check.images)
            images += (images.empty() ? "" : ", ") + image.name;
        list.push_back({{"time", check.time}, {"verdict", check.verdict}, {"images", images},
                        {"sigma", cv::format("%.4f", check.sigma)}, {"t2", cv::format("%.1f of %.1f (%d)", p.t2, p.limitT2, p.dof)},
                        {"limit", cv::format("%.2f", p.limit)}, {"alarm", p.isAlarm() ? "beyond a limit" : ""}});
    }
    return list;
}

std::vector<Json> figures(const CheckHistory& history, const HistoryResult& result, const MatrixXd& covariance)
{
    std::vector<Json> list;
    for (int c = 0; c < (int)history.changes.size(); c++)
    {
        list.push_back({{"title", history.changes[c].name}, {"svg", changeFigure(history, result, covariance, c)}});
    }
    return list;
}

} // namespace

std::string historyPage(const CheckHistory& history, const HistoryResult& result, const MatrixXd& covariance, const HistoryFacts& facts)
{
    Json page = Json::object();
    page.set("verdict", facts.verdict);
    page.set("verdict_class", facts.isGood ? "good" : "bad");
    page.set("has_serial", !history.serial.empty());
    page.set("serial", history.serial);
    page.set("calibration", facts.calibration);
    page.set("sha256", history.calibration);
    page.set("first", history.checks.front().time.substr(0, 10));
    page.set("last", history.checks.back().time.substr(0, 10));
    page.set("count", std::to_string(history.checks.size()));
    page.set("false_alarms", cv::format("%.0f", 1./facts.falseAlarm));
    page.set("weight", cv::format("%g", EWMA_WEIGHT));
    page.set("broken", pageList(history.broken));
    page.set("has_causes", !result.causes.empty());
    page.set("causes", causesIn(result, history));
    page.set("has_unseen", !facts.unseen.empty());
    page.set("unseen", facts.unseen);
    page.set("t2", t2Figure(history, result));
    page.set("figures", figures(history, result, covariance));
    page.set("estimates", estimateRows(history, result, covariance));
    page.set("checks", checkRows(history, result));
    return renderPage("the history", HISTORY_TEMPLATE, page);
}

} // namespace tools
