#include "summary.hpp"
#include "table.hpp"
#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

std::string plusMinus(double value, double std)
{
    // Two digits of the standard deviation, and the value as far.
    const int decimals = std::max(0, 1 - (int)std::floor(std::log10(std)));
    return format("%.*f +- %.*f", decimals, value, decimals, std);
}

std::string estimateOr(double value, double std, const char* otherwise)
{
    return std > 0 ? plusMinus(value, std) : format("%.6g (%s)", value, otherwise);
}

std::string px(double value) { return std::isnan(value) ? "-" : format("%.3f", value); }

std::string viewsAndCorners(const Rms& rms) { return format("%d / %d", rms.views, rms.points); }

std::string lensOf(const RigCalibration& c, int camera)
{
    const LensSource& source = c.lensSources[camera];
    std::string text = format("%s, %d coefficients, ", c.fit.rig.cameras[camera]->lensModel().c_str(),
                              c.fit.rig.cameras[camera]->lensParameters().rows - 4);
    text += source.kind == LensSource::FROM_FILE ? std::string("given") : format("%d views, %.3f px", source.views, source.rms);
    return text + (c.options.flags & GLASS_FREE_INTRINSICS ? ", refined" : "");
}

std::string worstViews(const RigCalibration& c, int camera)
{
    std::vector<std::pair<double, int>> views;
    for (int i : c.fit.moments)
    {
        const Rms rms = rmsOf(c, camera, true, i);
        if (rms.points)
            views.push_back({rms.px, i});
    }
    std::sort(views.rbegin(), views.rend());
    std::string text;
    for (size_t k = 0; k < std::min<size_t>(3, views.size()); k++)
        text += (k ? ", " : "") + c.data.moments[views[k].second].stem + format(" %.3f", views[k].first);
    return text;
}

SummaryRow row(const RigCalibration& c, const std::string& name, const std::function<std::string(int)>& cell)
{
    SummaryRow result{name, {}};
    for (int k = 0; k < c.data.cameraCount; k++)
        result.cells.push_back(cell(k));
    return result;
}

void printSentences(std::ostream& out, const char* heading, const std::vector<std::string>& sentences)
{
    if (sentences.empty())
        return;
    out << '\n' << heading << '\n';
    for (const std::string& sentence : sentences)
        out << "  - " << sentence << '\n';
}

} // namespace

std::vector<SummaryRow> windowRows(const RigCalibration& c)
{
    const auto window = [&c](int k) { return c.fit.rig.cameras[k]->window(); };
    const auto deviation = [&c](int k) { return windowStd(c.fit, k); };
    std::vector<SummaryRow> rows;
    rows.push_back(row(c, "normal", [&](int k) {
        const Vec3d n = window(k).normal;
        return format("(%.5f, %.5f, %.5f)", n[0], n[1], n[2]);
    }));
    rows.push_back(row(c, "tilt against the optical axis, deg",
                       [&](int k) { return format("%.3f", std::acos(std::min(1., window(k).normal[2])) * 180. / CV_PI); }));
    rows.push_back(row(c, "normal +- (two principal), deg", [&](int k) {
        const std::vector<double> std = deviation(k).normalDeg;
        return format("%.2g, %.2g", std[0], std[1]);
    }));
    rows.push_back(row(c, "distance", [&](int k) {
        const GlassWindow w = window(k);
        return w.innerIndex == w.outerIndex ? std::string("no effect") : estimateOr(w.distance, deviation(k).distance, "given");
    }));
    const GlassWindow first = window(0);
    for (size_t i = 0; i < first.thickness.size(); i++)
    {
        const std::string layer = first.thickness.size() == 1 ? "" : format(" of layer %zu", i + 1);
        rows.push_back(row(c, "thickness" + layer,
                           [&](int k) { return estimateOr(window(k).thickness[i], deviation(k).thickness[i], "given"); }));
        rows.push_back(row(c, "index" + layer,
                           [&](int k) { return estimateOr(window(k).index[i], deviation(k).index[i], "given"); }));
    }
    rows.push_back(row(c, "index of the scene's medium",
                       [&](int k) { return estimateOr(window(k).outerIndex, deviation(k).outerIndex, "given"); }));
    rows.push_back(row(c, "lens", [&](int k) { return lensOf(c, k); }));
    return rows;
}

std::vector<SummaryRow> fitRows(const RigCalibration& c)
{
    std::vector<SummaryRow> rows;
    rows.push_back(row(c, "RMS through the window, px", [&](int k) { return px(rmsOf(c, k, true).px); }));
    rows.push_back(row(c, "  the same, glass ignored, px", [&](int k) { return px(c.baselines.glassIgnored[k]); }));
    rows.push_back(row(c, "  the same, board where it is, px", [&](int k) { return px(c.baselines.shift[k]); }));
    rows.push_back(row(c, "  the same, pinhole through glass, px", [&](int k) { return px(c.baselines.throughGlass[k]); }));
    rows.push_back(row(c, "RMS direct, px", [&](int k) { return px(rmsOf(c, k, false).px); }));
    rows.push_back(row(c, "views / corners through the window", [&](int k) { return viewsAndCorners(rmsOf(c, k, true)); }));
    rows.push_back(row(c, "views / corners direct", [&](int k) { return viewsAndCorners(rmsOf(c, k, false)); }));
    rows.push_back(row(c, "pairs of direct and glass", [&](int k) { return format("%d", c.data.countPairs(k)); }));
    rows.push_back(row(c, "worst views, px", [&](int k) { return worstViews(c, k); }));
    return rows;
}

void printSummary(std::ostream& out, const RigCalibration& c, const Findings& findings)
{
    Table table(c.data.cameraCount == 1 ? std::vector<std::string>{"", "camera"}
                                        : std::vector<std::string>{"", "camera 1", "camera 2"});
    for (const std::vector<SummaryRow>& rows : {windowRows(c), fitRows(c)})
        for (const SummaryRow& r : rows)
        {
            std::vector<std::string> cells{r.name};
            cells.insert(cells.end(), r.cells.begin(), r.cells.end());
            table.add(cells);
        }
    table.print(out);
    if (c.nearFar.done)
    {
        out << "\nCalibrated on one half of the boards, tested on the other (RMS px):\n";
        Table halves({"", "near -> far", "far -> near"});
        halves.add({"lens and window", px(c.nearFar.windowNearToFar), px(c.nearFar.windowFarToNear)});
        halves.add({"pinhole through glass", px(c.nearFar.pinholeNearToFar), px(c.nearFar.pinholeFarToNear)});
        halves.print(out);
    }
    out << format("\nRMS over all corners %.4f px.\n", c.fit.rms);
    printSentences(out, "Images in which the target was not found:", c.withoutTarget);
    printSentences(out, "Limits not met:", findings.limitsNotMet);
    printSentences(out, "Weak:", findings.weak);
    printSentences(out, "The data cannot tell:", findings.cannotTell);
    printSentences(out, "Taken as given:", findings.assumed);
}

Calibration toFile(const RigCalibration& c, const std::string& command)
{
    Calibration file;
    for (int k = 0; k < c.data.cameraCount; k++)
        file.cameras.push_back({c.fit.rig.cameras[k], windowStd(c.fit, k), rmsOfCamera(c, k).px});
    file.R = c.fit.rig.R;
    file.T = c.fit.rig.T;
    file.rms = c.fit.rms;
    file.covariance = c.fit.covariance;
    file.command = command;
    return file;
}

} // namespace tools
