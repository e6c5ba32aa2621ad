// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/figures.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "console/progress.hpp"
#include "console/table.hpp"
#include "report/plot.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

using Rows = std::vector<std::vector<double>>;

namespace {

const char* const DIRECT_COLOUR = "#64748b";
const char* const GLASS_COLOUR = "#0284c7";

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

} // namespace

//! RMS of each view, direct and through the window.
static Figure drawViewRms(const RigCalibration& c, int camera)
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

//! Mean residual of each cell of the image: what is left is not noise.
static Figure drawResidualMap(const RigCalibration& c, int camera)
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

//! Where the image was covered by corners, direct and through the window.
static Figure drawCoverage(const RigCalibration& c, int camera)
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

//! How far the normal turns without each view.
static Figure drawInfluence(const RigCalibration& c, int camera)
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
         << Plot::quoted(isRound(window) ? "motion of the centre" : "turn of the normal", placeUnit(window, c.unit))
         << "\nset yrange [0:*]\n"
         << "set xrange [-0.7:" << rows.size() - 0.3 << "]\nset style fill solid 0.9 noborder\nset boxwidth 0.6\n"
         << "set key outside top center horizontal maxrows 1 samplen 2\nunset grid\nset grid ytics linecolor rgb '#e2e8f0' linetype 1\n"
         << "plot $views using 1:2 with boxes linecolor rgb '" << GLASS_COLOUR << "' title 'without this view', "
         << sigma << " with lines linecolor rgb '#dc2626' dashtype 2 title 'one standard deviation'\n";
    return {plot.svg(), ""};
}

static Json figure(const Figure& picture, const std::string& title, const std::string& reading)
{
    return {{"title", title}, {"svg", picture.svg},
            {"reading", reading + (picture.note.empty() ? "" : " (" + picture.note + ")") + "."}};
}

std::vector<Json> figuresOf(const RigCalibration& c, int camera, Progress& progress)
{
    std::vector<Json> list;
    auto add = [&](const Figure& picture, const char* title, const char* reading) {
        list.push_back(figure(picture, title, reading));
        progress.step();
    };
    add(drawSideView(c, camera, 0), "Seen from above",
        "To scale: the camera at the left, its rays bending at the window, the boards where they were seen");
    add(drawSideView(c, camera, 1), "Seen from the side",
        "The same with y pointing down; a window that is not where you mounted it shows here");
    add(drawCoverage(c, camera), "Where the board was seen",
        "Empty parts of the image are extrapolated: what is measured there is less certain");
    add(drawViewRms(c, camera), "Residual of each view",
        "All bars should be about equally high; one that stands out has wrong corners or a board that moved");
    if (!c.influences.empty())
        add(drawInfluence(c, camera), "Which view pulls",
            "How far the window turns or moves if a view is left out; a bar far above the line means that the result hangs on that view");
    add(drawResidualMap(c, camera), "Mean residual over the image",
        "Noise averages out, so most cells should be blue or green; red cells next to each other, where residuals all point the "
        "same way, are a systematic error. Cells with few corners are left white");
    return list;
}

Json errorOverRange(const RigCalibration& c, const Assessment& a, Progress& progress)
{
    progress.step();
    return figure(drawErrorOverRange(c, a), "Expected error over the range", "How far a measured point lies from the truth (one "
                  "standard deviation, 3-D). Where the red line leaves the dashed one, a better calibration would help; "
                  "where they meet, only a better image would");
}

void addErrorMaps(std::vector<Json>& list, const RigCalibration& c, const Assessment& a, Progress& progress)
{
    const Vec2d scale = commonScale(a.errors);
    for (const ErrorMap& map : a.errors)
    {
        if (map.seen())
            list.push_back(figure(drawErrorMap(c, map, scale), format("Expected error at z = %.4g %s", map.range, c.unit.c_str()),
                                  c.data.cameraCount > 1 ? std::string("Over the image of camera 1; white parts are not seen by ")
                                                           + (c.data.cameraCount == 2 ? "both cameras" : "any other camera")
                                                           + ". The colours of all ranges are those of one scale"
                                                         : "Over the image, for points on a plane square to the camera. The colours of "
                                                           "all ranges are those of one scale"));
        progress.step();
    }
}

std::vector<Json> rigFigures(const RigCalibration& c, Progress& progress)
{
    const char* reading = "To scale, obliquely from above: the cameras with their numbers, the part of each window that they look "
                          "through, their middle rays bending at it, and the points that were seen; a camera that is not where you "
                          "mounted it shows here";
    std::vector<Json> list;
    list.push_back(figure(drawRig(c, 35.), "The rig from behind", reading));
    progress.step();
    list.push_back(figure(drawRig(c, -60.), "The rig from the other side", reading));
    progress.step();
    return list;
}

} // namespace tools
