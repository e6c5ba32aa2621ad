// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/table.hpp"
#include "report/figures.hpp"
#include "report/plot.hpp"
#include <cmath>

/* How well points can be measured: over the image at one range, and over the range. */

using namespace cv;

namespace tools {

namespace {

const double DECADE = 10.;      // errors that differ by more are told apart only by their logarithms

}

Vec2d commonScale(const std::vector<ErrorMap>& maps)
{
    Vec2d scale(NONE, NONE);
    for (const ErrorMap& map : maps)
        if (map.seen())
            scale = Vec2d(std::fmin(scale[0], map.best()), std::fmax(scale[1], map.percentile95()));
    return scale;
}

//! 1, 2, 5 of each decade, as gnuplot labels the ones alone.
static std::string ticsOfLog(const Vec2d& scale)
{
    std::string tics;
    for (double decade = std::pow(10., std::floor(std::log10(scale[0]))); decade <= scale[1]; decade *= 10.)
        for (double digit : {1., 2., 5.})
            if (digit*decade >= scale[0] && digit*decade <= scale[1])
                tics += (tics.empty() ? "" : ", ") + format("%g", digit*decade);
    return tics;
}

Figure drawErrorMap(const RigCalibration& c, const ErrorMap& map, Vec2d scale)
{
    const Size size = c.data.imageSize[0];
    const double halfWidth = 0.5*(size.width - 1.)/(map.grid.width - 1);
    const double halfHeight = 0.5*(size.height - 1.)/(map.grid.height - 1);
    std::vector<std::vector<double>> rows;
    for (size_t i = 0; i < map.pixels.size(); i++)
        if (map.total[i] == map.total[i])
            rows.push_back({map.pixels[i].x, map.pixels[i].y, halfWidth, halfHeight, map.total[i]});
    Plot plot(size);
    plot.data("cells", rows);
    plot << "set cblabel " << Plot::quoted("expected error", c.unit) << "\nset cbrange [" << scale[0] << ':' << scale[1]
         << "]\n" << (scale[1] > DECADE*scale[0] ? "set logscale cb\nset cbtics (" + ticsOfLog(scale) + ")\n" : "")
         << "unset key\nset style fill solid noborder\n"      // gnuplot's own range leaves out cells that reach over the border
         << "plot $cells using 1:2:3:4:5 with boxxyerror linecolor palette\n";
    return {plot.svg(), format("half of the image within %.3g %s, 95 %% within %.3g %s, at worst %.3g %s",
                               map.median(), c.unit.c_str(), map.percentile95(), c.unit.c_str(), map.worst(), c.unit.c_str())};
}

Figure drawErrorOverRange(const RigCalibration& c, const Assessment& assessment)
{
    std::vector<std::vector<double>> rows, limits;
    for (const ErrorMap& map : assessment.errors)
        rows.push_back({map.range, map.median(), map.worst(), map.worstPixelNoise(), map.percentile95()});
    for (const ErrorLimit& limit : c.limits.errors)
        limits.push_back({limit.range, limit.error});
    const Vec3d depth = workingDepth(c, 0);
    Plot plot(560, 360);
    plot.data("errors", rows);
    if (!limits.empty())
        plot.data("limits", limits);
    plot << "set logscale xy\nset xlabel " << Plot::quoted("z from camera 1", c.unit) << "\nset ylabel "
         << Plot::quoted("expected error", c.unit) << "\nset format y '%g'\n"
         << "set xrange [" << rows.front()[0]*0.95 << ':' << rows.back()[0]*1.05 << "]\n"
         << "set xtics (";
    for (size_t i = 0; i < rows.size(); i++)
        plot << (i ? ", " : "") << format("'%.4g' %.9g", rows[i][0], rows[i][0]);
    plot << ") rotate by -45\nset key outside top center horizontal maxrows 2 samplen 2\n"
         << "set object 1 rectangle from " << depth[0] << ", graph 0 to " << depth[2]
         << ", graph 1 behind fillcolor rgb '#e0f2fe' fillstyle solid noborder\n"
         << "plot $errors using 1:3 with linespoints pointtype 7 pointsize 0.6 linewidth 2 linecolor rgb '#dc2626' title 'worst', "
         << "$errors using 1:5 with linespoints pointtype 7 pointsize 0.6 linewidth 2 linecolor rgb '#f59e0b' title '95 % within', "
         << "$errors using 1:2 with linespoints pointtype 7 pointsize 0.6 linewidth 2 linecolor rgb '#0284c7' title 'half within', "
         << "$errors using 1:4 with lines dashtype 2 linewidth 2 linecolor rgb '#64748b' title 'worst, pixel noise alone'"
         << (limits.empty() ? "" : ", $limits using 1:2 with points pointtype 11 pointsize 1.2 linecolor rgb '#0f172a' title 'limit'")
         << "\n";
    return {plot.svg(), "blue band: where the boards of the calibration were"};
}

} // namespace tools
