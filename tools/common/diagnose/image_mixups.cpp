// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/image_mixups.hpp"
#include "diagnose/calibration_input.hpp"
#include "diagnose/plain_fit.hpp"
#include "diagnose/image_disagreement.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <functional>

using namespace cv;

namespace tools {

namespace {

const double CLEARLY_BETTER = 0.5;      // what is left of the disagreements, at most
const double NOT_WORSE = 1.5;           // any of them
const double AS_GOOD = 1.3;             // as the least that any leaves

enum Change { HALF_TURN, MIRROR, QUARTER_TURN, BACK_TURN, CHANGES };
const ImageTurn TURNS[] = {{true, true, false}, {true, false, false}, {false, true, true}, {true, false, true}};     // of Change

//! Of the directions along the rows and the columns of two images of a board.
double agreement(const View& view, const std::vector<Point2d>& a, const std::vector<Point2d>& b)
{
    double sum = 0.;
    for (const auto& pair : view.neighbours)
    {
        const Point2d along = a[pair.second] - a[pair.first], other = b[pair.second] - b[pair.first];
        if (seen(along) && seen(other))
            sum += along.dot(other);
    }
    return sum;
}

std::vector<Point2d> inOrder(const std::vector<int>& order, const std::vector<Point2d>& pixels)
{
    std::vector<Point2d> ordered;
    for (int i : order)
        ordered.push_back(pixels[i]);
    return ordered;
}

//! A detector names the corners of a changed image by what it looks like: names them as in another image of the view.
void nameAs(const View& view, const std::vector<Point2d>& reference, std::vector<Point2d>& pixels)
{
    double best = -1e300;
    std::vector<Point2d> named = pixels;
    for (int flips = 0; flips < 4; flips++)
    {
        const std::vector<int> order = renumbered(view.objectPoints, {(flips & 1) != 0, (flips & 2) != 0, false});
        if (order.empty())
            continue;
        const std::vector<Point2d> candidate = inOrder(order, pixels);
        const double value = agreement(view, reference, candidate);
        if (value > best)
        {
            best = value;
            named = candidate;
        }
    }
    pixels = named;
}

//! Another image of a view that is as it was; null: none.
const std::vector<Point2d>* referenceOf(const View& view, int cameras, int camera, bool directToo)
{
    if (!directToo && view.hasDirect(camera))
        return &view.direct[camera];
    for (int c = 0; c < cameras; c++)
        for (const std::vector<Point2d>* pixels : {&view.direct[c], &view.glass[c]})
            if (c != camera && !pixels->empty())
                return pixels;
    return nullptr;
}

RigData changedBack(const RigData& given, Change change, int camera, bool directToo)
{
    RigData data = given;
    const Size size = data.imageSize[camera];
    for (View& view : data.views)
    {
        const std::vector<Point2d>* reference = referenceOf(view, data.cameraCount, camera, directToo);
        for (std::vector<Point2d>* pixels : {&view.direct[camera], &view.glass[camera]})
        {
            if (pixels->empty() || (!directToo && pixels == &view.direct[camera]))
                continue;
            for (Point2d& p : *pixels)
                p = undone(TURNS[change], p, size);
            if (view.neighbours.empty())        // points that have names of their own
                continue;
            if (reference)
                nameAs(view, *reference, *pixels);
            else if (change == MIRROR)
            {
                const std::vector<int> order = renumbered(view.objectPoints, {true, false, false});
                if (!order.empty())
                    *pixels = inOrder(order, *pixels);
            }
        }
    }
    return data;
}

//! The images of all cameras through their windows.
RigData changedBack(const RigData& given, Change change)
{
    RigData data = given;
    for (int camera = 0; camera < data.cameraCount; camera++)
        data = changedBack(data, change, camera, false);
    return data;
}

//! Numbers of points as if they had been counted from another corner.
RigData numberedBack(const RigData& given, const ImageTurn& by, int camera, ImageState state)
{
    RigData data = given;
    for (View& view : data.views)
    {
        const std::vector<int> order = renumbered(view.objectPoints, by);
        for (ImageState of : {DIRECT_IMAGES, GLASS_IMAGES})
        {
            std::vector<Point2d>& pixels = (of == DIRECT_IMAGES ? view.direct : view.glass)[camera];
            if (!order.empty() && !pixels.empty() && (state == ALL_IMAGES || state == of))
                pixels = inOrder(order, pixels);
        }
    }
    return data;
}

struct Numbering
{
    ImageTurn turn;
    const char* words;
};
const Numbering NUMBERINGS[] = {{{true, true, false}, "from the opposite corner, turned by 180 degrees"},
                                {{true, false, false}, "from the other end of each row, mirrored"},
                                {{false, true, false}, "from the other end of each column, mirrored"}};

std::string sentenceOf(const Numbering& numbering, int camera, ImageState state)
{
    const std::string direct = "--direct" + cameraSuffix(camera), glass = "--glass" + cameraSuffix(camera);
    return "the points of " + (state == ALL_IMAGES ? direct + " and " + glass : state == DIRECT_IMAGES ? direct : glass) + " numbered "
        + numbering.words + ", unlike those of the other images";
}

struct Candidate
{
    MixUp mixUp;
    double left;                //!< product of the disagreements
    bool isClear;
};

//! What is less than the doing of windows does not count.
double product(const Disagreements& all)
{
    double result = 1.;
    for (const std::vector<double>& kind : all.kinds())
        for (double px : kind)
            result *= px + WINDOWS_PX;
    return result;
}

//! Whether the worst camera, the next and so on have more: which camera it is may be what was wrong.
bool isWorse(std::vector<double> before, std::vector<double> after)
{
    std::sort(before.begin(), before.end());
    std::sort(after.begin(), after.end());
    for (size_t i = 0; i < before.size(); i++)
        if (after[i] > NOT_WORSE*before[i] + WINDOWS_PX)
            return true;
    return false;
}

bool isNowhereWorse(const Disagreements& before, const Disagreements& after)
{
    const std::vector<std::vector<double>> was = before.kinds(), is = after.kinds();
    for (size_t kind = 0; kind < was.size(); kind++)
        if (isWorse(was[kind], is[kind]))
            return false;
    return true;
}

const char* const WORDS[] = {"turned by 180 degrees", "mirrored", "turned by 90 degrees", "turned by 90 degrees"};    // of Change

std::string sentenceOf(Change change, const RigData& data, int camera, bool directToo)
{
    if (directToo)
        return "the images" + ofCamera(camera, data.cameraCount) + " are " + WORDS[change] + " to those of the other cameras";
    const bool hasPairs = data.countPairs(camera) > 0;
    return "the --glass" + cameraSuffix(camera) + " images are " + WORDS[change]
        + (hasPairs ? " to the --direct" + cameraSuffix(camera) + " images" : " to those of the other cameras");
}

} // namespace

MixUps findMixUps(const CalibrationInput& input)
{
    const RigData& data = input.data;
    const RoughLenses lenses = roughLensesOf(data);
    BoardPoses poses;
    const Disagreements before = disagreementsOf(data, input.options, lenses, poses);
    if (!(before.largest() > WINDOWS_PX))
        return {};
    std::vector<Candidate> candidates;
    double least = NO_FIT;
    const auto attempt = [&](const std::vector<int>& cameras, const std::function<RigData()>& undone, const RoughLenses& now,
                             const std::string& sentence) {
        Disagreements after = before;
        update(undone(), input.options, now, cameras, poses, after);
        if (!isNowhereWorse(before, after))
            return;
        const double left = product(after);
        candidates.push_back({{sentence, undone, after.camerasApart()}, left, left < CLEARLY_BETTER*product(before)});
        least = std::min(least, left);
    };
    const std::vector<int> all = allCameras(data);
    const auto attemptExchange = [&](const std::vector<int>& cameras, const std::function<void(std::vector<View>&)>& exchange,
                                     const RoughLenses& now, const std::string& sentence) {
        attempt(cameras, [exchange, &data] {
            RigData undone = data;
            exchange(undone.views);
            return undone; }, now, sentence); };
    attemptExchange(all, [](std::vector<View>& views) { exchangeStates(views, -1); }, {lenses.glass, lenses.direct},
                    "--direct and --glass exchanged");
    for (int b = 1; b < data.cameraCount; b++)
        for (int a = 0; a < b; a++)
            for (ImageState state : {GLASS_IMAGES, DIRECT_IMAGES})
            {
                if (!hasImages(data.views, a, state) && !hasImages(data.views, b, state))
                    continue;
                const char* const option = state == DIRECT_IMAGES ? "--direct" : "--glass";
                RoughLenses now = lenses;
                PerCamera<Matx33d>& exchanged = state == DIRECT_IMAGES ? now.direct : now.glass;
                std::swap(exchanged[a], exchanged[b]);
                attemptExchange({a, b}, [=](std::vector<View>& views) { exchangeCameras(views, a, b, state); }, now,
                                option + cameraSuffix(a) + " and " + option + cameraSuffix(b) + " exchanged");
            }
    // Of one camera by itself, before which boards are held by hand, turned images are as good as others: the window turns with them.
    const auto mayBe = [&](int change, int camera) {
        return change <= MIRROR || data.imageSize[camera].width == data.imageSize[camera].height; };
    for (int camera = 0; camera < data.cameraCount; camera++)
        for (bool directToo : {false, true})
            for (int change = 0; change < CHANGES && (data.cameraCount > 1 || (!directToo && data.countPairs() > 0)); change++)
                if (mayBe(change, camera))
                    attempt({camera}, [=, &data] { return changedBack(data, (Change)change, camera, directToo); }, lenses,
                            sentenceOf((Change)change, data, camera, directToo));
    for (int camera = 0; camera < data.cameraCount; camera++)
        for (ImageState state : {GLASS_IMAGES, DIRECT_IMAGES, ALL_IMAGES})
            for (const Numbering& numbering : NUMBERINGS)
                if (data.cameraCount > 1 || (state == GLASS_IMAGES && data.countPairs() > 0))
                    attempt({camera}, [=, &data] { return numberedBack(data, numbering.turn, camera, state); }, lenses,
                            sentenceOf(numbering, camera, state));
    for (int change = 0; change < CHANGES && data.cameraCount > 1; change++)
        if (mayBe(change, 0))
            attempt(all, [=, &data] { return changedBack(data, (Change)change); }, lenses,
                    std::string("the --glass images of all cameras are ") + WORDS[change] + " to their direct images");
    std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return a.left < b.left; });
    MixUps found;
    found.camerasApart = before.camerasApart();
    for (const Candidate& candidate : candidates)
        (candidate.isClear && candidate.left <= AS_GOOD*least ? found.clear : found.possible).push_back(candidate.mixUp);
    return found;
}

void requireOneMoment(const CalibrationInput& input)
{
    const size_t LEAST = 3;             // others for each that is elsewhere
    const RigData& data = input.data;
    if (std::any_of(data.views.begin(), data.views.end(), [](const View& view) { return view.countDirect() > 0; }))
        return;
    for (int c = 1; c < data.cameraCount; c++)
    {
        const std::vector<int> elsewhere = viewsElsewhere(data, input.options, c);
        if (elsewhere.empty() || LEAST*elsewhere.size() > data.views.size())
            continue;
        std::vector<std::string> names;
        for (int view : elsewhere)
            names.push_back(data.views[view].stem);
        const std::string images = "--glass" + cameraSuffix(c) + " " + listed(names);
        RigData exchanged = data;
        if (elsewhere.size() == 2)
            std::swap(exchanged.views[elsewhere[0]].glass[c], exchanged.views[elsewhere[1]].glass[c]);
        if (elsewhere.size() == 2 && viewsElsewhere(exchanged, input.options, c).empty())
            throw Failure(images + " are exchanged, or those of camera 1: only so the board is where the other images have it");
        throw Failure(format("in %s the board is elsewhere than the other images have camera %d to camera 1: it moved between the two, or "
                             "one is of another name, turned or mirrored; leave it out, or put it right", images.c_str(), c + 1));
    }
}

} // namespace tools
