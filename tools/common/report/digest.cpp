// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/summary.hpp"
#include "assess/advice.hpp"
#include "assess/rig_calibration.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>
#include <ostream>

using Lines = std::vector<std::string>;

namespace tools {

namespace {

const size_t LEAST_OF_REASON = 2;       // lines, where there are many reasons

Lines broken(const std::string& text, const std::string& indent = "  ")
{
    return brokenInto(text, DIGEST_COLUMNS, indent, LongWords::BROKEN);
}

void append(Lines& lines, const Lines& more) { lines.insert(lines.end(), more.begin(), more.end()); }

//! As many of what may be so, one or the other, as there is room for: none is cut if the first fits.
Lines alternativesWithin(const std::string& reason, size_t room)
{
    const std::string OR = "; or ";
    size_t end = reason.size();
    for (int left = 0; end != std::string::npos; left++)
    {
        const std::string rest = left == 0 ? "" : OR + std::to_string(left) + (left == 1 ? " other cause" : " other causes");
        const Lines lines = broken("- " + reason.substr(0, end) + rest + ".");
        if (lines.size() <= room)
            return lines;
        end = end == 0 ? std::string::npos : reason.rfind(OR, end - 1);
    }
    return firstOf(broken("- " + reason + "."), room, DIGEST_COLUMNS);
}

//! As many reasons as there is room for, and how many more there are.
Lines reasonsWithin(const Lines& reasons, size_t room)
{
    Lines lines;
    const size_t each = std::max(LEAST_OF_REASON, room/std::max<size_t>(1, reasons.size()));
    for (size_t i = 0; i < reasons.size(); i++)
    {
        const size_t kept = i + 1 < reasons.size() ? 1 : 0;     // for what may not fit after it
        const size_t most = room > lines.size() + kept ? room - lines.size() - kept : 0;
        const Lines next = i == 0 ? alternativesWithin(reasons[i], most) : firstOf(broken("- " + reasons[i] + "."), each, DIGEST_COLUMNS);
        if (most == 0 || next.size() > most)
        {
            lines.push_back(format("- and %zu more: --verbose", reasons.size() - i));
            break;
        }
        append(lines, next);
    }
    return lines;
}

//! What stands against the result.
Lines reasonsOf(const Findings& f)
{
    Lines reasons = f.contradictions;
    for (const LimitCheck& limit : f.limits)
        if (!limit.met())
            reasons.push_back(limit.sentence());
    append(reasons, f.weak);
    return reasons;
}

std::string metLimits(const Findings& f)
{
    std::string text;
    for (const LimitCheck& limit : f.limits)
        if (limit.met())
            text += (text.empty() ? "Met: " : ", ") + limit.option + format(" (%.3g %s)", limit.value, limit.unit.c_str());
    return text;
}

std::string heldOutBoards(const RigCalibration& c)
{
    const HeldOut& h = c.heldOut;
    if (!h.folds || std::isnan(h.px))
        return "";
    return format("Held-out boards: seen within %.3f px RMS", h.px)
        + (std::isnan(h.lengthRms) ? "" : format(", lengths right within %.2g %s", h.lengthRms, c.unit.c_str()));
}

//! Tilts of windows, or how far cameras are from the centres of domes.
std::string places(const RigCalibration& c)
{
    const size_t FEW = 4;
    Lines windows;
    for (int k = 0; k < c.data.cameraCount; k++)
        if (c.fit.rig.ownsWindow(k))
            windows.push_back(placeInWords(c, k));
    const bool isOne = windows.size() == 1;
    std::string text = isOne ? "The window is tilted by " : "The windows are tilted by ";
    if (const std::optional<RoundWindow> round = roundWindowOf(c, 0))
    {
        const std::string middle = round->shape == "dome" ? "centre" : "axis";
        if (isOne && c.data.cameraCount == 1)
            return "The " + round->shape + "'s " + middle + " is " + round->offsetWords(c.unit);
        text = isOne ? "The " + round->shape + "'s " + middle + ": " + "camera 1 is off it by "
                     : "The cameras are off the " + middle + "s of their " + round->shape + "s by ";
    }
    for (size_t i = 0; i < std::min(FEW, windows.size()); i++)
        text += (i ? ", " : "") + windows[i];
    return text + (windows.size() > FEW ? ", ..." : "");
}

/** What a tape measure can check, and a wrong square, unit or thickness shows in: how far cameras are apart, and windows before them. The
boards' range is in the line of errors. */
std::string tapeMeasures(const RigCalibration& c)
{
    const size_t FEW = 3;
    Lines apart, away;
    for (int k = 0; k < c.data.cameraCount; k++)
    {
        const cv::refract::GlassWindow window = c.fit.rig.cameras[k]->window();
        if (k > 0)
            apart.push_back(format("%.4g", cv::norm(c.fit.rig.extrinsics[k].t)));
        if (!isRound(window) && hasDifferentMedia(window))
            away.push_back(format("%.4g", window.distance));
    }
    const auto listOf = [FEW](const Lines& numbers) {
        std::string list;
        for (size_t i = 0; i < std::min(FEW, numbers.size()); i++)
            list += (i ? ", " : "") + numbers[i];
        return list + (numbers.size() > FEW ? ", ..." : "");
    };
    std::string text;
    if (!apart.empty())
        text = (apart.size() > 1 ? "cameras are " : "camera 2 is ") + listOf(apart) + " " + c.unit + " from camera 1";
    if (!away.empty())
        text += (text.empty() ? "" : ", ") + std::string(away.size() > 1 ? "windows are " : "the window is ") + listOf(away)
            + (text.empty() ? " " + c.unit : "") + " before " + (c.data.cameraCount > 1 ? "their cameras" : "the camera");
    return text.empty() ? "" : "Check by tape measure: " + text;
}

std::string leftOut(const RigCalibration& c)
{
    int points = 0;
    const std::vector<Rejected> all = rejectedOf(c);
    for (const Rejected& rejected : all)
        points += rejected.points;
    std::string text;
    if (points)
        text = format("Left out: %d point%s of %zu image%s", points, points == 1 ? "" : "s", all.size(), all.size() == 1 ? "" : "s");
    const size_t without = c.withoutTarget.size();
    if (without)
        text += (text.empty() ? "No target in " : "; no target in ") + format("%zu image%s", without, without == 1 ? "" : "s");
    return text;
}

struct Fact
{
    std::string text;       //!< may be empty
    int worth;              //!< of two, that of more worth is printed if there is room for one
};

//! In their order.
Lines factsWithin(const std::vector<Fact>& facts, size_t room)
{
    std::vector<size_t> byWorth(facts.size());
    std::iota(byWorth.begin(), byWorth.end(), 0);
    std::sort(byWorth.begin(), byWorth.end(), [&](size_t a, size_t b) { return facts[a].worth > facts[b].worth; });
    std::vector<Lines> chosen(facts.size());
    for (size_t i : byWorth)
    {
        const Lines lines = facts[i].text.empty() ? Lines() : broken(facts[i].text);
        if (lines.size() > room)
            continue;
        room -= lines.size();
        chosen[i] = lines;
    }
    Lines all;
    for (const Lines& lines : chosen)
        append(all, lines);
    return all;
}

} // namespace

//! "0.26 mm at z = 490.7 mm, 0.33 at 628.1, 0.38 at 718": the worst point at the nearest, the middle and the farthest board.
static std::string errorAtThreeRanges(const RigCalibration& c, const Assessment& a)
{
    std::string text;
    for (size_t i = 1; i <= 3 && i < a.errors.size(); i++)
    {
        const ErrorMap& map = a.errors[i];
        const std::string unit = text.empty() ? " " + c.unit : "";
        text += (text.empty() ? "" : ", ") + (map.seen() ? format("%.2g", map.worst()) + unit : "nothing seen")
            + (text.empty() ? " at z = " : " at ") + format("%.4g", map.range) + unit;
    }
    return text;
}

void printDigest(std::ostream& out, const RigCalibration& c, const Assessment& a, const Findings& f, const std::string& report)
{
    const Lines head = broken(f.verdict());
    Lines tail;
    std::vector<Fact> facts;
    if (f.contradictions.empty())       // they make numbers of it wrong
    {
        append(tail, broken("A measured point: +- " + errorAtThreeRanges(c, a)));
        append(tail, broken(std::string("  (one standard deviation, ") + (c.data.cameraCount > 1 ? "3-D" : "plane square to the camera")
                            + ", worst point of the image)"));
        facts = {{metLimits(f), 5}, {heldOutBoards(c), 3}, {leftOut(c), 1}, {places(c), 2}, {tapeMeasures(c), 4}};
    }
    append(tail, firstOf(broken("Next: " + nextStep(c, a, f) + "."), 3, DIGEST_COLUMNS));
    append(tail, firstOf(broken("More: --verbose, " + (report.empty() ? "--report=report.html" : report)), 1, DIGEST_COLUMNS));

    size_t room = DIGEST_LINES - std::min(DIGEST_LINES, head.size() + tail.size());
    const Lines reasons = reasonsWithin(reasonsOf(f), room);
    room -= std::min(room, reasons.size());
    for (const std::string& line : head)
        out << toned(out, line, f.tone()) << '\n';
    for (const std::string& line : reasons)
        out << line << '\n';
    for (const std::string& line : factsWithin(facts, room))
        out << line << '\n';
    for (const std::string& line : tail)
        out << line << '\n';
}

} // namespace tools
