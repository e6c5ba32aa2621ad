// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/scene_matches.hpp"
#include "bundle/bundle_adjustment.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/progress.hpp"
#include "match/moved_rig.hpp"
#include "match/pair_mistakes.hpp"
#include "match/partner_search.hpp"
#include "measure/measurement.hpp"
#include "measure/view_observations.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int FEWEST = 20;                  // matches, to tell good ones from others
const double NaN = std::numeric_limits<double>::quiet_NaN();

//! Of neighbours in a chain, the mean; of bits their number.
double descriptorDistance(const std::vector<Features>& features, const Chain& chain)
{
    double sum = 0.;
    int count = 0, last = -1;
    for (int c = 0; c < (int)chain.size(); c++)
        if (chain[c] >= 0)
        {
            if (last >= 0)
            {
                sum += norm(features[last].descriptors.row(chain[last]), features[c].descriptors.row(chain[c]), normOf(features[c]));
                count++;
            }
            last = c;
        }
    return sum/std::max(1, count);
}

ScaledMatches matchesOfChains(const std::string& moment, const std::vector<Features>& features, const std::vector<Chain>& chains)
{
    ScaledMatches result;
    result.matches.pixels.resize(features.size());
    result.scales.resize(features.size());
    for (const Chain& chain : chains)
    {
        result.matches.names.push_back({moment, std::to_string(result.size() + 1)});
        result.unlike.push_back(descriptorDistance(features, chain));
        for (size_t c = 0; c < features.size(); c++)
        {
            result.matches.pixels[c].push_back(chain[c] >= 0 ? features[c].pixels[chain[c]] : Point2d(NaN, NaN));
            result.scales[c].push_back(chain[c] >= 0 ? features[c].scales[chain[c]] : NaN);
        }
    }
    return result;
}

void setStds(const MatchNoise& noise, ScaledMatches& scaled)
{
    scaled.matches.stds = scaled.scales;
    for (std::vector<double>& ofCamera : scaled.matches.stds)
        for (int i = 0; i < scaled.size(); i++)
            ofCamera[i] = noise.stdOf(ofCamera[i], scaled.unlike.empty() ? 1. : scaled.unlike[i]);       // NaN stays
}

//! Of one moment of cameras 1 and 2; with a frame of camera 2 so many moments later.
PairDiagnosis diagnosisOf(const Calibration& calibration, std::vector<Frames>& cameras, const std::vector<Moment>& moments, int at,
                          int later)
{
    const int other = at + later;
    if (other < 0 || other >= (int)moments.size() || moments[at].frames[0] < 0 || moments[other].frames[1] < 0)
        return {};
    return diagnosePair(firstTwoCameras(calibration), greyFrame(cameras[0], moments[at].frames[0], calibration, 0),
                        greyFrame(cameras[1], moments[other].frames[1], calibration, 1));
}

//! Why images hardly match, as a sentence's end; empty: nothing is known to be wrong.
std::string mistakeIn(const Calibration& calibration, std::vector<Frames>& cameras, const std::vector<Moment>& moments)
{
    const double FITS = 2.;             // px
    const int MOST_LATE = 3;            // moments
    const int at = (int)moments.size()/2;
    const PairDiagnosis asGiven = diagnosisOf(calibration, cameras, moments, at, 0);
    if (!asGiven.mistake.empty())
        return ": " + asGiven.mistake + " (LEFT is camera 1, RIGHT camera 2)";
    for (int later = -MOST_LATE; later <= MOST_LATE; later++)
        if (later && !(asGiven.rows < FITS) && diagnosisOf(calibration, cameras, moments, at, later).rows < FITS)
            return format(": images of camera 2 are of other moments than those of camera 1, which fit %d image%s %s", std::abs(later),
                          std::abs(later) == 1 ? "" : "s", later > 0 ? "later" : "earlier");
    if (asGiven.rows > FITS)
        return format(": %d features are alike in both images, but their rays miss each other by %.1f px (median): is the calibration of "
                      "this rig, and are the images of one moment? A camera that turned by more than %g degrees needs --search of "
                      "refract_match", asGiven.features, asGiven.rows, MAY_HAVE_TURNED);
    return "";
}

//! In units of the usual distance of descriptors.
void makeRelative(std::vector<double>& unlike)
{
    const double usual = median(unlike);
    for (double& of : unlike)
        of = usual > 0. ? of/usual : 1.;
}

//! Of some of the matches.
double rmsOf(const std::vector<MatchResidual>& residuals, const std::vector<int>& some)
{
    double squares = 0.;
    int count = 0;
    for (int i : some)
    {
        squares += residuals[i].count > 0 ? residuals[i].squares : 0.;
        count += residuals[i].count;
    }
    return count > 0 ? std::sqrt(squares/count) : NaN;
}

//! Matches by chance are anywhere within the search, right ones within a few standard deviations.
double wrongOf(const SceneMatches& result)
{
    const double WITHIN = 4.;           // standard deviations, as the robust fit has it
    const double share = std::min(0.9, WITHIN*result.good.matches.usualStd()/result.search);
    return result.leftOut*share/(1. - share);
}

} // namespace

std::vector<Frames> framesOf(const std::vector<std::string>& sources, const Calibration& calibration, const std::string& filename,
                             const std::string& viewPattern)
{
    if (calibration.single())
        throw Failure("'" + filename + "' has one camera: what it sees at one place has no depth, so that there is nothing to match");
    if (sources.size() != calibration.cameras.size())
        throw Failure(format("'%s' has %zu cameras, and images of %zu are given: one image, quoted glob or video of each, in their order",
                             filename.c_str(), calibration.cameras.size(), sources.size()));
    for (size_t c = 0; c < calibration.cameras.size(); c++)
        if (calibration.cameras[c].camera->imageSize().empty())
            throw Failure(format("'%s' does not say image_width and image_height of camera %zu: add them", filename.c_str(), c + 1));
    std::vector<Frames> frames;
    for (const std::string& source : sources)
        frames.emplace_back(source, viewPattern);
    return frames;
}

Mat greyFrame(Frames& frames, int i, const Calibration& calibration, int camera, double white)
{
    Mat image = frames.read(i);
    requireSize(image, frames.name(i), calibration.cameras[camera].camera->imageSize());
    makeEightBit(image, white > 0. ? white : whiteOf(image));
    return greyOf(image, calibration.channel);
}

std::vector<Mat> imagesOf(const Moment& moment, const Calibration& calibration, std::vector<Frames>& cameras)
{
    std::vector<Mat> images(cameras.size());
    for (int c = 0; c < (int)cameras.size(); c++)
        if (moment.frames[c] >= 0)
            images[c] = greyFrame(cameras[c], moment.frames[c], calibration, c);
    return images;
}

std::vector<Moment> sharedMoments(const std::vector<Frames>& cameras)
{
    std::vector<const Frames*> all;
    for (const Frames& frames : cameras)
        all.push_back(&frames);
    std::vector<Moment> moments = momentsOf(all);
    const auto isAlone = [](const Moment& m) {
        return std::count_if(m.frames.begin(), m.frames.end(), [](int f) { return f >= 0; }) < 2; };
    moments.erase(std::remove_if(moments.begin(), moments.end(), isAlone), moments.end());
    if (moments.empty())
        throw Failure("no image of '" + cameras[0].source() + "' has the name of one of another camera: images of one moment need equal "
                      "names");
    return moments;
}

SceneMatcher::SceneMatcher(const Calibration& calibration, const SceneOptions& options)
    : input_{modelOf(calibration), calibration.covariance, 0., 0.}, options_(options)
{
    for (int a = 0; a < (int)input_.rig.cameras.size(); a++)
        for (int b = a + 1; b < (int)input_.rig.cameras.size(); b++)
        {
            const double search = options.search > 0. ? options.search : searchWidth(input_, a, b, options.depth, MAY_HAVE_TURNED);
            pairs_.push_back(CameraPair(input_.rig, a, b, options.depth, search));
        }
}

ScaledMatches SceneMatcher::matchesOf(const std::string& moment, const std::vector<Mat>& images) const
{
    // Side by side, as a detector by itself is busy on one processor for most of its time.
    std::vector<Features> features(images.size());
    inParallel((int)images.size(), [&](int c) {
        if (!images[c].empty())
            features[c] = featuresOf(images[c], options_.mostFeatures, options_.features); });
    std::vector<PairMatches> matches(pairs_.size());
    inParallel((int)pairs_.size(), [&](int i) {
        const CameraPair& pair = pairs_[i];
        matches[i] = {pair.first, pair.second, partnersNearCurves(input_.rig, pair, features[pair.first], features[pair.second])}; });
    return matchesOfChains(moment, features, chainsOf(features, matches));
}

/* A part of the matches tells the rig as it is now, robustly, and the rig which of all others are right; these tell it again, each with
the std of its scale, and so on until they stay the same. */
std::vector<int> SceneMatcher::leaveOutWrong(ScaledMatches& scaled, const std::vector<int>& groups, SceneMatches& result) const
{
    const int ENOUGH = 400, ROUNDS = 6;
    const double SHARE = 0.03;          // of the range of each change: of angles MAY_HAVE_TURNED
    const double depth = std::min(2.*options_.depth[0], 0.5*(options_.depth[0] + options_.depth[1]));
    const ScaledMatches some = scaled.only(spreadChoice(scaled, input_.rig, ENOUGH));
    // With less free, wrong matches bend it less.
    BundleStart start{input_.rig, cv::refract::GLASS_FIX_NORMAL, covarianceOfMoved(input_, {{MAY_HAVE_TURNED}, MAY_HAVE_TURNED}), {}};
    RigModel rig = adjustBundle(start, some.matches, {}, true).fit.rig;
    start.covariance = covarianceOfChanged(input_, depth, SHARE);
    std::vector<int> good;
    std::vector<uchar> moved(scaled.size(), 0);
    for (int round = 1;; round++)
    {
        const std::vector<MatchResidual> residuals = residualsOf(scaled, rig);
        std::vector<MatchResidual> still;
        for (int i = 0; i < scaled.size(); i++)
            if (!moved[i])
                still.push_back(residuals[i]);
        result.noise = noiseOf(still);
        setStds(result.noise, scaled);
        const std::vector<int> before = good;
        const double unlikeLimit = unlikeLimitOf(residuals, result.noise);
        good.clear();
        for (int i = 0; i < scaled.size(); i++)
            if (residuals[i].isWithin(result.noise) && residuals[i].unlike <= unlikeLimit)
                good.push_back(i);
        // What errs together does so against a rig that nothing else bends any more.
        moved = round == 1 ? inContradictedParts(scaled, rig, good) : inMovedParts(scaled, groups, rig, residuals, result.noise, good);
        good.erase(std::remove_if(good.begin(), good.end(), [&](int i) { return moved[i]; }), good.end());
        result.residual = rmsOf(residuals, good);
        if ((int)good.size() < FEWEST || (round > 2 && (round == ROUNDS || good == before)))
            return good;
        rig = adjustBundle(start, scaled.only(good).matches, {}, false).fit.rig;
    }
}

SceneMatches SceneMatcher::goodOf(const ScaledMatches& all) const
{
    SceneMatches result;
    for (const CameraPair& pair : pairs_)
        result.search = std::max(result.search, pair.search);
    result.found = all.size();
    const std::vector<int> choice = spreadChoice(all, input_.rig, options_.count), groupsOfAll = groupsOf(all);
    std::vector<int> groups;
    for (int i : choice)
        groups.push_back(groupsOfAll[i]);
    ScaledMatches chosen = all.only(choice);
    makeRelative(chosen.unlike);
    result.chosen = chosen.size();
    if (result.chosen < FEWEST)
        throw TooFewMatches(format("only %d matches were found, fewer than %d: more texture, light or images are wanted, or --depth is "
                                   "not that of the scene", result.chosen, FEWEST));
    const std::vector<int> good = leaveOutWrong(chosen, groups, result);
    result.good = chosen.only(good);
    result.leftOut = result.chosen - (int)good.size();
    if (result.good.size() < FEWEST || !(result.good.matches.usualStd() > 0.))
        throw TooFewMatches(format("only %d of %d matches agree with each other: are the images of this rig, and of one moment each?",
                                   result.good.size(), result.chosen));
    result.wrongLeft = wrongOf(result);
    return result;
}

SceneMatches matchScene(const Calibration& calibration, std::vector<Frames>& cameras, const SceneOptions& options, bool quiet)
{
    const SceneMatcher matcher(calibration, options);
    const std::vector<Moment> moments = sharedMoments(cameras);
    ScaledMatches all;
    {
        Progress progress("matching", (int)moments.size(), quiet);
        for (const Moment& moment : moments)
        {
            progress.at(moment.stem);
            all.add(matcher.matchesOf(moment.stem, imagesOf(moment, calibration, cameras)));
            progress.step();
        }
    }
    const double MANY = 0.3;            // of the matches left out: something is wrong with all
    const double NO_FEATURE = 1.;       // px: features are placed better
    SceneMatches result;
    try
    {
        result = matcher.goodOf(all);
    }
    catch (const Failure& failure)
    {
        const std::string mistake = mistakeIn(calibration, cameras, moments);
        if (mistake.empty())
            throw;
        throw Failure(failure.what() + mistake);
    }
    result.moments = (int)moments.size();
    const bool isNoFit = result.good.matches.usualStd() > NO_FEATURE;
    const std::string mistake = isNoFit || result.leftOut > MANY*result.chosen ? mistakeIn(calibration, cameras, moments) : "";
    if (isNoFit)
        throw Failure(format("the %d matches miss each other's rays by %.2g px, however the rig may have moved, where features of sharp "
                             "images are placed within %g px", result.good.size(), result.good.matches.usualStd(), NO_FEATURE)
                      + (mistake.empty() ? ": are the images sharp, of this rig, and of one moment each?" : mistake));
    if (!mistake.empty())
        throw Failure(format("%d of %d matches contradict the others", result.leftOut, result.chosen) + mistake);
    return result;
}

std::vector<Mat> imagesOfMoment(const Calibration& calibration, std::vector<Frames>& cameras, const std::string& stem)
{
    for (const Moment& moment : sharedMoments(cameras))
        if (moment.stem == stem)
            return imagesOf(moment, calibration, cameras);
    return std::vector<Mat>(cameras.size());
}

double residualWithoutWindows(const Calibration& calibration, const ScaledMatches& good)
{
    const double ANYHOW = 0.1;          // rad, and of the distances: as much a camera may be elsewhere
    BundleStart start{modelOf(withoutWindows(calibration)), cv::refract::GLASS_FIX_NORMAL, Mat(), {}};
    const int columns = columnCount(start.rig);
    start.covariance = Mat::zeros(columns, columns, CV_64F);
    for (int c = 1; c < (int)start.rig.cameras.size(); c++)
        for (int i = 0; i < 6; i++)
        {
            const int at = extrinsicsColumn(start.rig, c) + i;
            start.covariance.at<double>(at, at) = std::pow(ANYHOW*(i < 3 ? 1. : norm(start.rig.extrinsics[c].t)), 2);
        }
    std::vector<int> all;
    for (int i = 0; i < good.size(); i++)
        all.push_back(i);
    try
    {
        return rmsOf(residualsOf(good, adjustBundle(start, good.matches, {}, false).fit.rig), all);
    }
    catch (const Failure&)
    {
        return NaN;
    }
}

ViewObservations observationsOf(const RigModel& rig, const Matches& matches)
{
    const std::vector<Point3d> points = triangulate(rig, matches.pixels);
    ViewObservations scene;
    scene.isScene = true;
    std::vector<int> indices(points.size(), -1);
    for (size_t i = 0; i < points.size(); i++)
        if (std::isfinite(points[i].x))
        {
            indices[i] = (int)scene.objectPoints.size();
            scene.objectPoints.push_back(points[i]);
        }
    std::vector<double> pixels, noise;
    const double usual = matches.usualStd();
    for (int c = 0; c < matches.cameraCount(); c++)
    {
        ImageOfView image{c, true, {}};
        for (size_t i = 0; i < points.size(); i++)
            if (indices[i] >= 0 && matches.isSeen(c, (int)i))
            {
                const double relative = matches.stds.empty() ? 1. : matches.stds[c][i]/usual;
                image.points.push_back(indices[i]);
                pixels.insert(pixels.end(), {matches.pixels[c][i].x, matches.pixels[c][i].y});
                noise.insert(noise.end(), {relative, relative});
            }
        if (!image.points.empty())
            scene.images.push_back(image);
    }
    scene.pixels = Eigen::Map<Eigen::VectorXd>(pixels.data(), pixels.size());
    scene.noise = Eigen::Map<Eigen::VectorXd>(noise.data(), noise.size());
    return scene;
}

} // namespace tools
