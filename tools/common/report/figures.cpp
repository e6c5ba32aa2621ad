// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/figures.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "console/median.hpp"
#include "console/table.hpp"
#include "report/plot.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

using Rows = std::vector<std::vector<double>>;

const char* const DIRECT_COLOUR = "#64748b";
const char* const GLASS_COLOUR = "#0284c7";

//! 1, 2 or 5 times a power of ten, not above x: a factor that reads well.
double roundFactor(double x)
{
    const double power = std::pow(10., std::floor(std::log10(x)));
    const double lead = x/power;
    return power*(lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}

//! "set xtics" with the names of the views that are shown.
std::string viewTics(const RigCalibration& c, const std::vector<int>& views)
{
    std::string tics = "set xtics rotate by -60 out scale 0.5 font ',10' (";
    for (size_t k = 0; k < views.size(); k++)
        tics += (k ? ", " : "") + Plot::quoted(c.data.views[views[k]].stem) + format(" %zu", k);
    return tics + ")\n";
}

std::vector<Residual> glassResiduals(const RigCalibration& c, int camera)
{
    std::vector<Residual> list;
    std::copy_if(c.residuals.begin(), c.residuals.end(), std::back_inserter(list),
                 [camera](const Residual& r) { return r.camera == camera && r.glass; });
    return list;
}

//! Middle size of the residuals; arrows are scaled by it, so that one wild corner does not make the others vanish.
double typicalLength(const std::vector<Residual>& residuals)
{
    std::vector<double> lengths;
    for (const Residual& r : residuals)
        lengths.push_back(norm(r.error));
    if (lengths.empty())
        return 0.;
    return median(lengths);
}

} // namespace

Figure drawDisplacement(const RigCalibration& c, int camera)
{
    const int COLUMNS = 20;
    const Ptr<RefractiveCamera> through = c.fit.rig.cameras[camera], bare = copyWithWindow(through, GlassWindow());
    const Size size = c.data.imageSize[camera];
    const double z = workingDepth(c, camera)[1], step = (double)size.width/COLUMNS;
    std::vector<Point2d> from;
    for (double v = step/2; v < size.height; v += step)
        for (double u = step/2; u < size.width; u += step)
            from.emplace_back(u, v);
    std::vector<Point3d> scene;
    std::vector<Point2d> to;
    refractivePointsOnPlane(from, scene, bare, Vec4d(0, 0, 1, z));
    refractiveProjectPoints(scene, Vec3d(), Vec3d(), through, to);

    double longest = 0.;
    for (size_t i = 0; i < from.size(); i++)
        if (seen(to[i]))
            longest = std::max(longest, norm(to[i] - from[i]));
    const double scale = longest > 0 ? roundFactor(1.5*step/longest) : 1.;
    Rows rows;
    for (size_t i = 0; i < from.size(); i++)
    {
        const Point2d d = to[i] - from[i];
        if (seen(d))
            rows.push_back({from[i].x, from[i].y, d.x*scale, d.y*scale, norm(d)});
    }
    Plot plot(size);
    plot.data("arrows", rows);
    plot << "set cblabel 'displacement, px'\nunset key\n"
         << "plot $arrows using 1:2:3:4:5 with vectors filled head size " << step/5 << ",25 linewidth 1.3 linecolor palette\n";
    return {plot.svg(), format("at depth z = %.4g; arrows drawn %g times their length, longest %.1f px", z, scale, longest)};
}

Figure drawViewRms(const RigCalibration& c, int camera)
{
    std::vector<int> views;
    Rows rows;
    for (int i : c.fit.views)
    {
        const Rms direct = rmsOf(c, camera, false, i), glass = rmsOf(c, camera, true, i);
        if (direct.points + glass.points == 0)
            continue;
        const double k = (double)views.size();
        views.push_back(i);
        rows.push_back({k, direct.px, glass.px});
    }
    Plot plot(std::max(560, 110 + 26*(int)rows.size()), 320);
    plot.data("views", rows);
    plot << viewTics(c, views) << "set xlabel 'view (name of its images)'\nset ylabel 'RMS, px'\n"
         << "set yrange [0:*]\nset xrange [-0.7:" << rows.size() - 0.3 << "]\n"
         << "set style fill solid 0.9 noborder\nset boxwidth 0.36\nset key outside top center horizontal maxrows 1 samplen 2\n"
         << "unset grid\nset grid ytics linecolor rgb '#e2e8f0' linetype 1\n"
         << "plot $views using ($1-0.19):2 with boxes linecolor rgb '" << DIRECT_COLOUR << "' title 'direct', "
         << "$views using ($1+0.19):3 with boxes linecolor rgb '" << GLASS_COLOUR << "' title 'through the window', "
         << c.fit.rms << " with lines linecolor rgb '#dc2626' dashtype 2 title 'all'\n";
    return {plot.svg(), ""};
}

Figure drawResidualVectors(const RigCalibration& c, int camera)
{
    const std::vector<Residual> residuals = glassResiduals(c, camera);
    const Size size = c.data.imageSize[camera];
    const double typical = typicalLength(residuals);
    const double scale = typical > 0 ? roundFactor(size.width/25./typical) : 1.;
    Rows rows;
    for (const Residual& r : residuals)
        rows.push_back({r.pixel.x, r.pixel.y, r.error.x*scale, r.error.y*scale, norm(r.error)});
    Plot plot(size);
    plot.data("arrows", rows);
    plot << "set cblabel 'residual, px'\nunset key\n"
         << "plot $arrows using 1:2:3:4:5 with vectors filled head size " << size.width/120. << ",25 linecolor palette\n";
    return {plot.svg(), format("arrows drawn %g times their length", scale)};
}

Figure drawResidualMap(const RigCalibration& c, int camera)
{
    const size_t CORNERS = 6;           // wanted in a cell, for noise to average out
    const Size size = c.data.imageSize[camera];
    const std::vector<Residual> residuals = glassResiduals(c, camera);
    const double wanted = std::sqrt((double)residuals.size()/CORNERS*size.width/size.height);
    const int columnCount = std::min(16, std::max(4, (int)wanted));
    const double cell = (double)size.width/columnCount;
    const int rowCount = (int)std::ceil(size.height/cell);
    std::vector<Point2d> sum(columnCount*rowCount);
    std::vector<size_t> count(sum.size());
    for (const Residual& r : residuals)
    {
        const int column = std::min(columnCount - 1, std::max(0, (int)(r.pixel.x/cell)));
        const int row = std::min(rowCount - 1, std::max(0, (int)(r.pixel.y/cell)));
        sum[row*columnCount + column] += r.error;
        count[row*columnCount + column]++;
    }
    Rows rows;
    for (size_t i = 0; i < sum.size(); i++)
        rows.push_back({(i % columnCount + 0.5)*cell, (i/columnCount + 0.5)*cell,
                        2*count[i] >= CORNERS ? norm(sum[i])/count[i] : NONE, cell/2});
    Plot plot(size);
    plot.data("cells", rows);
    plot << "set cblabel 'mean residual, px'\nset cbrange [0:" << rmsOf(c, camera, true).px << "]\n"
         << "unset key\nset style fill solid noborder\n"
         << "plot $cells using 1:2:4:4:3 with boxxyerror linecolor palette\n";
    return {plot.svg(), ""};
}

Figure drawResidualHistogram(const RigCalibration& c, int camera)
{
    const int BINS = 41;
    std::vector<double> values;
    for (const Residual& r : glassResiduals(c, camera))
    {
        values.push_back(r.error.x);
        values.push_back(r.error.y);
    }
    const double sigma = rmsOf(c, camera, true).px/std::sqrt(2.);
    const double width = 10.*sigma/BINS;        // +- 5 sigma; what lies beyond goes into the last bin
    std::vector<double> density(BINS);
    for (double value : values)
    {
        const int bin = (int)std::floor((value + 5.*sigma)/width);
        density[std::min(BINS - 1, std::max(0, bin))] += 1./(values.size()*width);
    }
    Rows rows;
    for (int i = 0; i < BINS; i++)
        rows.push_back({(i + 0.5)*width - 5.*sigma, density[i]});
    Plot plot(560, 320);
    plot.data("bins", rows);
    plot << "set xlabel 'residual in u and v, px'\nset ylabel 'share of the residuals per px'\nset yrange [0:*]\nset samples 300\n"
         << "set style fill solid 0.6 noborder\nset boxwidth " << 0.9*width << "\nset key top right\n"
         << "set xrange [" << -5.*sigma << ':' << 5.*sigma << "]\n"
         << "plot $bins using 1:2 with boxes linecolor rgb '" << GLASS_COLOUR << "' title 'corners', "
         << "exp(-x*x/(2*" << sigma << "**2))/(" << sigma << "*sqrt(2*pi)) with lines linewidth 2 linecolor rgb '#dc2626' "
         << "title 'normal law'\n";
    return {plot.svg(), format("sigma = %.3f px per coordinate", sigma)};
}

Figure drawCoverage(const RigCalibration& c, int camera)
{
    Rows direct, glass;
    for (const View& view : c.data.views)
        for (bool through : {false, true})
            for (const Point2d& p : through ? view.glass[camera] : view.direct[camera])
                if (seen(p))
                    (through ? glass : direct).push_back({p.x, p.y});
    Plot plot(c.data.imageSize[camera]);
    plot << "set key outside top center horizontal maxrows 1 samplen 2\n";
    plot.data("glass", glass);
    if (!direct.empty())
        plot.data("direct", direct);
    plot << "plot ";
    if (!direct.empty())
        plot << "$direct with points pointtype 1 pointsize 0.5 linecolor rgb '" << DIRECT_COLOUR << "' title 'direct', ";
    plot << "$glass with points pointtype 7 pointsize 0.35 linecolor rgb '" << GLASS_COLOUR
         << "' title 'through the window'\n";
    return {plot.svg(), format("%.0f %% of the image is covered through the window", 100.*coverage(c, camera))};
}

Figure drawInfluence(const RigCalibration& c, int camera)
{
    std::vector<int> views;
    Rows rows;
    for (const Influence& influence : c.influences)
    {
        rows.push_back({(double)rows.size(), influence.change[camera]});
        views.push_back(influence.view);
    }
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    const double sigma = placeStd(c.fit.covariance, c.fit.rig, camera);
    Plot plot(std::max(560, 110 + 26*(int)rows.size()), 320);
    plot.data("views", rows);
    plot << viewTics(c, views) << "set xlabel 'view (name of its images)'\nset ylabel "
         << Plot::quoted((isRound(window) ? "motion of the centre, " : "turn of the normal, ") + placeUnit(window, c.unit))
         << "\nset yrange [0:*]\n"
         << "set xrange [-0.7:" << rows.size() - 0.3 << "]\nset style fill solid 0.9 noborder\nset boxwidth 0.6\n"
         << "set key outside top center horizontal maxrows 1 samplen 2\nunset grid\nset grid ytics linecolor rgb '#e2e8f0' linetype 1\n"
         << "plot $views using 1:2 with boxes linecolor rgb '" << GLASS_COLOUR << "' title 'without this view', "
         << sigma << " with lines linecolor rgb '#dc2626' dashtype 2 title 'one standard deviation'\n";
    return {plot.svg(), ""};
}

} // namespace tools
