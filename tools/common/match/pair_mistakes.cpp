// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/pair_mistakes.hpp"
#include "calibrate/rig_model.hpp"
#include "calibrate/window_face.hpp"
#include "match/features.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Vec3d;

namespace {

typedef std::vector<Point2d> Pixels;

const double FITS = 1.5;            // px
const int MOST_FEATURES = 2000;     // enough to tell mistakes apart
const int FEW_FEATURES = 100;       // as chance finds of a mirrored image

//! A pair as it would be without a mistake.
struct Undone
{
    Calibration calibration;
    Partners partners;
};

struct Mistake
{
    std::string sentence;
    std::function<void(Undone&)> undo;
};

void turn(Pixels& pixels, cv::Size size, bool acrossX, bool acrossY)
{
    for (Point2d& p : pixels)
        p = Point2d(acrossX ? size.width - 1 - p.x : p.x, acrossY ? size.height - 1 - p.y : p.y);
}

void setWindow(Calibration& calibration, int camera, const cv::refract::GlassWindow& window)
{
    auto& c = calibration.cameras[camera].camera;
    const cv::Size size = c->imageSize();
    c = copyWithWindow(c, window);
    c->setImageSize(size);
}

void exchangeWindows(Undone& pair)
{
    const auto first = pair.calibration.cameras[0].camera->window(), second = pair.calibration.cameras[1].camera->window();
    setWindow(pair.calibration, 0, second);
    setWindow(pair.calibration, 1, first);
}

void exchangeCameras(Undone& pair) { std::swap(pair.calibration.cameras[0], pair.calibration.cameras[1]); }

void exchangeImages(Undone& pair) { std::swap(pair.partners.pixels1, pair.partners.pixels2); }

void mirrorNormal(Undone& pair, int camera, int axis)
{
    cv::refract::GlassWindow window = pair.calibration.cameras[camera].camera->window();
    cv::Vec3d& place = isRound(window) ? window.center : window.normal;
    place[axis] = -place[axis];
    setWindow(pair.calibration, camera, window);
}

void reverseTransform(Undone& pair)
{
    pair.calibration.extrinsics[1] = pair.calibration.extrinsics[1].inverse();
}

//! Of pairs whose features have partners only if LEFT is mirrored, and which that was done to.
std::vector<Mistake> mistakesOfMirrored(cv::Size size)
{
    const auto turned = [size](bool x1, bool y1, bool x2, bool y2) {
        return [=](Undone& p) { turn(p.partners.pixels1, size, x1, y1); turn(p.partners.pixels2, size, x2, y2); }; };
    return {{"LEFT is mirrored, left and right", turned(false, false, false, false)},
            {"RIGHT is mirrored, left and right", turned(true, false, true, false)},
            {"LEFT is mirrored, top and bottom", turned(true, true, false, false)},
            {"RIGHT is mirrored, top and bottom", turned(true, false, false, true)}};
}

std::vector<Mistake> mistakesOf(const RigModel& rig, cv::Size size)
{
    const auto both = [size](bool x, bool y) {
        return [=](Undone& p) { turn(p.partners.pixels1, size, x, y); turn(p.partners.pixels2, size, x, y); }; };
    const auto one = [size](int camera, bool x, bool y) {
        return [=](Undone& p) { turn(camera ? p.partners.pixels2 : p.partners.pixels1, size, x, y); }; };
    std::vector<Mistake> mistakes = {
        {"LEFT and RIGHT are swapped", exchangeImages},
        {"both images are mirrored, left and right", both(true, false)},
        {"both images are mirrored, top and bottom", both(false, true)},
        {"both images are turned by 180 degrees", both(true, true)},
        {"LEFT is turned by 180 degrees", one(0, true, true)},
        {"RIGHT is turned by 180 degrees", one(1, true, true)},
        {"the windows of cameras 1 and 2 are exchanged in the calibration", exchangeWindows},
        {"cameras 1 and 2 are exchanged in the calibration", exchangeCameras},
        {"R and T in the calibration lead from camera 2 to camera 1", reverseTransform},
    };
    for (const std::vector<int>& cameras : camerasWithoutWindows(rig))
        mistakes.push_back({takenWithoutWindow(cameras, 2), [=](Undone& p) {
            for (int c : cameras)
                setWindow(p.calibration, c, cv::refract::GlassWindow()); }});
    for (int axis = 0; axis < 2; axis++)
    {
        const char name = axis ? 'y' : 'x';
        mistakes.push_back({cv::format("the windows are mirrored in the calibration: %c of both normals has the wrong sign", name),
                            [=](Undone& p) { mirrorNormal(p, 0, axis); mirrorNormal(p, 1, axis); }});
        for (int c = 0; c < 2; c++)
            mistakes.push_back({cv::format("the window of camera %d is mirrored in the calibration: %c of its normal has the wrong "
                                           "sign", c + 1, name), [=](Undone& p) { mirrorNormal(p, c, axis); }});
    }
    return mistakes;
}

//! Ascending.
std::vector<double> missesOf(const Undone& pair)
{
    std::vector<cv::Point3d> points;
    std::vector<double> misses = missesOf(pair.calibration, pair.partners, points);
    std::sort(misses.begin(), misses.end());
    return misses;
}

int fitting(const std::vector<double>& misses)
{
    return (int)(std::lower_bound(misses.begin(), misses.end(), FITS) - misses.begin());
}

//! Mean square, where what does not fit counts as just not.
double costOf(const std::vector<double>& misses)
{
    double sum = 0;
    for (const double miss : misses)
        sum += std::min(miss*miss, FITS*FITS);
    return sum/(double)misses.size();
}

struct Candidate
{
    std::string sentence;
    double cost;
};

//! The mistakes without which the features fit, the best and those that are as good.
std::string nameMistakes(const std::vector<Mistake>& mistakes, const Undone& asGiven, int fitsAsGiven)
{
    const double AS_GOOD = 1.5;
    const int all = (int)asGiven.partners.pixels1.size(), most = std::max({fitsAsGiven + fitsAsGiven/2, all/2, MIN_FEATURES});
    std::vector<Candidate> candidates;
    for (const Mistake& mistake : mistakes)
    {
        Undone pair = asGiven;
        mistake.undo(pair);
        const std::vector<double> misses = missesOf(pair);
        if (fitting(misses) > most)
            candidates.push_back({mistake.sentence, costOf(misses)});
    }
    std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
    std::string names;
    for (const Candidate& c : candidates)
        if (c.cost <= AS_GOOD*candidates[0].cost)
            names += (names.empty() ? "" : ", or ") + c.sentence;
    return names;
}

} // namespace

std::vector<double> missesOf(const Calibration& calibration, const Partners& partners, std::vector<cv::Point3d>& points)
{
    std::vector<double> misses(partners.pixels1.size(), INFINITY);
    if (misses.empty())
        return misses;
    std::vector<uchar> status;
    Mat errors;
    cv::refract::triangulateRefractive(calibration.cameras[0].camera, calibration.cameras[1].camera, calibration.extrinsics[1].R,
                                       calibration.extrinsics[1].t, partners.pixels1, partners.pixels2, points, status, 0, 1.,
                                       cv::noArray(), cv::noArray(), errors);
    for (size_t i = 0; i < misses.size(); i++)
        if (status[i] == 0 && points[i].z > 0)      // which is in the middle: each pixel is off by half of what the rays miss
            misses[i] = std::sqrt(2.)*norm(errors.row((int)i));
    return misses;
}

PairDiagnosis diagnosePair(const Calibration& calibration, const Mat& image1, const Mat& image2)
{
    PairDiagnosis result;
    const Mat grey1 = greyOf(image1, calibration.channel), grey2 = greyOf(image2, calibration.channel);
    Undone asGiven = {calibration, findPartners(grey1, grey2, MOST_FEATURES)};
    Mat mirrored;
    cv::flip(grey1, mirrored, 1);
    const bool few = (int)asGiven.partners.pixels1.size() < FEW_FEATURES;
    const Partners others = few ? findPartners(mirrored, grey2, MOST_FEATURES) : Partners();
    const bool isMirrored = others.pixels1.size() > 2*asGiven.partners.pixels1.size();
    if (isMirrored)
        asGiven.partners = others;
    result.features = (int)asGiven.partners.pixels1.size();
    if (result.features < MIN_FEATURES)
        return result;
    const std::vector<double> misses = missesOf(asGiven);
    if (!isMirrored)
        result.rows = misses[misses.size()/2];
    result.mistake = nameMistakes(isMirrored ? mistakesOfMirrored(grey1.size()) : mistakesOf(modelOf(calibration), grey1.size()),
                                  asGiven, isMirrored ? 0 : fitting(misses));
    return result;
}

} // namespace tools
