// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/calib_file.hpp"
#include "calibrate/conditions.hpp"
#include "calibrate/light.hpp"
#include "calibrate/rig_model.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"
#include "console/frames.hpp"
#include "console/numbers.hpp"
#include "console/progress.hpp"
#include "console/table.hpp"
#include "console/view_names.hpp"
#include "math/quantile.hpp"
#include "stereo/checked_stereo.hpp"
#include "stereo/cloud_file.hpp"
#include "stereo/depth_picture.hpp"
#include "stereo/wide_search.hpp"
#include "stereo/pair_reader.hpp"
#include "stereo/dense_stereo.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

static const char MANUAL[] = R"(Measures the depth of every pixel that two cameras see through their windows.

  refract_stereo calib.yml LEFT RIGHT --depth=NEAR,FAR --out=cloud.ply [--depth-map=depth.tiff] [--picture=depth.png]
  refract_stereo calib.yml 'left/*.png' 'right/*.png' --depth=NEAR,FAR --out-dir=DIR

LEFT is of camera 1, RIGHT of camera 2: images, or quoted globs, where images of one moment have equal stems; numbered
images (left%04d.png) or videos (.avi, .mp4, .mkv ...), where frames of one moment have equal numbers.
--depth is the range of z in the frame of camera 1, in the unit of calib.yml; FAR may be inf. Without it, the range is that
of details found in both images, and printed.

cloud.ply: a vertex for each pixel that was matched: x y z in the frame of camera 1, red green blue, sx sy sz (one standard
deviation of x, y, z; nan: unknown). depth.tiff: float32, z of each raw pixel of camera 1; nan: not matched. depth.png: the
same in colours, with a scale. --out-dir writes STEM.ply, STEM_depth.tiff and STEM_depth.png of each pair; frames of videos
are called frame000001 and so on.

--outer-index=seawater:T=8,S=35 says the scene's medium now, where it is not that of the calibration; what is not known of its index
(--outer-index-std) is in sx, sy, sz.

The table: pixels of camera 1 with a depth; the range of depths but for the outermost percent at either end; the median sz; the
row error stated, which a rectification for one plane leaves over the range (RMS, largest; the second pass removes it); the
row error found in the images (RMS), of one standard deviation of what the calibration's covariance and the noise allow for.

Nothing is written at a depth outside --depth, of a match whose patches do not look alike, or where small images, matched over all
depths, look alike outside --depth. Rows that contradict the calibration are told with the causes that would explain them, and by
how much these would change depths: up to 2 % the cloud is written, with that in sx, sy, sz; beyond it is refused.

Exit code: 0 done, 1 could not do it, 2 done and written, but images and calibration contradict each other, more than 5 % of what
both images show lies outside --depth (--crop: on purpose), a pair of several was refused, or rows differ by more than
--max-row-error.)";

namespace {

using namespace tools;
namespace fs = std::filesystem;

const int PAIRS_SEARCHED = 5;

struct Options
{
    std::string calibration, left, right, viewPattern, depth, out, depthMap, picture, rectifiedFolder, folder, channels;
    std::string matcher = "3way";
    MatcherOptions matching;
    double maxRowError = 0;             // 0: none is set
    bool noWindow = false, crop = false;
    ConditionsOptions conditions;
};

//! Of one pair; empty: not asked for.
struct PairFiles
{
    std::string cloud, depthMap, picture, rectifiedPrefix;
};

void requirePly(const std::string& cloud)
{
    const std::string extension = fs::path(cloud).extension().string();
    if (!cloud.empty() && extension != ".ply" && extension != ".PLY" && !isSpecialFile(cloud))
        throw Failure("--out=" + cloud + ": the cloud is a .ply");
}

void checkCombination(const Options& options)
{
    const bool single = !options.out.empty() || !options.depthMap.empty() || !options.picture.empty();
    if (!options.folder.empty() && single)
        throw Failure("--out-dir writes cloud, depth map and picture of each pair: leave --out, --depth-map and --picture out");
    if (options.folder.empty() && !single && options.rectifiedFolder.empty())
        throw Failure("say what to write: --out=cloud.ply, --depth-map=depth.tiff, --picture=depth.png, or --out-dir=DIR for all "
                      "of them");
    if (options.matching.block % 2 == 0)
        throw Failure(format("--block=%d: give an odd number", options.matching.block));
    const std::string extension = fs::path(options.depthMap).extension().string();
    if (!options.depthMap.empty() && extension != ".tiff" && extension != ".tif" && !isSpecialFile(options.depthMap))
        throw Failure("--depth-map=" + options.depthMap + ": its numbers need a .tiff; --picture is for looking at");
}

Calibration readPair(const Options& options, const Command& command)
{
    const Calibration rig = readCalibration(options.calibration);
    if (rig.single())
        throw Failure("'" + options.calibration + "' has one camera; depth needs a calibrated pair (refract_calib --direct2 "
                      "--glass2)");
    requireWindows(rig, options.calibration, options.noWindow);
    warnOfContradictions(rig, options.calibration, command);
    if (rig.cameras.size() > 2)
        command.warn(format("'%s' has %d cameras: depth is that of cameras 1 and 2", options.calibration.c_str(), (int)rig.cameras.size()));
    if (!command.quiet() && options.conditions.isSaid())
        std::cout << options.conditions.notice(rig) << "\n\n";
    return firstTwoCameras(options.conditions.appliedTo(rig, options.calibration));
}

std::vector<PairFiles> filesOf(const Options& options, const std::vector<FramePair>& pairs)
{
    if (options.folder.empty() && pairs.size() > 1)
        throw Failure(format("'%s' and '%s' are %d pairs: give --out-dir=DIR", options.left.c_str(), options.right.c_str(),
                             (int)pairs.size()));
    const std::string rectified = options.rectifiedFolder.empty() ? "" : options.rectifiedFolder + "/";
    if (options.folder.empty())
        return {{options.out, options.depthMap, options.picture, rectified}};
    std::vector<PairFiles> files;
    for (const FramePair& pair : pairs)
    {
        const std::string base = options.folder + "/" + pair.stem;
        files.push_back({base + ".ply", base + "_depth.tiff", base + "_depth.png",
                         rectified.empty() ? "" : rectified + pair.stem + "_"});
    }
    return files;
}

void refuseOverwriting(const Options& options, const std::string& settings, const Frames& first, const Frames& second,
                       const std::vector<PairFiles>& files)
{
    std::vector<std::string> inputs = {options.calibration, settings};
    for (const Frames* frames : {&first, &second})
        for (const std::string& path : frames->paths())
            inputs.push_back(path);
    std::vector<Output> outputs;
    const bool inFolder = !options.folder.empty();
    for (const PairFiles& f : files)
    {
        outputs.push_back({inFolder ? "--out-dir" : "--out", f.cloud, inFolder ? OUTPUT_IN_FOLDER : OUTPUT_TEXT});
        outputs.push_back({inFolder ? "--out-dir" : "--depth-map", f.depthMap, inFolder ? OUTPUT_IN_FOLDER : OUTPUT_PICTURE});
        outputs.push_back({inFolder ? "--out-dir" : "--picture", f.picture, inFolder ? OUTPUT_IN_FOLDER : OUTPUT_PICTURE});
        if (!f.rectifiedPrefix.empty())
            for (const std::string& path : rectifiedFiles(f.rectifiedPrefix))
                outputs.push_back({"--rectified-dir", path, OUTPUT_IN_FOLDER});
    }
    checkOutputs(outputs, inputs);
}

//! From several pairs, as a scene may change.
cv::Vec2d foundRange(const Calibration& rig, PairReader& reader, const std::vector<FramePair>& pairs, const Command& command)
{
    const int count = std::min(PAIRS_SEARCHED, (int)pairs.size());
    Progress progress("looking for the range of depths", count, command.quiet());
    std::vector<float> depths;
    for (int i = 0; i < count; i++)
    {
        const FramePair& pair = pairs[i*pairs.size()/count];
        progress.at(pair.stem);
        const auto images = reader.read(pair);
        const std::vector<float> found = depthsOfFeatures(rig, images.first, images.second);
        depths.insert(depths.end(), found.begin(), found.end());
        progress.step();
    }
    std::sort(depths.begin(), depths.end());
    const cv::Vec2d range = depthRangeOf(depths, rig);
    if (!command.quiet())
        std::cout << format("range of depths: --depth=%.4g,%.4g, from %d details seen in both images\n\n", range[0], range[1],
                            (int)depths.size());
    return range;
}

//! The median: a few far points have any sz.
double typicalSigmaZ(const Cloud& cloud)
{
    std::vector<double> known;
    for (const CloudPoint& point : cloud)
        if (point.sigma[2] == point.sigma[2])
            known.push_back(point.sigma[2]);
    return median(known);
}

class Tool
{
public:
    Tool(const Options& options, const Calibration& rig, const cv::Vec2d& range)
        : options_(options), rig_(rig, range), checker_(rig_, options.matching, options.crop, options.calibration)
    {
        if (!options.channels.empty())
            rig_.correctColours(parseChannels(options.channels), options.calibration);
    }

    const RectifiedRig& rig() const { return rig_; }

    //! Writes the pair, unless it is refused.
    void process(const std::pair<cv::Mat, cv::Mat>& images, const PairFiles& files, PairResult& result)
    {
        const int64 start = cv::getTickCount();
        const CheckedStereo checked = checker_.match(images.first, images.second);
        result.warnings = checked.warnings;
        result.refusal = checked.refusal;
        if (!result.refusal.empty())
            return;
        const DenseStereo& stereo = checked.stereo;
        const Cloud cloud = cloudOf(stereo.points, stereo.rectified1, stereo.sigma);
        const cv::Mat depth = depthOfRawPixels(rig_, stereo);
        const std::vector<float> sorted = sortedDepths(depth);
        const double rare = 0.01;
        result.matched = (double)sorted.size()/(double)depth.total();
        result.near = cv::refract::quantile(sorted, rare);
        result.far = cv::refract::quantile(sorted, 1 - rare);
        result.typicalSigma = typicalSigmaZ(cloud);
        result.rowsFound = checked.rows.found;
        result.rowsExpected = checked.rows.expected;
        result.seconds = (double)(cv::getTickCount() - start)/cv::getTickFrequency();
        write(files, stereo, cloud, depth);
    }

private:
    void write(const PairFiles& files, const DenseStereo& stereo, const Cloud& cloud, const cv::Mat& depth) const
    {
        const std::string unit = rig_.calibration().unit;
        for (const std::string& folder : {options_.folder, options_.rectifiedFolder})
            if (!folder.empty())
                makeFolder(folder);
        if (!files.cloud.empty())
            writeCloud(files.cloud, cloud, unit);
        if (!files.depthMap.empty())
            writeImage(files.depthMap, depth);
        if (!files.picture.empty())
            writeImage(files.picture, depthPicture(depth, unit));
        if (!files.rectifiedPrefix.empty())
            writeRectified(files.rectifiedPrefix, stereo.rectified1, stereo.rectified2, stereo.disparity, rig_.vertical());
    }

    Options options_;
    RectifiedRig rig_;
    StereoChecker checker_;             // of rig_
};

//! False if the row errors are beyond the caller's limit.
bool areRowsWithin(const Options& options, const std::vector<PairResult>& results, const Command& command)
{
    const PairResult worst = *std::max_element(results.begin(), results.end(), [](const PairResult& a, const PairResult& b) {
        return std::isnan(b.rowsFound) ? !std::isnan(a.rowsFound) : a.rowsFound < b.rowsFound; });
    if (options.maxRowError > 0 && std::isnan(worst.rowsFound))
        command.warn("the row error could not be measured, so --max-row-error is not met");
    return !(options.maxRowError > 0) || worst.rowsFound <= options.maxRowError;
}

//! Which light the answer is of.
void sayColour(const Options& options, const Calibration& rig, bool colourImages)
{
    if (!colourImages)
        return;
    const std::string notice = oneColourNotice(*rig.cameras[0].camera);
    if (!options.channels.empty())
        std::cout << "each colour rectified by itself\n\n";
    else if (rig.channel != BRIGHTNESS)
        std::cout << "matched: the " << nameOf(rig.channel) << " channel, as calibrated\n\n";
    else if (!notice.empty())
        std::cout << "rectified " << notice << "\n\n";
}

/* What the images say against the calibration or the range: of many pairs mostly the same, so that the first is told, and how many
there are. False if there is any. */
bool sayContradictions(const std::vector<PairResult>& results, const Command& command)
{
    size_t count = 0;
    for (const PairResult& r : results)
        for (const std::string& warning : r.warnings)
            if (count++ == 0 || results.size() == 1)
                command.warn("'" + r.stem + "': " + warning);
    if (results.size() > 1 && count > 1)
        command.warn(format("%d more such contradictions in other pairs", (int)count - 1));
    return count == 0;
}

void warnUnpaired(const std::vector<std::string>& stems, int camera, const Command& command)
{
    if (!stems.empty())
        command.warn(format("skipped of camera %d, as camera %d has no image of that name: ", camera, 3 - camera)
                     + listed(stems));
}

void addOptions(OptionParser& parser, Options& options)
{
    parser.add("calib.yml", options.calibration, "of a stereo pair, what refract_calib wrote").required();
    parser.add("LEFT", options.left, "of camera 1: image, quoted glob, numbered images, video").required();
    parser.add("RIGHT", options.right, "of camera 2, of the same moments").required();
    addViewPattern(parser, options.viewPattern);
    parser.add("--depth", options.depth, "NEAR,FAR: range of z in the frame of camera 1; FAR may be inf (default: found in "
               "the images)");
    parser.add("--out", options.out, "cloud of points to write, .ply");
    parser.add("--depth-map", options.depthMap, "z of each raw pixel of camera 1 to write, .tiff (float32)");
    parser.add("--picture", options.picture, "the same in colours, with a scale");
    parser.add("--out-dir", options.folder, "folder for all three of each pair, made if it is not there");
    parser.add("--rectified-dir", options.rectifiedFolder, "folder for the rectified images (left.png, right.png, pair.png "
               "with lines drawn in) and disparity.tiff (float32, px)");
    parser.add("--matcher", options.matcher, "cv::StereoSGBM along three paths (3way) or all eight (hh: slower)")
        .check(isMember({"3way", "hh"})).captureDefault();
    parser.add("--block", options.matching.block, "side of the matched block, px, odd: larger for noise, smaller for detail")
        .check(isCountUpTo(21)).captureDefault();
    parser.add("--passes", options.matching.passes, "1: rectified for a plane; 2: then for the depths found")
        .check(isCountUpTo(2)).captureDefault();
    parser.add("--channels", options.channels, "R,G,B: wavelength of each channel of colour images, nm, as 610,540,465; each "
               "is rectified by itself, as a window in front of water bends blue more than red");
    options.conditions.addTo(parser);
    parser.addFlag("--crop", options.crop, "a part of the scene outside --depth is left out on purpose: no warning of it");
    parser.add("--max-row-error", options.maxRowError, "px: exit code 2 if the images show more").check(moreThanZero());
    parser.addFlag("--no-window", options.noWindow, "calib.yml has no glass_window, and there is none");
}

} // namespace

int refract_stereo_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        Options options = parsed(command, addOptions);
        options.matching.fullPaths = options.matcher == "hh";
        checkCombination(options);
        if (!options.depth.empty())
            parseDepthRange(options.depth, "--depth");
        if (!options.channels.empty())
            parseChannels(options.channels);
        const Calibration rig = readPair(options, command);
        Frames first(options.left, options.viewPattern), second(options.right, options.viewPattern);
        const FramePairs frames = pairsOf(first, second);
        const std::vector<PairFiles> files = filesOf(options, frames.pairs);
        refuseOverwriting(options, command.settings(), first, second, files);
        requirePly(options.out);
        warnUnpaired(frames.unpaired1, 1, command);
        warnUnpaired(frames.unpaired2, 2, command);

        PairReader reader(first, second, rig, !options.channels.empty());
        auto images = reader.read(frames.pairs[0]);
        for (const CameraCalibration& camera : rig.cameras)
            if (camera.camera->imageSize().empty())
                camera.camera->setImageSize(images.first.size());
        Tool tool(options, rig, options.depth.empty() ? foundRange(rig, reader, frames.pairs, command)
                                                      : givenDepthRange(options.depth, rig));
        if (!command.quiet())
            sayColour(options, rig, images.first.channels() == 3);
        std::vector<PairResult> results, refused;
        {
            Progress progress("matching", (int)frames.pairs.size(), command.quiet());
            for (size_t i = 0; i < frames.pairs.size(); i++)
            {
                progress.at(frames.pairs[i].stem);
                if (i > 0)
                    images = reader.read(frames.pairs[i]);
                PairResult result;
                result.stem = frames.pairs[i].stem;
                tool.process(images, files[i], result);
                (result.refusal.empty() ? results : refused).push_back(result);
                progress.step();
            }
        }
        if (results.empty())
            throw Failure("'" + refused[0].stem + "': " + refused[0].refusal);
        for (const PairResult& r : refused)
            command.warn("nothing is written of '" + r.stem + "': " + r.refusal);
        if (!command.quiet())
            printTable(results, tool.rig());
        const bool fits = sayContradictions(results, command), rowsFit = areRowsWithin(options, results, command);
        return fits && rowsFit && refused.empty() ? DONE : LIMIT_NOT_MET;
    });
}
