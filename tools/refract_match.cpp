// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/measured_causes.hpp"
#include "console/cli.hpp"
#include "console/csv.hpp"
#include "console/file_output.hpp"
#include "console/table.hpp"
#include "console/view_names.hpp"
#include "match/depth_range.hpp"
#include "match/features.hpp"
#include "match/scene_matches.hpp"
#include "measure/view_observations.hpp"
#include "report/drawing.hpp"

#include <iostream>
#include <sstream>

static const char MANUAL[] = R"(Finds points of a scene that several cameras see through their windows: matches, without a board.

  refract_match calib.yml 'left/*.png' 'right/*.png' --depth=450,1150 --out=matches.csv

One image, quoted glob, numbered images (left%04d.png) or video of each camera of calib.yml, in its order, up to 16. Images of one moment
have equal stems. --depth is the range of z of the scene in the frame of camera 1, in the unit of calib.yml; without it, the calibrated
volume and half as far again.

Features (--features: OpenCV's SIFT, or what else it has) are compared only where they are near the refracted epipolar curve; a match is
one that two features choose each other for, clearly before all others. --search is how far from the curve they may be: by default, what
the calibration does not know, and what a turn by 0.3 degrees since then does. At most --count are taken, spread over image and depth. Then
all are fitted, with the rig within what is known of it and what may have turned: a match that no point explains is left out.

matches.csv: image,id,u1,v1,u2,v2,...,std1,std2,..., raw pixels, and how well each is known, one standard deviation of a coordinate. It
follows from the residuals of the matches by the size of the features. For refract_bundle; refract_check --scene does both.

Of two cameras a wrong match along the curve cannot be seen; the count that is expected is said.

--picture draws some of the first moment's matches: points of camera 1, and in camera 2 their curves (dashed: with the windows ignored) and
partners. The residuals are told beside those of the same matches with the windows ignored.

Exit code: 0 done, 1 could not do it, 2 done and written, but the images are not what they are given for: taken without the windows.)";

namespace {

using namespace tools;

struct Options
{
    std::string calibration, viewPattern, depth, out, picture;
    std::vector<std::string> images;
    SceneOptions scene;
    bool noWindow = false;
};

void addOptions(OptionParser& parser, Options& o)
{
    parser.add("calib.yml", o.calibration, "of two cameras or more, what refract_calib wrote").required();
    parser.add("IMAGES", o.images, "of each camera: an image, a quoted glob or a video").required();
    addViewPattern(parser, o.viewPattern);
    parser.add("--depth", o.depth, "NEAR,FAR: z of the scene in the frame of camera 1; FAR may be inf");
    parser.add("--search", o.scene.search, "pixels from the epipolar curve within which partners are looked for").check(moreThanZero());
    o.scene.count = 10000;          // what is calibrated again from them gains from more than a check does
    parser.add("--count", o.scene.count, "matches at most").check(isCount()).captureDefault();
    parser.add("--features", o.scene.features, "of OpenCV: SIFT is placed best, ORB is fastest").check(isMember(featureNames()))
        .captureDefault();
    parser.add("--most-features", o.scene.mostFeatures, "features of an image at most, the strongest").check(isCount()).captureDefault();
    parser.add("--out", o.out, "matches.csv to write").required();
    parser.add("--picture", o.picture, "picture to write: matches of cameras 1 and 2, and their curves");
    parser.addFlag("--no-window", o.noWindow, "calib.yml has no glass_window, and there is none");
}

std::string csvOf(const Matches& matches)
{
    std::ostringstream csv;
    csv << "image,id";
    for (int c = 1; c <= matches.cameraCount(); c++)
        csv << ",u" << c << ",v" << c;
    for (int c = 1; c <= matches.cameraCount(); c++)
        csv << ",std" << c;
    csv << '\n';
    for (int i = 0; i < (int)matches.names.size(); i++)
    {
        csv << cellOf(matches.names[i].image) << ',' << cellOf(matches.names[i].id);
        for (int c = 0; c < matches.cameraCount(); c++)
            csv << (matches.isSeen(c, i) ? format(",%.3f,%.3f", matches.pixels[c][i].x, matches.pixels[c][i].y) : ",,");
        for (int c = 0; c < matches.cameraCount(); c++)
            csv << (matches.isSeen(c, i) ? format(",%.3f", matches.stds[c][i]) : ",");
        csv << '\n';
    }
    return csv.str();
}

//! Some matches of cameras 1 and 2 of the first moment that has any, spread over the image.
cv::Mat pictureOf(const SceneMatches& result, const Calibration& calibration, std::vector<Frames>& frames, const cv::Vec2d& depth)
{
    const int MOST = 24;
    const Matches& m = result.good.matches;
    const auto isSeen = [&](int i) { return m.isSeen(0, i) && m.isSeen(1, i); };
    std::vector<int> first;
    for (int i = 0; i < result.good.size(); i++)
        if (isSeen(i) && (first.empty() || m.names[i].image == m.names[first[0]].image))
            first.push_back(i);
    if (first.empty())
        throw Failure("--picture: cameras 1 and 2 have no match");
    const Calibration pair = firstTwoCameras(calibration);
    std::vector<cv::Point2d> points, partners;
    const ScaledMatches ofFirst = result.good.only(first);
    for (int i : spreadChoice(ofFirst, modelOf(calibration), MOST))
    {
        points.push_back(ofFirst.matches.pixels[0][i]);
        partners.push_back(ofFirst.matches.pixels[1][i]);
    }
    const std::vector<cv::Mat> images = imagesOfMoment(calibration, frames, m.names[first[0]].image);
    return epipolarPicture(images[0], images[1], points, partners, curvesOf(pair, points, depth),
                           curvesOf(withoutWindows(pair), points, depth));
}

//! What the images are in place of what they are given for; empty: that. Some of the matches tell.
std::string mixupOf(const SceneMatches& result, const Calibration& calibration)
{
    const int ENOUGH = 1000;
    const RigModel rig = modelOf(calibration);
    const ScaledMatches some = result.good.only(spreadChoice(result.good, rig, ENOUGH));
    return mixupIn(calibration, observationsOf(rig, some.matches), some.matches.usualStd());
}

void print(const SceneMatches& result, double withoutWindows)
{
    std::cout << format("%zu matches of %d moment%s, %d of them left out as no point explains them; about %.0f wrong ones are left\n",
                        result.good.matches.names.size(), result.moments, result.moments == 1 ? "" : "s", result.leftOut, result.wrongLeft)
              << format("%d were found within %.1f px of their curves, %d taken, spread over image and depth\n", result.found,
                        result.search, result.chosen)
              << format("residuals: %.3f px RMS; the same matches with the windows ignored: %.3f px\n", result.residual, withoutWindows)
              << format("standard deviation of a pixel: %.3f px; sqrt(%.3f^2 + (%.3f^2 + %.3f^2 d) s^2) of a feature of size s whose "
                        "descriptors differ d times as much as usual\n",
                        result.good.matches.usualStd(), result.noise.floor, result.noise.share, result.noise.unlikeShare);
}

} // namespace

int refract_match_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        Options options = parsed(command, addOptions);
        const Calibration calibration = readCalibration(options.calibration, options.noWindow, command);
        std::vector<std::string> inputs = options.images;
        inputs.insert(inputs.end(), {options.calibration, command.settings()});
        checkOutputs({{"--out", options.out, OUTPUT_TEXT}, {"--picture", options.picture, OUTPUT_PICTURE}}, inputs);
        std::vector<Frames> frames = framesOf(options.images, calibration, options.calibration, options.viewPattern);
        options.scene.depth = options.depth.empty() ? calibratedDepthRange(calibration, options.calibration)
                                                    : givenDepthRange(options.depth, calibration);
        const SceneMatches result = matchScene(calibration, frames, options.scene, command.quiet());
        writeText(options.out, csvOf(result.good.matches));
        if (!options.picture.empty())
            writeImage(options.picture, pictureOf(result, calibration, frames, options.scene.depth));
        if (!command.quiet())
            print(result, residualWithoutWindows(calibration, result.good));
        const std::string mixup = mixupOf(result, calibration);
        if (mixup.empty())
            return DONE;
        command.warn("the matches contradict the calibration; what explains them: " + mixup);
        return LIMIT_NOT_MET;
    });
}
