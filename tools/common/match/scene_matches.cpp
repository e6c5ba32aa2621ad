// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/scene_matches.hpp"
#include "console/failure.hpp"
#include "console/frames.hpp"
#include "console/progress.hpp"
#include "match/chains.hpp"
#include "match/moved_rig.hpp"

#include <algorithm>
#include <cmath>

using namespace cv;

namespace tools {

namespace {

const int FEWEST = 20;                  // matches, to tell good ones from others
const double NaN = std::numeric_limits<double>::quiet_NaN();

std::vector<CameraPair> pairsOf(const CheckInput& input, const SceneOptions& options)
{
    std::vector<CameraPair> pairs;
    for (int a = 0; a < (int)input.rig.cameras.size(); a++)
        for (int b = a + 1; b < (int)input.rig.cameras.size(); b++)
        {
            const double search = options.search > 0. ? options.search : searchWidth(input, a, b, options.depth, MAY_HAVE_TURNED);
            pairs.push_back(CameraPair(input.rig, a, b, options.depth, search));
        }
    return pairs;
}

Mat greyFrame(Frames& frames, int i, const Calibration& calibration, int camera)
{
    Mat image = frames.read(i), same = image;
    requireSize(image, frames.name(i), calibration.cameras[camera].camera->imageSize());
    makeEightBit(image, same);
    return greyOf(image, calibration.channel);
}

ScaledMatches matchesOf(const std::string& moment, const std::vector<Features>& features, const std::vector<Chain>& chains)
{
    ScaledMatches result;
    result.matches.pixels.resize(features.size());
    result.scales.resize(features.size());
    for (const Chain& chain : chains)
    {
        result.matches.names.push_back({moment, std::to_string(result.size() + 1)});
        for (size_t c = 0; c < features.size(); c++)
        {
            result.matches.pixels[c].push_back(chain[c] >= 0 ? features[c].pixels[chain[c]] : Point2d(NaN, NaN));
            result.scales[c].push_back(chain[c] >= 0 ? features[c].scales[chain[c]] : NaN);
        }
    }
    return result;
}

std::vector<Moment> sharedMoments(const std::vector<Frames>& cameras)
{
    std::vector<const Frames*> all;
    for (const Frames& frames : cameras)
        all.push_back(&frames);
    std::vector<Moment> moments = momentsOf(all);
    const auto isAlone = [](const Moment& m) { return std::count_if(m.frames.begin(), m.frames.end(), [](int f) { return f >= 0; }) < 2; };
    moments.erase(std::remove_if(moments.begin(), moments.end(), isAlone), moments.end());
    if (moments.empty())
        throw Failure("no image of '" + cameras[0].source() + "' has the name of one of another camera: images of one moment need equal "
                      "names");
    return moments;
}

ScaledMatches findAll(const Calibration& calibration, std::vector<Frames>& cameras, const SceneOptions& options,
                      const std::vector<CameraPair>& pairs, const std::vector<Moment>& moments, bool quiet)
{
    Progress progress("matching", (int)moments.size(), quiet);
    const RigModel rig = modelOf(calibration);
    ScaledMatches all;
    for (const Moment& moment : moments)
    {
        progress.at(moment.stem);
        std::vector<Features> features(cameras.size());
        for (int c = 0; c < (int)cameras.size(); c++)
            if (moment.frames[c] >= 0)
                features[c] = featuresOf(greyFrame(cameras[c], moment.frames[c], calibration, c), options.features);
        std::vector<PairMatches> matches;
        for (const CameraPair& pair : pairs)
            matches.push_back({pair.first, pair.second,
                               partnersNearCurves(rig, pair, features[pair.first], features[pair.second])});
        all.add(matchesOf(moment.stem, features, chainsOf(features, matches)));
        progress.step();
    }
    return all;
}

void setStds(const MatchNoise& noise, ScaledMatches& scaled)
{
    scaled.matches.stds = scaled.scales;
    for (std::vector<double>& ofCamera : scaled.matches.stds)
        for (double& std : ofCamera)
            std = noise.stdOf(std);         // NaN stays
}

/* The rig may have moved: what is estimated within the covariance of that takes a change for none of the matches' fault. First all
pixels are alike, then each has the std of its scale. */
std::vector<int> leaveOutWrong(const CheckInput& input, ScaledMatches& scaled, MatchNoise& noise)
{
    const BundleStart start{input.rig, cv::refract::GLASS_FIX_NORMAL, covarianceOfMoved(input, MAY_HAVE_TURNED), {}};
    scaled.matches.stds.clear();
    BundleAdjustment fit = adjustBundle(start, scaled.matches, {}, true);
    setStds(noiseOfMatches(scaled.matches, scaled.scales, fit), scaled);
    fit = adjustBundle(start, scaled.matches, {}, true);
    noise = noiseOfMatches(scaled.matches, scaled.scales, fit);
    setStds(noise, scaled);
    std::vector<int> good;
    for (int i = 0; i < scaled.size(); i++)
    {
        bool isGood = fit.status[i] == cv::refract::REFRACT_OK;
        for (int c = 0; c < scaled.matches.cameraCount(); c++)
            isGood &= !scaled.matches.isSeen(c, i) || fit.used[c][i];
        if (isGood)
            good.push_back(i);
    }
    return good;
}

//! Matches by chance are anywhere within the search, right ones within a few standard deviations.
double wrongOf(const SceneMatches& result)
{
    const double WITHIN = 4.;           // standard deviations, as the robust fit has it
    const double share = std::min(0.9, WITHIN*result.good.matches.usualStd()/result.search);
    return result.leftOut*share/(1. - share);
}

} // namespace

SceneMatches matchScene(const Calibration& calibration, std::vector<Frames>& cameras, const SceneOptions& options, bool quiet)
{
    const CheckInput input{modelOf(calibration), calibration.covariance, 0., 0.};
    const std::vector<CameraPair> pairs = pairsOf(input, options);
    const std::vector<Moment> moments = sharedMoments(cameras);
    SceneMatches result;
    result.moments = (int)moments.size();
    for (const CameraPair& pair : pairs)
        result.search = std::max(result.search, pair.search);
    const ScaledMatches all = findAll(calibration, cameras, options, pairs, moments, quiet);
    result.found = all.size();
    ScaledMatches chosen = all.only(spreadChoice(all, input.rig, options.count));
    result.chosen = chosen.size();
    if (result.chosen < FEWEST)
        throw Failure(format("only %d matches were found in %d image%s of each camera, fewer than %d: more texture or light is wanted, or "
                             "--depth is not that of the scene", result.chosen, result.moments, result.moments == 1 ? "" : "s", FEWEST));
    const std::vector<int> good = leaveOutWrong(input, chosen, result.noise);
    result.good = chosen.only(good);
    result.leftOut = result.chosen - (int)good.size();
    result.wrongLeft = wrongOf(result);
    return result;
}

} // namespace tools
