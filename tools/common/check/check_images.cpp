// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "check/check_images.hpp"
#include "calibrate/given_std.hpp"
#include "calibrate/starting_model.hpp"
#include "console/cli.hpp"
#include "console/table.hpp"
#include "match/depth_range.hpp"
#include "match/scene_check.hpp"
#include <algorithm>

using namespace cv::refract;

namespace tools {
namespace {

//! The targets may have moved between the new images of pairs, independently of what happened when the calibration was made.
void addPlacement(double placement, const std::vector<View>& views, CheckInput& input)
{
    RigData data;
    data.cameraCount = (int)input.rig.cameras.size();
    data.views = views;
    GivenStd std;
    std.placement = placement;
    const cv::Mat covariance = targetCovarianceOf(data, input.rig, std);
    if (!covariance.empty())
        input = withTargetColumns(input, covariance);
}

CheckResult checkViews(const CheckOptions& o, const std::vector<View>& views, const Calibration& calibration, CheckInput& input)
{
    addPlacement(o.placement, views, input);
    CheckResult result = checkRig(input, views, o.falseAlarmOfCheck(), calibration.unit);
    const bool isOtherBoard = o.target.square > 0. && calibration.square > 0. && o.target.square != calibration.square;
    const auto isShown = [&](const UnseenError& error) { return error.isOfTarget ? isOtherBoard : o.newPane; };
    result.unseen.erase(std::remove_if(result.unseen.begin(), result.unseen.end(), isShown), result.unseen.end());
    return result;
}

CheckResult checkMatches(const CheckOptions& o, const SceneMatches& matches, const Calibration& calibration, CheckInput& input)
{
    input.sigma = matches.good.matches.usualStd();          // the noise of features, which is not that of a target's points
    return checkScene(input, observationsOf(input.rig, matches.good.matches), o.falseAlarmOfCheck(), calibration.unit);
}

//! Direct images that have no glass image of their name are of no use here, and those are rarely meant.
void requirePairs(const CheckOptions& o, const RigImages& sets, const Command& command)
{
    for (int c = 0; c < MAX_CAMERAS; c++)
    {
        const std::string number = cameraSuffix(c);
        std::string alone;
        int count = 0;
        for (const DetectedImage& image : sets.direct[c].images)
            if (!sets.glass[c].find(image.stem))
                alone += (count++ ? ", '" : "'") + image.stem + "'";
        if (!count)
            continue;
        if (count == (int)sets.direct[c].images.size())
            throw Failure("no image of --direct" + number + "='" + o.images.direct[c] + "' has the name of one of --glass" + number
                          + "='" + o.images.glass[c] + "' in which the target was found: the two images of a pair need equal names "
                          "(without folder and extension), or give one image each");
        command.warn("not used, as there is no image of that name in --glass" + number + ": " + alone);
    }
}

void warnNotFound(const RigImages& sets, const Command& command)
{
    for (const DetectedImages* set : sets.all())
        for (const std::string& path : set->withoutTarget)
            command.warn("the target was not found in '" + path + "'");
}

CheckImages readViews(const CheckOptions& o, const Calibration& calibration, const Command& command)
{
    const Target target(o.target);
    const int count = (int)calibration.cameras.size(), given = o.images.cameraCount();
    if (given > count)
        throw Failure(format("'%s' has %d camera%s: leave --glass%d out", o.calibration.c_str(), count, count == 1 ? "" : "s", given));
    PerCamera<cv::Size> sizes;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
        sizes[c] = o.imageSize.empty() ? calibration.cameras[c].camera->imageSize() : parseSize(o.imageSize, "--image-size");
    RigImages sets = readRigImages(o.images, &target, sizes, command.quiet());
    sets.nameSingles();
    requirePairs(o, sets, command);
    warnNotFound(sets, command);
    CheckImages result;
    for (const DetectedImages* set : sets.all())
        result.files.insert(result.files.end(), set->files.begin(), set->files.end());
    for (const UsedImage& image : usedImages(sets))
        result.shown.push_back(image.image);
    for (const View& view : groupIntoViews(&target, sets, false).views)
        if (view.hasGlass())
            result.views.push_back(view);
    return result;
}

CheckImages readScene(const CheckOptions& o, const Calibration& calibration, const Command& command)
{
    std::vector<std::string> sources(o.scene.begin(), o.scene.end());
    while (!sources.empty() && sources.back().empty())
        sources.pop_back();
    for (size_t c = 0; c < sources.size(); c++)
        if (sources[c].empty())
            throw Failure("there is no --scene" + cameraSuffix((int)c) + ": give images of each camera, in the calibration's order");
    std::vector<Frames> cameras = framesOf(sources, calibration, o.calibration, o.images.viewPattern);
    CheckImages result;
    for (const Frames& frames : cameras)
        for (const std::string& path : frames.paths())
            result.files.push_back(path);
    SceneOptions options;
    options.depth = o.depth.empty() ? calibratedDepthRange(calibration, o.calibration) : givenDepthRange(o.depth, calibration);
    result.scene = matchScene(calibration, cameras, options, command.quiet());
    return result;
}

} // namespace

CheckImages readCheckImages(const CheckOptions& options, const Calibration& calibration, const Command& command)
{
    return options.isOfScene() ? readScene(options, calibration, command) : readViews(options, calibration, command);
}

CheckResult checkImages(const CheckOptions& options, const CheckImages& images, const Calibration& calibration, CheckInput& input)
{
    return options.isOfScene() ? checkMatches(options, images.scene, calibration, input)
                               : checkViews(options, images.views, calibration, input);
}

} // namespace tools
