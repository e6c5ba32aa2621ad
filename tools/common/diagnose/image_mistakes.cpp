// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/image_mistakes.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "diagnose/plain_fit.hpp"
#include "diagnose/calibration_input.hpp"
#include "diagnose/image_disagreement.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cctype>
#include <map>
#include <set>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! @param only of this camera; -1: of all
RigData exchanged(const RigData& given, int only)
{
    RigData data = given;
    exchangeStates(data.views, only);
    return data;
}

enum Mirror { POINTS, ROWS, COLUMNS };

//! @param only camera; negative: all, with what they have of direct images and of those through the window
RigData mirroredData(const RigData& given, Mirror mirror, int only)
{
    RigData data = given;
    for (View& view : data.views)
    {
        for (cv::Point3d& X : view.objectPoints)
            X.x *= mirror == POINTS ? -1. : 1.;
        for (int c = 0; c < data.cameraCount; c++)
            for (std::vector<cv::Point2d>* pixels : {&view.direct[c], &view.glass[c]})
                for (cv::Point2d& p : *pixels)
                    if (only < 0 || only == c)
                        p = undone({mirror == COLUMNS, mirror == ROWS, false}, p, data.imageSize[c]);
    }
    return data;
}

//! Runs of digits, of letters, and of what is neither.
std::vector<std::string> runsOf(const std::string& name)
{
    const auto kind = [](unsigned char c) { return std::isdigit(c) ? 0 : std::isalpha(c) ? 1 : 2; };
    std::vector<std::string> runs;
    for (size_t i = 0; i < name.size(); i++)
    {
        if (i == 0 || kind(name[i]) != kind(name[i - 1]))
            runs.emplace_back();
        runs.back() += name[i];
    }
    return runs;
}

//! What tells a camera: one run of a name, with a word before it.
std::string cameraIn(const std::vector<std::string>& runs, size_t run)
{
    const bool hasWord = run > 0 && std::isalpha((unsigned char)runs[run - 1][0]);
    const size_t begin = hasWord ? run - 1 : run;
    return (begin > 0 ? "..." : "") + (hasWord ? runs[begin] : "") + runs[run] + (run + 1 < runs.size() ? "..." : "");
}

//! Views by one run of their names, if those of each are alike but for it: cam1_3, cam2_3, ... Empty: they are not of this form.
std::map<std::string, std::vector<View>> byCameraInName(const std::vector<View>& views, size_t run)
{
    std::map<std::string, std::vector<View>> cameras;
    std::map<std::string, std::set<std::string>> rests;
    for (const View& view : views)
    {
        std::vector<std::string> runs = runsOf(view.stem);
        if (runs.size() <= run)
            return {};
        const std::string key = "'" + cameraIn(runs, run) + "'";
        std::string rest;
        for (size_t i = 0; i < runs.size(); i++)
            rest += i == run ? "*" : runs[i];
        cameras[key].push_back(view);
        rests[key].insert(rest);
    }
    for (const auto& [key, rest] : rests)
        if (rests.size() < 2 || rests.size() > MAX_CAMERAS || rest.size() < 3 || rest != rests.begin()->second)
            return {};
    return cameras;
}

Explanation better(const Explanation& a, const Explanation& b) { return b.px < a.px ? b : a; }

const double MOST = 0.8;                // of the pairs that are apart
const double WHOLE_SQUARES = 0.25;      // of a shift remains if it is one by whole squares

struct PairShift
{
    Point shift;                //!< by how many rows and columns the glass image shows another part of the board than the direct one
    bool isApart;               //!< by more than half a square, however that comes
};

PairShift shiftOfPair(const CalibrationInput& input, const View& view, int camera)
{
    std::vector<Point2d> board, direct, glass;
    if (view.neighbours.empty())        // no board
        return {};
    for (size_t i = 0; i < view.objectPoints.size(); i++)
        if (seen(view.direct[camera][i]) && seen(view.glass[camera][i]))
        {
            board.emplace_back(view.objectPoints[i].x, view.objectPoints[i].y);
            direct.push_back(view.direct[camera][i]);
            glass.push_back(view.glass[camera][i]);
        }
    const Mat H = board.size() < 4 ? Mat() : findHomography(board, direct);
    if (H.empty())
        return {};
    const auto offBy = [&](Point shift) {
        std::vector<Point2d> moved, there;
        for (const Point2d& p : board)
            moved.push_back(p + input.square*Point2d(shift));
        perspectiveTransform(moved, there, H);
        std::vector<double> lengths;
        for (size_t i = 0; i < there.size(); i++)
            lengths.push_back(norm(there[i] - glass[i]));
        return median(lengths);
    };
    Point best;
    for (int x = -2; x <= 2; x++)
        for (int y = -2; y <= 2; y++)
            if (offBy(Point(x, y)) < WHOLE_SQUARES*offBy(best))
                best = Point(x, y);
    std::vector<Point2d> ends, there;
    for (const Point2d& p : board)
        ends.push_back(p + 0.5*input.square*Point2d(1, 0));
    perspectiveTransform(ends, there, H);
    std::vector<double> halves;
    for (size_t i = 0; i < there.size(); i++)
        halves.push_back(norm(there[i] - direct[i]));
    return {best, best != Point() || offBy(Point()) > median(halves)};
}

} // namespace

Explanation swappedStates(const CalibrationInput& input)
{
    return {"--direct and --glass exchanged", medianErrorOfFit(exchanged(input.data, -1), input.options)};
}

Explanation swappedStatesOfOneCamera(const CalibrationInput& input)
{
    Explanation best{"", NO_FIT};
    for (int c = 0; c < input.data.cameraCount; c++)
    {
        const std::string suffix = cameraSuffix(c);
        best = better(best, {"--direct" + suffix + " and --glass" + suffix + " exchanged",
                             medianErrorOfFit(exchanged(input.data, c), input.options)});
    }
    return best;
}

Explanation unrelatedViews(const CalibrationInput& input)
{
    double worst = 0.;
    for (int c = 0; c < input.data.cameraCount; c++)
    {
        const CalibrationInput one = oneCamera(input, c);
        worst = std::max(worst, medianErrorOfFit(one.data, one.options));
    }
    return {"each camera calibrated alone, so equal names of " + std::string(input.data.cameraCount == 2 ? "camera 1 and camera 2"
            : "different cameras") + " are not the same moment (or the cameras moved to each other)", worst};
}

Explanation mirroredPoints(const CalibrationInput& input)
{
    Explanation best{"", NO_FIT};
    const auto attempt = [&](Mirror mirror, int camera, const std::string& sentence) {
        best = better(best, {sentence, medianErrorOfFit(mirroredData(input.data, mirror, camera), input.options)});
    };
    for (Mirror mirror : {POINTS, ROWS})
        attempt(mirror, -1, "the points mirrored: x, y, z are in a left-handed frame (one axis turned round, or two columns "
                "exchanged), or u or v is counted from the other side");
    const int cameras = input.data.cameraCount;
    for (int c = 0; c < cameras && cameras > 1 && cameras <= MAX_SWAPPED_CAMERAS; c++)
        for (Mirror mirror : {ROWS, COLUMNS})
            attempt(mirror, c, format("u or v of camera %d counted from the other side: its images are mirrored to those of the "
                                      "others", c + 1));
    return best;
}

Explanation imagesOfOtherMoments(const CalibrationInput& input)
{
    Explanation best{"", NO_FIT};
    for (int c = 0; c < input.data.cameraCount; c++)
        for (bool glass : {true, false})
        {
            RigData data = input.data;
            data.views.clear();
            for (bool isAlone : {false, true})
                for (const View& view : input.data.views)
                    addPart(view, [=](int k, bool through) { return (k == c && through == glass) == isAlone; }, data.views);
            if (pairsFromOneMap(data) > WINDOWS_PX || camerasApart(data, input.options) > MOMENTS_PX)
                continue;       // another is wrong, or not only this one
            const std::string option = (glass ? "--glass" : "--direct") + cameraSuffix(c);
            best = better(best, {"each " + option + " image fitted alone, so equal names of " + option + " and of the other options are "
                                 "not the same moment (another order of files, or the board moved)",
                                 medianErrorOfFit(data, input.options)});
        }
    return best;
}

namespace {

//! @param groups name and images of each camera
Explanation calibratedApart(const CalibrationInput& input, const std::map<std::string, std::vector<View>>& groups)
{
    const bool hasDirect = std::any_of(input.data.views.begin(), input.data.views.end(), [](const View& v) { return v.hasDirect(0); });
    const std::string options = hasDirect ? "--direct='...', --glass='...', --direct2='...', --glass2='...'"
                                          : "--glass='...', --glass2='...'";
    std::string sentence;
    double worst = 0.;
    for (const auto& [name, views] : groups)
    {
        RigData data = input.data;
        data.views = views;
        worst = std::max(worst, medianErrorOfFit(data, input.options));
        sentence += (sentence.empty() ? "those of " : " and of ") + name;
    }
    if (groups.size() < 2)
        return {"", NO_FIT};
    return {sentence + " calibrated apart, so they are of several cameras, or something changed between them: give each camera its own ("
            + options + ")", worst};
}

} // namespace

Explanation camerasInOneFolder(const CalibrationInput& input)
{
    const size_t runs = input.data.views.empty() ? 0 : runsOf(input.data.views[0].stem).size();
    Explanation best{"", NO_FIT};
    for (size_t run = 0; run < runs && input.data.cameraCount == 1; run++)
        best = better(best, calibratedApart(input, byCameraInName(input.data.views, run)));
    return best;
}

Explanation pairsOfTwoCameras(const CalibrationInput& input)
{
    std::map<std::string, std::vector<View>> groups;
    for (const std::vector<int>& group : input.data.cameraCount == 1 ? pairsOfTwoMaps(input.data, 0) : std::vector<std::vector<int>>())
    {
        std::vector<View> views;
        std::vector<std::string> names;
        for (int i : group)
        {
            views.push_back(input.data.views[i]);
            names.push_back(input.data.views[i].stem);
        }
        groups[listed(names)] = views;
    }
    return calibratedApart(input, groups);
}

Explanation oddImages(const CalibrationInput& input)
{
    RigData data = input.data;
    std::string names;
    for (int c = 0; c < data.cameraCount; c++)
        for (int i : pairsOffMap(input.data, c))
        {
            data.views[i].glass[c].clear();
            names += (names.empty() ? "" : ", ") + std::string("--glass") + cameraSuffix(c) + " '" + data.views[i].stem + "'";
        }
    if (names.empty())
        return {"", NO_FIT};
    return {names + " left out, in which the board is elsewhere than in the --direct image of that name: it was moved, or one of the two "
            "is turned, mirrored or of another name", medianErrorOfFit(data, input.options)};
}

Explanation unpairedImages(const CalibrationInput& input)
{
    RigData data = input.data;
    data.views.clear();
    for (const View& view : input.data.views)
        for (bool glass : {true, false})
            addPart(view, [=](int, bool through) { return through == glass; }, data.views);
    return {"each image fitted alone, so equal names of --direct and --glass are not one place of the board (it moved, or it "
            "was hand-held: --unpaired)", medianErrorOfFit(data, input.options)};
}

std::string partOfBoard(const CalibrationInput& input, size_t fewest)
{
    int pairs = 0, apart = 0, shifted = 0;
    std::set<const View*> views;
    for (const View& view : input.data.views)
        for (int c = 0; c < input.data.cameraCount; c++)
            if (view.isPair(c))
            {
                pairs++;
                const PairShift pair = shiftOfPair(input, view, c);
                apart += pair.isApart;
                shifted += pair.shift != Point();
                if (pair.shift != Point())
                    views.insert(&view);
            }
    // Pairs of different moments are apart by anything, now and then by whole squares.
    if (views.size() < fewest || shifted < MOST*apart)
        return "";
    return format("in %d of %d pairs the two images show the board a whole row or column apart, so --size is smaller than the board: "
                  "count the inner corners (dots)", shifted, pairs);
}

double errorOfDirect(const CalibrationInput& input, int camera)
{
    const std::vector<View>& views = input.data.views;
    if (input.options.known[camera] || std::none_of(views.begin(), views.end(), [&](const View& v) { return !v.direct[camera].empty(); }))
        return 0.;
    try
    {
        std::vector<LensSource> sources;
        const CalibrationInput one = oneCamera(input, camera);
        startModel(one.data, one.options, sources);
        return sources[0].rms;
    }
    catch (const std::exception&)       // told elsewhere
    {
        return 0.;
    }
}

std::string badCorners(const CalibrationInput& input)
{
    for (int c = 0; c < input.data.cameraCount; c++)
    {
        const double px = errorOfDirect(input, c);
        if (px > largestSoundError(oneCamera(input, c).data))
            return format("already the direct images of camera %d, without any window, do not fit a lens (%.1f px): the "
                          "target is not as --pattern and --size say, or its points were found wrongly", c + 1, px);
    }
    return "";
}

} // namespace tools
