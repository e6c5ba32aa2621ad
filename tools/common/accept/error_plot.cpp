// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/error_plot.hpp"
#include "report/plot.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace tools {

static const int WIDTH = 460, HEIGHT = 300;

std::string drawErrorsOverLength(const Acceptance& a)
{
    Plot plot(WIDTH, HEIGHT);
    std::vector<std::vector<double>> errors, limits;
    double longest = 0., highest = 0.;
    for (const LengthResult& r : a.lengths)
    {
        errors.push_back({r.length.length, r.error, r.U()});
        longest = std::max(longest, r.length.length);
        highest = std::max({highest, std::abs(r.error) + r.U(), r.limit});
    }
    for (int i = 0; i <= 20; i++)
    {
        const double length = 1.1*longest*i/20;
        limits.push_back({length, a.limit.of(length)});
    }
    const std::string unit = a.unit.empty() ? "" : ", " + a.unit;
    plot.data("errors", errors);
    plot.data("limits", limits);
    plot << "set xlabel " << Plot::quoted("length" + unit) << "\nset ylabel " << Plot::quoted("error of indication" + unit)
         << "\nset xrange [0:" << 1.1*longest << "]\nset yrange [" << -1.1*highest << ':' << 1.1*highest << "]\nset key off\n"
         << "plot $limits using 1:2 with lines linewidth 2 linecolor rgb '#dc2626', $limits using 1:(-$2) with lines linewidth 2 "
            "linecolor rgb '#dc2626', 0 with lines linecolor rgb '#94a3b8', " << Plot::withBars("errors", "1", 2, 3, "#0284c7") << '\n';
    return plot.svg();
}

std::string drawErrorsInVolume(const Acceptance& a)
{
    Plot plot(WIDTH, HEIGHT);
    const double gap = std::numeric_limits<double>::quiet_NaN();
    std::vector<std::vector<double>> lengths, box;
    for (const LengthResult& r : a.lengths)
    {
        for (size_t end : r.length.ends)
        {
            const cv::Point3d& X = a.points.points[end].X;
            lengths.push_back({X.z, X.x, r.error/r.limit});
        }
        lengths.push_back({gap, gap, gap});
    }
    if (a.volume.box)
    {
        const cv::Point3d& p = a.volume.box->least, & q = a.volume.box->most;
        box = {{p.z, p.x}, {q.z, p.x}, {q.z, q.x}, {p.z, q.x}, {p.z, p.x}};
    }
    const std::string unit = a.unit.empty() ? "" : ", " + a.unit;
    plot.data("lengths", lengths);
    plot.data("box", box);
    plot << "set xlabel " << Plot::quoted("z" + unit) << "\nset ylabel " << Plot::quoted("x" + unit)
         << "\nset size ratio -1\nset cbrange [-1:1]\nset cblabel 'error over limit'\nset key off\nplot "
         << (box.empty() ? "" : "$box using 1:2 with lines dashtype 2 linewidth 2 linecolor rgb '#475569', ")
         << "$lengths using 1:2:3 with linespoints pointtype 7 pointsize 0.3 linewidth 2 linecolor palette\n";
    return plot.svg();
}

} // namespace tools
