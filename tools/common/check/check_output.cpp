// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "check/check_output.hpp"
#include "calibrate/window_face.hpp"
#include "console/lines.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <iostream>

using namespace cv::refract;

namespace tools {
namespace {

const size_t SCREEN = 80;               // columns

Json jsonOf(const NamedChange& change)
{
    Json value = Json::array(), std = Json::array(), unit = Json::array(), axes = Json::array();
    for (const ChangedValue& changed : change.values)
    {
        value.append(changed.value);
        std.append(changed.std);
        unit.append(changed.unit);
        for (const ValueAboutAxis& about : changed.aboutAxes)
            axes.append({{"axis", about.axis}, {"value", about.value}, {"std", about.std}});
    }
    return {{"name", change.name}, {"camera", change.camera >= 0 ? Json(change.camera + 1) : Json()}, {"value", value}, {"std", std},
            {"unit", unit}, {"about_axes", axes}, {"p", change.probability}, {"text", change.sentence}};
}

//! What is not to be told is nan, which is null in the file.
Json jsonOf(const WindowCheck& w, double power)
{
    Json json = {{"camera", w.camera + 1}, {"moved", w.moved}};
    if (w.lengthPerDegree > 0.)
    {
        json.set("center_moved_by", w.lengthPerDegree*w.tiltDeg);
        json.set("center_std", Json::array({w.lengthPerDegree*w.stdDeg[0], w.lengthPerDegree*w.stdDeg[1]}));
        json.set("center", Json::array({w.center[0], w.center[1], w.center[2]}));
    }
    else
    {
        json.set("tilt_deg", w.tiltDeg);
        json.set("tilt_std_deg", Json::array({w.stdDeg[0], w.stdDeg[1]}));
        json.set("normal", Json::array({w.normal[0], w.normal[1], w.normal[2]}));
    }
    json.set("probability_if_unchanged", w.probability);
    json.set("detection_probability", power);
    return json;
}

void printLines(const std::string& text)
{
    for (const std::string& line : brokenInto(text, SCREEN, "", LongWords::WHOLE))
        std::cout << line << '\n';
}

void printCause(const CheckResult& result)
{
    if (result.changes.empty())
        printLines("No single change explains the new images: were camera, window, board or the order of the images others?");
    else
        printLines(causesIn(result) + (!result.explained ? "." : result.changes.size() == 1 ? "; nothing else" : ""));
    if (!result.changes.empty() && !result.explained)
        printLines("This does not explain all: more than one thing changed, or one that is not in the list (--help). "
                   + format("What is left is %.3g px, the noise %.3g px.", result.sigmaSeen, result.sigma));
    std::cout << '\n';
}

void printTurns(const CheckResult& result, const CheckOptions& o)
{
    Table table({"", "+- deg (worst axis)", "chance if unchanged", format("would show %g deg", o.detect)}, SCREEN);
    for (const TurnCheck& turn : result.turns)
        table.add({turn.name.substr(0, turn.name.rfind(" changed")), format("%.2g", turn.stdDeg), format("%.2g", turn.probability),
                   format("%.1f %%", 100.*powerOf(turn, result, o.detect))});
    if (!result.turns.empty())
        table.print(std::cout);
    std::cout << '\n';
}

//! Of how many matches, and what these cannot tell.
void printScene(const SceneMatches& matches, bool isPair)
{
    std::cout << '\n';
    printLines(format("%d matches of %d moment%s; %d more left out as no point explains them, about %.0f wrong ones among the "
                      "rest.", matches.good.size(), matches.moments, matches.moments == 1 ? "" : "s", matches.leftOut, matches.wrongLeft));
    printLines(std::string("No scene shows a turn of the whole rig, or another scale")
               + (isPair ? ", or which of two cameras turned about the line between them." : "."));
}

} // namespace

Json checkJson(const CheckResult& result, const CheckOptions& o, const CheckInput& input, const std::string& verdict,
               const std::string& why)
{
    Json windows = Json::array(), changes = Json::array();
    for (const WindowCheck& w : result.windows)
        windows.append(jsonOf(w, powerOf(w, result, o.detect)));
    for (const NamedChange& change : result.changes)
        changes.append(jsonOf(change));
    Json turns = Json::array();
    for (const TurnCheck& turn : result.turns)
        turns.append({{"camera", turn.camera + 1}, {"name", turn.name}, {"std_deg", turn.stdDeg},
                      {"probability_if_unchanged", turn.probability}, {"detection_probability", powerOf(turn, result, o.detect)}});
    std::vector<int> mayHaveTurned;
    for (int camera : result.mayHaveTurned)
        mayHaveTurned.push_back(camera + 1);
    return {
        {"verdict", verdict}, {"why", why}, {"windows", windows}, {"turns", turns}, {"changes", changes},
        {"may_have_turned", mayHaveTurned}, {"explained", result.explained},
        {"false_alarm", o.falseAlarm}, {"detect_deg", o.detect}, {"sigma_px", input.sigma}, {"sigma_seen_px", result.sigmaSeen}};
}

void printCheck(const CheckResult& result, const CheckOptions& o, const CheckInput& input, const CheckImages& images)
{
    if (result.changed)
        printCause(result);
    if (o.isOfScene())
        printTurns(result, o);
    const bool anyCentre = std::any_of(result.windows.begin(), result.windows.end(), [](const auto& w) { return w.lengthPerDegree > 0.; });
    Table table({"", anyCentre ? "moved" : "tilt, deg", "+- (two principal)", "chance if unchanged", format("would show %g deg", o.detect),
                 ""}, SCREEN);
    for (const WindowCheck& w : result.windows)
    {
        const bool isCentre = w.lengthPerDegree > 0.;
        const double factor = isCentre ? w.lengthPerDegree : 1.;
        table.add({format("%s of camera %d", isCentre ? nameOfShape(input.rig.cameras[w.camera]->window()) : "window", w.camera + 1),
                   w.tiltDeg == w.tiltDeg ? format("%.4f", factor*w.tiltDeg) : "-",
                   format("%.2g, %.2g", factor*w.stdDeg[0], factor*w.stdDeg[1]), format("%.2g", w.probability),
                   format("%.1f %%", 100.*powerOf(w, result, o.detect)),
                   w.moved ? "moved" : result.changed ? "not the cause" : "no sign of it"});
    }
    if (!result.windows.empty())
        table.print(std::cout);
    std::cout << '\n';
    const std::string known = o.isOfScene() ? "" : format(", %.4f px in the calibration", input.sigma);
    printLines(format("Noise of a pixel coordinate: %.4f px here", result.sigmaSeen) + known
               + format(". False alarms: %g%s.", o.falseAlarm, o.hasHistory() ? ", of the charts and this check together" : ""));
    if (o.isOfScene())
        printScene(images.scene, input.rig.cameras.size() == 2);
}

} // namespace tools
