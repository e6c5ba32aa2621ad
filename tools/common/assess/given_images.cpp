// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/given_images.hpp"
#include "assess/advice.hpp"
#include "calibrate/fit.hpp"
#include "calibrate/outliers.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/poses_file.hpp"
#include "calibrate/rig_data.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "measure/point_error.hpp"
#include <algorithm>
#include <iostream>

using namespace cv::refract;
using cv::format;

namespace tools {

namespace {

const int LEAST_PAIRS = 3;              // of each camera: the noise is not known from fewer
const int LEAST_GLASS_ONLY = 8;         // without pairs

bool areFew(const RigData& data)
{
    for (int k = 0; k < data.cameraCount; k++)
    {
        int glass = 0;
        for (const View& view : data.views)
            glass += view.hasGlass(k);
        if (data.countPairs(k) < LEAST_PAIRS && glass < LEAST_GLASS_ONLY)
            return true;
    }
    return false;
}

void fitQuickly(RigCalibration& c)
{
    c.outliers = startWithoutOutliers(c.data, c.options, c.start, c.lensSources);
    c.fit = fitAllImages(c.data, c.start, c.lensSources, c.options.flags);
}

void add(Sufficiency& sufficiency, const std::string& text) { sufficiency.words += (sufficiency.words.empty() ? "" : ", ") + text; }

//! True if there are limits and all are met.
bool compareWithLimits(const RigCalibration& c, Sufficiency& sufficiency)
{
    bool met = c.limits.normalStdDeg > 0 || !c.limits.errors.empty();
    for (int k = 0; k < c.data.cameraCount && c.limits.normalStdDeg > 0; k++)
    {
        const double std = windowStd(c.fit, k).normalDeg[0];
        met = met && std <= c.limits.normalStdDeg;
        add(sufficiency, (c.data.cameraCount > 1 ? format("camera %d: ", k + 1) : "") + format("normal +- %.3g of %g deg", std,
                                                                                              c.limits.normalStdDeg));
    }
    Calibration calibration = calibrationOf(c.fit.rig);
    calibration.covariance = c.fit.covariance;
    for (const ErrorLimit& limit : c.limits.errors)
    {
        const double error = mapErrors(calibration, limit.range, c.fit.sigma, ERROR_MAP_COLUMNS).worst();
        met = met && error <= limit.error;
        add(sufficiency, format("error at %g %s %.3g of %g", limit.range, c.unit.c_str(), error, limit.error));
    }
    return met;
}

bool isNextWorthLittle(const RigCalibration& c, double leastGain, Sufficiency& sufficiency)
{
    const Advice advice = adviseImages(c);
    if (advice.pairs.empty())
        return false;
    const double gain = 1 - advice.pairs[0].quality.calibrationPart/advice.now.calibrationPart;
    add(sufficiency, format("the best next pair would take %.1f %% off the calibration's part of a point's error", 100*gain));
    return gain < leastGain;
}

} // namespace

/** Whether the images that came so far are enough: the limits of normals and points are met by the covariance of a quick fit of them, or
the best next pair would make points better by less than was asked for. What cannot be fitted yet is not enough.
@param c with data, options and limits; taken by value, as it is fitted
@param leastGain share of the calibration's part of a point's error that the next pair must take off to be waited for; 0: not asked */
static Sufficiency sufficiencyOf(RigCalibration c, double leastGain)
{
    Sufficiency sufficiency;
    if (areFew(c.data))
        return sufficiency;
    try
    {
        fitQuickly(c);
        sufficiency.isEnough = compareWithLimits(c, sufficiency);
        if (!sufficiency.isEnough && leastGain > 0)
            sufficiency.isEnough = isNextWorthLittle(c, leastGain, sufficiency);
    }
    catch (const std::exception&)       // cv::Exception is one: these images do not determine all yet
    {
        return {};
    }
    if (!sufficiency.words.empty())
        sufficiency.words = "so far: " + sufficiency.words + (sufficiency.isEnough ? ": enough" : "");
    return sufficiency;
}

//! The images that the views of the sets came from; none for corners that came from a file.
static std::vector<Photo> photosOf(const RigImages& sets)
{
    std::vector<Photo> photos;
    for (int c = 0; c < MAX_CAMERAS; c++)
        for (bool glass : {false, true})
        {
            const DetectedImages& set = (glass ? sets.glass : sets.direct)[c];
            if (set.files.size() == 1 && isPointFile(set.files[0]))
                continue;
            for (const DetectedImage& image : set.images)
                photos.push_back({image.path, image.stem, c, glass, image.points});
            for (const std::string& path : set.withoutTarget)
                photos.push_back({path, stemOf(path), c, glass, {}});
        }
    std::stable_sort(photos.begin(), photos.end(), [](const Photo& a, const Photo& b) { return a.stem < b.stem; });
    return photos;
}

//! Into the place of sources that are not to be read.
static void putWatched(const RigImages& watched, const RigSources& left, RigImages& sets)
{
    for (int k = 0; k < MAX_CAMERAS; k++)
    {
        if (left.direct[k].empty())
            sets.direct[k] = watched.direct[k];
        if (left.glass[k].empty())
            sets.glass[k] = watched.glass[k];
    }
}

//! Those that were watched are there already.
RigImages GivenImages::readOthers(const RigOptions& rig, const Target* target, bool quiet, const RigImages& watched,
                                  const RigSources& left) const
{
    PerCamera<cv::Size> sizes;
    for (int k = 0; k < MAX_CAMERAS; k++)
        sizes[k] = !imageSize.empty() ? parseSize(imageSize, "--image-size") : rig.known[k] ? rig.known[k]->imageSize() : cv::Size();
    for (int k = 0; k < MAX_CAMERAS; k++)
        for (const DetectedImages* set : {&watched.direct[k], &watched.glass[k]})
            if (!set->files.empty())
                sizes[k] = set->imageSize;
    if (!unpaired)
        requirePairNames(left);
    RigImages sets = readRigImages(left, target, sizes, quiet);
    putWatched(watched, left, sets);
    return sets;
}

//! From images to views.
void GivenImages::take(const Target* target, RigImages sets, bool isDistanceSaid, RigCalibration& c) const
{
    for (const DetectedImages* set : sets.all())
    {
        c.withoutTarget.insert(c.withoutTarget.end(), set->withoutTarget.begin(), set->withoutTarget.end());
        c.inputs.insert(c.inputs.end(), set->files.begin(), set->files.end());
    }
    if (!unpaired)
        requirePairs(sets);
    c.photos = photosOf(sets);
    c.used = usedImages(sets);
    c.fewPoints = leaveOutFewPoints(target, sets);
    c.data = groupIntoViews(target, sets, unpaired);
    if (!poses.empty())
    {
        readPoses(poses, c.unit, c.data);
        c.inputs.push_back(poses);
    }
    c.notices = noticesOf(sets, c.data);
    if (!isDistanceSaid && c.options.flags & GLASS_FREE_DISTANCE)
        c.options.window.distance = startDistance(c.data, c.square);
}

//! Until the images are there. @param left gets what is still to be read
RigImages GivenImages::watchThem(const Target* target, const RigCalibration& prepared, bool isDistanceSaid, bool quiet,
                                 RigSources& left) const
{
    if (!target || target->pattern() == Target::DOTS)
        throw Failure("--watch looks for a board: give --size and --square");
    WatchedRig rig = {sources, *target, unpaired, nullptr};
    const bool isAsked = prepared.limits.normalStdDeg > 0 || !prepared.limits.errors.empty() || watchGain > 0;
    RigImages others;                   // that are not watched, read when they are needed first
    bool areRead = false;
    if (isAsked)
        rig.assess = [&](const RigImages& came) {
            RigCalibration c = prepared;
            try
            {
                if (!areRead)
                    others = readOthers(c.options, target, quiet, {}, left);
                areRead = true;
                RigImages sets = others;
                putWatched(came, left, sets);
                take(target, sets, isDistanceSaid, c);
            }
            catch (const std::exception&)       // said at the end, if it is still so
            {
                return Sufficiency();
            }
            return sufficiencyOf(c, 0.01*watchGain);
        };
    std::ostream nowhere(nullptr);
    return watchRig(watch, rig, left, quiet ? nowhere : std::cout);
}

void GivenImages::read(const Target* target, bool isDistanceSaid, bool quiet, RigCalibration& c) const
{
    RigSources left = sources;
    RigImages watched;
    if (watch.given)
        watched = watchThem(target, c, isDistanceSaid, quiet, left);
    take(target, readOthers(c.options, target, quiet, watched, left), isDistanceSaid, c);
}

} // namespace tools
