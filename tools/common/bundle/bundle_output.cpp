// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "bundle/bundle_output.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/csv.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>

using namespace cv;

namespace tools {

namespace {

const size_t WIDTH = 80;

std::string correctionText(const char* name, const Correction& correction)
{
    return std::string(name) + (correction.estimated ? " " + plusMinus(correction.by, correction.std) : " as given");
}

//! The camera that is known worst, for rigs too large to show all.
int worstCamera(const BundleFindings& findings)
{
    int worst = 0;
    for (int c = 1; c < (int)findings.corrections.size(); c++)
        if (findings.corrections[c].worstDeg > findings.corrections[worst].worstDeg)
            worst = c;
    return worst;
}

//! Of a camera in a tube two lines: it has an axis, too.
std::string cameraLines(const BundleFindings& findings, int c)
{
    const CameraCorrection& correction = findings.corrections[c];
    const std::string head = format("  camera %d: ", c + 1);
    std::string text = head + correctionText(correction.name.c_str(), correction.place);
    if (correction.axis.estimated)
        text += ", " + correctionText("axis", correction.axis);
    if (c > 0)
        text += (correction.axis.estimated ? ",\n" + std::string(head.size(), ' ') : ", ") + correctionText("R", correction.R) + ", "
            + correctionText("T", correction.T);
    return text + "\n";
}

//! A line a camera, while there is room in the ten.
int shownCameras(const BundleFindings& findings)
{
    const auto hasAxis = [](const CameraCorrection& c) { return c.axis.estimated; };
    return std::any_of(findings.corrections.begin(), findings.corrections.end(), hasAxis) ? 2 : 3;
}

std::string pointsLine(const BundleAdjustment& adjustment, const std::string& unit)
{
    std::vector<double> of[3];
    double near = std::numeric_limits<double>::infinity(), far = -near;
    for (size_t i = 0; i < adjustment.points.size(); i++)
        if (adjustment.points[i].x == adjustment.points[i].x)
        {
            for (int k = 0; k < 3; k++)
                of[k].push_back(adjustment.sigma[i][k]);
            near = std::min(near, adjustment.points[i].z);
            far = std::max(far, adjustment.points[i].z);
        }
    return format("%d of %zu points, z %.4g to %.4g", adjustment.answers(), adjustment.points.size(), near, far)
        + (unit.empty() ? "" : " " + unit)
        + format("; x, y, z +- %.2g, %.2g, %.2g (median)", median(of[0]), median(of[1]), median(of[2]));
}

std::vector<std::string> namesOf(const Matches& matches, const std::vector<int>& points)
{
    std::vector<std::string> names;
    for (const int i : points)
        names.push_back(matches.names[i].text());
    return names;
}

Json jsonOf(const Correction& correction)
{
    if (!correction.estimated)
        return nullptr;
    return {{"by", correction.by}, {"std", correction.std}};
}

//! As calib.yml names it: of a dome or tube a center, of a tube an axis.
Json jsonOf(const CameraCorrection& correction, double rms)
{
    Json json = {{"rms", rms}};
    json.set(correction.name == "centre" ? "center_from_start" : "normal_from_start_deg", jsonOf(correction.place));
    if (correction.axis.estimated)
        json.set("axis_from_start_deg", jsonOf(correction.axis));
    json.set("R_from_start_deg", jsonOf(correction.R));
    json.set("T_from_start", jsonOf(correction.T));
    return json;
}

Json parametersOf(const std::vector<EstimatedParameter>& list)
{
    Json result = Json::object();
    for (const EstimatedParameter& p : list)
        result.set(p.name, {{"value", p.value}, {"std", p.std}});
    return result;
}

} // namespace

std::string pointsCsv(const Matches& matches, const BundleAdjustment& adjustment, const std::string& image)
{
    PointsCsv csv(matches.pixels.size(), matches.stds.size());
    for (size_t i = 0; i < matches.names.size(); i++)
    {
        const PointName& name = matches.names[i];
        std::vector<double> seen;
        for (const std::vector<Point2d>& ofCamera : matches.pixels)
            seen.insert(seen.end(), {ofCamera[i].x, ofCamera[i].y});
        for (const std::vector<double>& ofCamera : matches.stds)
            seen.push_back(ofCamera[i]);
        csv.add(name.image.empty() ? image : name.image, name.id, seen, adjustment.points[i], adjustment.sigma[i], adjustment.status[i]);
    }
    return csv.text();
}

std::string fittedLine(const std::string& head, const std::vector<std::string>& words)
{
    std::string line = head;
    for (size_t i = 0; i < words.size(); i++)
    {
        const std::string more = i + 1 < words.size() ? format(", and %zu more", words.size() - i - 1) : "";
        const std::string next = (i ? ", " : "") + words[i];
        if (line.size() + next.size() + more.size() > WIDTH)
            return line + (i ? format(", and %zu more", words.size() - i) : words[i].substr(0, WIDTH - line.size()));
        line += next;
    }
    return line;
}

Json adjustmentJson(const BundleAdjustment& adjustment, const BundleFindings& findings, const std::string& command,
                    const std::string& unit)
{
    Json cameras = Json::array();
    for (size_t c = 0; c < findings.corrections.size(); c++)
        cameras.append(jsonOf(findings.corrections[c], adjustment.rmsOfCamera[c]));
    return {
        {"verdict", findings.verdict()}, {"pass", findings.pass()}, {"rms", adjustment.fit.rms}, {"residual_sigma", adjustment.fit.sigma},
        {"degrees_of_freedom", adjustment.fit.dof}, {"unit", unit}, {"scale", findings.scale},
        {"points", adjustment.points.size()}, {"points_with_answer", adjustment.answers()},
        {"pixels", adjustment.seenPixels}, {"pixels_used", adjustment.usedPixels}, {"hardly_determined", findings.weak},
        {"contradictions", findings.contradictions}, {"cameras", cameras},
        {"windows", parametersOf(estimatedWindowParameters(adjustment.fit))},
        {"lenses_and_places", parametersOf(estimatedRigParameters(adjustment.fit))}, {"command", command}};
}

Json bundleJson(const Matches& matches, const BundleAdjustment& adjustment, const BundleFindings& findings, const std::string& command,
                const std::string& unit)
{
    Json json = adjustmentJson(adjustment, findings, command, unit);
    json.set("left_out", namesOf(matches, adjustment.outliers()));
    return json;
}

void printCorrections(std::ostream& out, const BundleFindings& findings, const std::string& unit)
{
    const int shown = shownCameras(findings), cameras = (int)findings.corrections.size();
    out << "found off the start (degrees, " << (unit.empty() ? "units of length" : unit)
        << (cameras > shown ? "), the camera that is known least:\n" : "):\n");
    for (int c = 0; c < cameras && cameras <= shown; c++)
        out << cameraLines(findings, c);
    if (cameras > shown)
        out << cameraLines(findings, worstCamera(findings));
}

void printBundle(std::ostream& out, const Matches& matches, const BundleAdjustment& adjustment, const BundleFindings& findings,
                 const std::string& unit)
{
    const Fit& fit = adjustment.fit;
    out << findings.verdict()
        << format(": %.3g px RMS, noise %.3g px a coordinate, %.0f degrees of freedom\n", fit.rms, fit.sigma, fit.dof);
    out << fittedLine("scale: ", {findings.scale}) << "\n";
    printCorrections(out, findings, unit);
    out << pointsLine(adjustment, unit) << "\n";
    if (adjustment.usedPixels < adjustment.seenPixels)
        out << format("pixels left out: %d of %d\n", adjustment.seenPixels - adjustment.usedPixels, adjustment.seenPixels);
    const std::vector<int> outliers = adjustment.outliers();
    if (!outliers.empty())
        out << fittedLine("wrong matches: ", namesOf(matches, outliers)) << "\n";
    if (!findings.weak.empty())
        out << fittedLine("hardly determined: ", findings.weak) << "\n";
}

} // namespace tools
