// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/image_mixups.hpp"
#include "diagnose/fit_quality.hpp"
#include "console/table.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <array>
#include <cmath>

using namespace cv;

namespace tools {

namespace {

const double CLEARLY_BETTER = 0.5;      // what is left of the worst disagreement, at most
const double NOT_WORSE = 1.5;           // any other
const double AS_GOOD = 1.3;             // as the least that any leaves
const double LEAST_PX = 20.;            // less is a window's doing

enum Change { HALF_TURN, MIRROR, QUARTER_TURN, BACK_TURN, CHANGES };

Point2d undone(Change change, const Point2d& p, Size size)
{
    switch (change)
    {
    case HALF_TURN: return Point2d(size.width - 1. - p.x, size.height - 1. - p.y);
    case MIRROR: return Point2d(size.width - 1. - p.x, p.y);
    case QUARTER_TURN: return Point2d(p.y, size.width - 1. - p.x);
    default: return Point2d(size.height - 1. - p.y, p.x);
    }
}

//! Which point of a board lies where another one would be if its rows or columns were counted from the other side; empty: none.
std::vector<int> countedFromOtherSide(const std::vector<Point3d>& board, bool x, bool y)
{
    Point2d low(1e300, 1e300), high(-1e300, -1e300);
    for (const Point3d& X : board)
    {
        low = Point2d(std::min(low.x, X.x), std::min(low.y, X.y));
        high = Point2d(std::max(high.x, X.x), std::max(high.y, X.y));
    }
    const double tolerance = 1e-6*norm(high - low);
    std::vector<int> order;
    for (const Point3d& X : board)
    {
        const Point3d there(x ? low.x + high.x - X.x : X.x, y ? low.y + high.y - X.y : X.y, X.z);
        const auto at = std::find_if(board.begin(), board.end(), [&](const Point3d& other) { return norm(other - there) <= tolerance; });
        if (at == board.end())
            return {};
        order.push_back((int)(at - board.begin()));
    }
    return order;
}

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

//! A detector names the corners of a changed image by what it looks like: names them as in another image of the view.
void nameAs(const View& view, const std::vector<Point2d>& reference, std::vector<Point2d>& pixels)
{
    double best = -1e300;
    std::vector<Point2d> named = pixels;
    for (int flips = 0; flips < 4; flips++)
    {
        const std::vector<int> order = countedFromOtherSide(view.objectPoints, flips & 1, flips & 2);
        if (order.empty())
            continue;
        std::vector<Point2d> candidate;
        for (int i : order)
            candidate.push_back(pixels[i]);
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
                p = undone(change, p, size);
            if (view.neighbours.empty())        // points that have names of their own
                continue;
            if (reference)
                nameAs(view, *reference, *pixels);
            else if (change == MIRROR)
            {
                const std::vector<int> order = countedFromOtherSide(view.objectPoints, true, false);
                const std::vector<Point2d> before = *pixels;
                for (size_t i = 0; i < order.size(); i++)
                    (*pixels)[i] = before[order[i]];
            }
        }
    }
    return data;
}

RigData exchanged(const RigData& given, int a, int b, bool direct)
{
    RigData data = given;
    for (View& view : data.views)
        direct ? std::swap(view.direct[a], view.direct[b]) : std::swap(view.glass[a], view.glass[b]);
    return data;
}

//! How far the two images of a pair are apart; px, the median of all points of a camera.
double pairsApart(const RigData& data, int camera)
{
    std::vector<double> lengths;
    for (const View& view : data.views)
        if (view.isPair(camera))
            for (size_t i = 0; i < view.objectPoints.size(); i++)
                if (seen(view.direct[camera][i]) && seen(view.glass[camera][i]))
                    lengths.push_back(norm(view.direct[camera][i] - view.glass[camera][i]));
    return median(lengths);
}

//! A lens that is good enough to tell boards that are turned or elsewhere.
Matx33d roughLens(const RigData& data, int camera, bool glass)
{
    std::vector<std::vector<Point3f>> objects;
    std::vector<std::vector<Point2f>> images;
    for (const View& view : data.views)
    {
        const std::vector<Point2d>& pixels = (glass ? view.glass : view.direct)[camera];
        objects.emplace_back();
        images.emplace_back();
        for (size_t i = 0; i < pixels.size(); i++)
            if (seen(pixels[i]) && view.objectPoints[i].z == view.objectPoints[0].z)
            {
                objects.back().emplace_back((float)view.objectPoints[i].x, (float)view.objectPoints[i].y, 0.f);
                images.back().push_back(pixels[i]);
            }
        if (images.back().size() < 8)
        {
            objects.pop_back();
            images.pop_back();
        }
    }
    if (images.size() < 3)
        return Matx33d::zeros();
    return Matx33d(initCameraMatrix2D(objects, images, data.imageSize[camera], 1.));
}

bool rigidPose(const View& view, const std::vector<Point2d>& pixels, const Matx33d& K, RigidTransform& pose)
{
    std::vector<Point3d> object;
    std::vector<Point2d> image;
    for (size_t i = 0; i < pixels.size(); i++)
        if (seen(pixels[i]))
        {
            object.push_back(view.objectPoints[i]);
            image.push_back(pixels[i]);
        }
    Vec3d rvec, tvec;
    if (image.size() < 6 || !solvePnP(object, image, K, noArray(), rvec, tvec, false, SOLVEPNP_IPPE))
        return false;
    solvePnPRefineLM(object, image, K, noArray(), rvec, tvec);
    pose = transformOf(rvec, tvec);
    return true;
}

//! A board that two cameras saw at one moment.
struct Both
{
    RigidTransform one, other;
    const View* view;
};

std::vector<Both> boardsOf(const RigData& data, int camera, bool glass, double& focal)
{
    const Matx33d K1 = roughLens(data, 0, glass), K2 = roughLens(data, camera, glass);
    std::vector<Both> boards;
    focal = K2(0, 0);
    if (!(K1(0, 0) > 0.) || !(focal > 0.))
        return boards;
    for (const View& view : data.views)
    {
        Both b{{}, {}, &view};
        const PerCamera<std::vector<Point2d>>& images = glass ? view.glass : view.direct;
        if (rigidPose(view, images[0], K1, b.one) && rigidPose(view, images[camera], K2, b.other))
            boards.push_back(b);
    }
    return boards;
}

//! How far boards are from where the place of two cameras to each other has them, which one of some boards gives; px, of the middling one.
double apart(const std::vector<Both>& boards, const std::vector<Both>& places, double focal)
{
    if (boards.size() < 3 || places.size() < 3)
        return 0.;
    double least = NO_FIT;
    for (const Both& from : places)
    {
        const RigidTransform place = fromTo(from.one, from.other);
        std::vector<double> errors;
        for (const Both& b : boards)
        {
            double sum = 0.;
            for (const Point3d& X : b.view->objectPoints)
            {
                const Vec3d here = b.other*Vec3d(X);
                sum += norm(place*(b.one*Vec3d(X)) - here)/std::abs(here[2]);
            }
            errors.push_back(focal*sum/b.view->objectPoints.size());
        }
        least = std::min(least, median(errors));
    }
    return least;
}

//! All disagreements that there can be, in one order.
std::vector<double> disagreements(const RigData& data)
{
    std::vector<double> all;
    for (int c = 0; c < data.cameraCount; c++)
        all.push_back(pairsApart(data, c));
    for (int c = 1; c < data.cameraCount; c++)
    {
        double focal, focalThrough;
        const std::vector<Both> direct = boardsOf(data, c, false, focal), glass = boardsOf(data, c, true, focalThrough);
        for (double px : {apart(direct, direct, focal), apart(glass, glass, focalThrough), apart(glass, direct, focalThrough)})
            all.push_back(px);
    }
    return all;
}

struct Candidate
{
    MixUp mixUp;
    double left;                //!< the largest disagreement
};

//! Whether the largest disagreement is much less, and no other is more.
bool explains(const std::vector<double>& before, const std::vector<double>& after)
{
    const size_t worst = std::max_element(before.begin(), before.end()) - before.begin();
    const double most = *std::max_element(after.begin(), after.end());
    if (!(before[worst] > LEAST_PX) || !(most < CLEARLY_BETTER*before[worst]))
        return false;
    for (size_t i = 0; i < before.size(); i++)
        if (after[i] > NOT_WORSE*before[i] + LEAST_PX)
            return false;
    return true;
}

std::string sentenceOf(Change change, const RigData& data, int camera, bool directToo)
{
    static const char* const WORDS[] = {"turned by 180 degrees", "mirrored", "turned by 90 degrees", "turned by 90 degrees"};
    const std::string of = data.cameraCount == 1 ? "" : format(" of camera %d", camera + 1);
    if (directToo)
        return "the images" + of + " are " + WORDS[change] + " to those of the other cameras";
    const bool hasPairs = data.countPairs(camera) > 0;
    return "the --glass" + cameraSuffix(camera) + " images are " + WORDS[change]
        + (hasPairs ? " to the --direct" + cameraSuffix(camera) + " images" : " to those of the other cameras");
}

} // namespace

std::vector<MixUp> findMixUps(const CalibrationInput& input)
{
    const RigData& data = input.data;
    const std::vector<double> before = disagreements(data);
    if (!(*std::max_element(before.begin(), before.end()) > LEAST_PX))
        return {};
    std::vector<Candidate> candidates;
    double least = NO_FIT;
    const auto attempt = [&](const RigData& changed, const std::string& sentence) {
        const std::vector<double> after = disagreements(changed);
        if (!explains(before, after))
            return;
        candidates.push_back({{sentence, changed}, *std::max_element(after.begin(), after.end())});
        least = std::min(least, candidates.back().left);
    };
    for (int b = 1; b < data.cameraCount; b++)
        for (int a = 0; a < b; a++)
            for (bool direct : {false, true})
            {
                const char* const option = direct ? "--direct" : "--glass";
                attempt(exchanged(data, a, b, direct), option + cameraSuffix(a) + " and " + option + cameraSuffix(b) + " exchanged");
            }
    for (int camera = 0; camera < data.cameraCount; camera++)
        for (bool directToo : {false, true})
            for (int change = 0; change < CHANGES && (data.cameraCount > 1 || !directToo); change++)
            {
                const bool square = data.imageSize[camera].width == data.imageSize[camera].height;
                if (change <= MIRROR || square)
                    attempt(changedBack(data, (Change)change, camera, directToo), sentenceOf((Change)change, data, camera, directToo));
            }
    std::vector<MixUp> best;
    for (const Candidate& candidate : candidates)
        if (candidate.left <= AS_GOOD*least)
            best.push_back(candidate.mixUp);
    return best;
}

} // namespace tools
