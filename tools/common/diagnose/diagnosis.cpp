// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/diagnosis.hpp"
#include "calibrate/fit.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "diagnose/plain_fit.hpp"
#include "diagnose/image_disagreement.hpp"
#include "diagnose/image_mistakes.hpp"
#include "diagnose/value_mistakes.hpp"
#include <algorithm>
#include <iterator>
#include <set>

using namespace cv::refract;

namespace tools {

namespace {

const double IMPLAUSIBLE = 10.;         // times the RMS of the same corners if each camera is fitted separately:
const double MIN_IMPLAUSIBLE_PX = 1.;   // then the given values do not belong to the images
const double CLEAN = 1.3;               // times what the lens's own images leave: no more than noise
const double EXPLAINS = 0.3;            // a mistake undone leaves less than this share
const double VALUE_BEFORE = 1.1;        // what changes less of what is given comes first, unless it leaves so much more
const double MEDIAN = 1.1774;           // length of an error of two coordinates, in their standard deviations
const size_t MOST_POSSIBLE = 4;         // mix-ups that are fitted without geometry asking for it: a second each

const char* const NOTHING_TRIED = "neither another square, thickness, index or medium, nor images exchanged or wrongly paired "
    "explain it. Check --pattern and --size, that the images are from this camera with the same zoom and focus, that the target "
    "is flat, and the images themselves";

//! What leaves no more than noise ends the search.
bool isFound(const std::vector<Explanation>& explaining, double clean)
{
    return std::any_of(explaining.begin(), explaining.end(), [&](const Explanation& e) { return e.px < clean; });
}

std::string joined(const std::vector<std::string>& reasons)
{
    return reasons.empty() ? NOTHING_TRIED : alternatives(reasons);
}

bool hasBoardsOnly(const CalibrationInput& input)
{
    return std::all_of(input.data.views.begin(), input.data.views.end(), [](const View& view) { return !view.neighbours.empty(); });
}

bool sharesWindows(const CalibrationInput& input)
{
    const std::vector<int>& windows = input.options.windows;
    return std::set<int>(windows.begin(), windows.end()).size() < windows.size();
}

//! Two cameras see another board, or it moved between their images.
bool areUnrelated(const MixUps& mixUps) { return mixUps.camerasApart > MOMENTS_PX; }

bool isRig(const CalibrationInput& input) { return input.data.cameraCount > 1; }

bool hasBothStates(const CalibrationInput& input)
{
    bool direct = false, glass = false;
    for (const View& view : input.data.views)
    {
        direct = direct || view.countDirect() > 0;
        glass = glass || view.hasGlass();
    }
    return direct && glass;
}

bool knowsLenses(const CalibrationInput& input)
{
    return std::any_of(input.options.known.begin(), input.options.known.end(), [](const auto& lens) { return bool(lens); });
}

//! Lenses, too, only images through the windows tell.
bool isSealed(const CalibrationInput& input) { return !input.data.hasDirect() && !knowsLenses(input); }

//! Not a value near what is given.
const Mistake FAR_OFF[] = {
    {knowsLenses, wrongFocalLength},
    {hasBothStates, swappedStates},
    {[](const CalibrationInput& input) { return !hasBoardsOnly(input); }, mirroredPoints},
    {[](const CalibrationInput&) { return true; }, wrongMedium},
    {sharesWindows, separateWindows}};

const Mistake SCALE = {[](const CalibrationInput& input) { return hasPairs(input.data) && !input.options.window.thickness.empty(); },
                       wrongScale};

//! The mistakes that are tried, the quick ones first.
const Mistake MISTAKES[] = {
    SCALE,
    {[](const CalibrationInput& input) { return !hasPairs(input.data) && !(input.square > 0); }, wrongUnitOfPoints},
    {[](const CalibrationInput& input) { return hasPairs(input.data) && isRig(input); }, swappedStatesOfOneCamera},
    {[](const CalibrationInput& input) { return hasPairs(input.data) && input.options.window.index.size() == 1; }, wrongIndex},
    {[](const CalibrationInput& input) { return !input.options.window.thickness.empty(); }, wrongShape}};

//! What gives each image or each camera a place of its own explains any mistake in what they have in common: if nothing else does.
const Mistake LAST_MISTAKES[] = {
    {[](const CalibrationInput& input) { return !isRig(input); }, camerasInOneFolder},
    {[](const CalibrationInput& input) { return hasPairs(input.data); }, oddImages},
    {[](const CalibrationInput& input) { return hasPairs(input.data) && !isRig(input); }, pairsOfTwoCameras},
    {[](const CalibrationInput& input) { return hasPairs(input.data); }, unpairedImages},
    {isRig, unrelatedViews}};

/** px, that correct input leaves: as much as the lens's own images do, or, of lenses that only images through the windows tell, as smooth
maps do; 0: not known.
@param noise px, what smooth maps leave (noiseOfImages) */
double cleanError(const CalibrationInput& input, double noise)
{
    double worst = 0.;
    for (int c = 0; c < input.data.cameraCount; c++)
        worst = std::max(worst, errorOfDirect(input, c));
    return CLEAN*(worst > 0. || knowsLenses(input) ? worst : MEDIAN*noise);
}

template <size_t N>
std::vector<Explanation> explanationsOf(const CalibrationInput& input, const Mistake (&mistakes)[N], double maxPx, double clean,
                                        const PlainFit& plain)
{
    std::vector<Explanation> tried;
    for (const Mistake& mistake : mistakes)
    {
        if (!mistake.appliesTo(input))
            continue;
        tried.push_back(mistake.undo == wrongMedium && plain.otherMedium ? *plain.otherMedium : mistake.undo(input));
        if (tried.back().px < std::min(clean, maxPx))
            break;
    }
    return bestBelow(maxPx, tried);
}

/** px, that a motion of the boards of pairs may leave which --placement-std allows: a fit that looks for causes takes values as exact. */
double allowedError(const CalibrationInput& input)
{
    std::vector<double> scales;         // pixels a unit of length has
    for (const View& view : input.data.views)
        for (int c = 0; c < input.data.cameraCount && hasPairs(input.data); c++)
            for (const auto& [a, b] : view.hasGlass(c) ? view.neighbours : std::vector<std::pair<int, int>>())
                scales.push_back(cv::norm(view.glass[c][b] - view.glass[c][a])/cv::norm(view.objectPoints[b] - view.objectPoints[a]));
    scales.erase(std::remove_if(scales.begin(), scales.end(), [](double scale) { return std::isnan(scale); }), scales.end());
    if (scales.empty())
        return 0.;
    return MEDIAN*median(scales)*input.options.std.placement;
}

/** What leaves more than the images' own noise, and than what --placement-std allows, explains only a part.
@param clean px, of cleanError; 0: not known */
std::string fits(const CalibrationInput& input, const Explanation& e, double clean)
{
    const std::string text = format("the same images fit within %.2g px with ", e.px) + e.sentence;
    const bool isBent = input.options.window.shape == WINDOW_BENT;  // which a trial takes as flat: what its bow does is left
    const bool isMore = clean > 0. && !isBent && e.px > std::hypot(clean, allowedError(input));
    return isMore ? text + format("; or something else is wrong, as more than %.2g px is not noise", clean) : text;
}

/** What explains images by themselves. Images exchanged, turned or of other places hide much of a window of another shape, which none of
that makes right: then the shape explains far more. */
std::vector<std::string> told(const CalibrationInput& input, const std::vector<Explanation>& explaining, double clean)
{
    double best = NO_FIT;
    for (const Explanation& e : explaining)
        best = std::min(best, e.px);
    const Explanation shape = best > clean && best < NO_FIT ? wrongShape(input) : Explanation{"", NO_FIT};
    if (EXPLAINS_AS_WELL*shape.px < best)
        return {fits(input, shape, clean)};
    std::vector<std::string> sentences;
    for (const Explanation& e : explaining)
        sentences.push_back(fits(input, e, clean));
    return sentences;
}

//! Of what makes the images agree, what fits. @param most that are tried
std::vector<Explanation> fitted(const CalibrationInput& input, const std::vector<MixUp>& mixUps, size_t most)
{
    std::vector<Explanation> tried;
    for (size_t i = 0; i < std::min(most, mixUps.size()); i++)
        tried.push_back({mixUps[i].sentence, medianErrorOfFit(mixUps[i].undone(), input.options)});
    return tried;
}

std::vector<std::string> confirmed(const CalibrationInput& input, const std::vector<MixUp>& mixUps, size_t most, double clean)
{
    return told(input, bestBelow(largestSoundError(input.data), fitted(input, mixUps, most)), clean);
}

//! Those that are clear, and, where none leaves only noise, others that pinholes hardly tell from them.
std::vector<std::string> confirmedClear(const CalibrationInput& input, const MixUps& mixUps, double clean)
{
    std::vector<Explanation> tried = fitted(input, mixUps.clear, mixUps.clear.size());
    if (!tried.empty() && !isFound(tried, clean))
        for (const Explanation& e : fitted(input, mixUps.possible, MOST_POSSIBLE))
            tried.push_back(e);
    return told(input, bestBelow(largestSoundError(input.data), tried), clean);
}

/** What is wrong with images whatever the window is: each image and each camera is right by itself. Those that give images or cameras
places of their own come last, as they explain any other. */
std::vector<std::string> imageMistakes(const CalibrationInput& input, const MixUps& mixUps, const PlainFit& plain)
{
    if (isSealed(input) && isRig(input))
    {
        const Explanation medium = wrongMediumOfEach(input, cleanError(input, noiseOfImages(input)));
        if (medium.px < NO_FIT)
            return {fits(input, medium, 0.)};
    }
    const double sound = largestSoundError(input.data), clean = cleanError(input, plain.noise);
    if (!hasPairs(input.data))          // of hand-held boards a window or a lens between two others explains much, too
    {
        const Explanation apart = camerasInOneFolder(input);
        if (apart.px < clean)
            return told(input, {apart}, clean);
    }
    std::vector<std::string> sentences = confirmedClear(input, mixUps, clean);
    if (!sentences.empty())
        return sentences;
    for (const std::string& sentence : {partOfBoard(input, 2), badCorners(input)})
        if (!sentence.empty())
            return {sentence};
    const bool isUnpaired = pairsFromOneMap(input.data) > WINDOWS_PX;
    for (const auto& explain : {camerasInOneFolder, oddImages, pairsOfTwoCameras})
    {
        const Explanation some = isUnpaired ? explain(input) : Explanation{"", NO_FIT};
        if (some.px < sound)
            return told(input, {some}, clean);
    }
    const std::string part = partOfBoard(input, 1);
    if (!part.empty())
        return {part};
    if (isUnpaired && areUnrelated(mixUps))
    {
        const Explanation other = imagesOfOtherMoments(input);
        if (other.px < sound)
            return told(input, {other}, clean);
    }
    const Explanation unpaired = isUnpaired ? unpairedImages(input) : Explanation{"", NO_FIT};
    if (unpaired.px < sound)    // a far window's pairs seem to be unpaired, too: then one value of all images explains as much
    {
        const double asWell = CLEAN*unpaired.px;
        const std::vector<Explanation> values = bestBelow(asWell, explanationsOf(input, FAR_OFF, sound, asWell, plain));
        return told(input, values.empty() ? std::vector<Explanation>{unpaired} : values, clean);
    }
    if (!areUnrelated(mixUps))
        return {};
    std::vector<MixUp> relating;        // they explain as much with less
    std::copy_if(mixUps.possible.begin(), mixUps.possible.end(), std::back_inserter(relating), [](const MixUp& mixUp) {
        return !(mixUp.camerasApart > MOMENTS_PX); });
    sentences = confirmed(input, relating, MOST_POSSIBLE, clean);
    if (!sentences.empty())
        return sentences;
    const Explanation unrelated = unrelatedViews(input);
    if (unrelated.px < sound)
        return told(input, {unrelated}, clean);
    return {};
}

//! A contradicted value and others that explain the images about as well, the best first.
std::vector<std::string> toldBeside(const CalibrationInput& input, const Contradiction& value, const std::vector<Explanation>& others,
                                    double clean)
{
    std::vector<std::string> sentences = {value.sentence};
    for (const Explanation& e : bestBelow(EXPLAINS_AS_WELL*MEDIAN*value.sigma, others))
    {
        const bool isBest = e.px < MEDIAN*value.sigma/VALUE_BEFORE;
        sentences.insert(isBest ? sentences.begin() : sentences.end(), fits(input, e, clean));
        if (EXPLAINS_AS_WELL*e.px < MEDIAN*value.sigma)
            return {sentences[0]};
    }
    return sentences;
}

} // namespace

std::vector<std::string> diagnose(const CalibrationInput& input, const MixUps& mixUps, const PlainFit& plain, bool imagesToo)
{
    std::vector<std::string> sentences = imagesToo ? imageMistakes(input, mixUps, plain) : std::vector<std::string>();
    if (!sentences.empty())
        return sentences;
    const double sound = largestSoundError(input.data), clean = cleanError(input, plain.noise);
    if (plain.explained)        // a given value; what is much further from what is given may explain it too
    {
        std::vector<Explanation> others = explanationsOf(input, FAR_OFF, sound, clean, plain);
        if (isFound(others, clean))
            return toldBeside(input, *plain.explained, others, clean);
        if (!(plain.px < NO_FIT))       // pairs that contradict each other: a cause is one name for that, an exchange may be another
            for (const Explanation& e : explanationsOf(input, MISTAKES, sound, clean, plain))
                others.push_back(e);
        else if (plain.px > sound && SCALE.appliesTo(input))    // another unit is too far for a fit that starts from what was given
            others.push_back(SCALE.undo(input));
        if (clean > 0. && MEDIAN*plain.explained->sigma > clean)        // it leaves more than noise
            others.push_back(wrongShape(input));
        return toldBeside(input, *plain.explained, others, clean);
    }
    const double most = std::min(EXPLAINS*plain.px, sound);
    std::vector<Explanation> explaining = explanationsOf(input, FAR_OFF, most, clean, plain);
    if (!isFound(explaining, clean))
        for (const Explanation& e : explanationsOf(input, MISTAKES, most, clean, plain))
            explaining.push_back(e);
    explaining = bestBelow(most, explaining);
    if (explaining.empty())
    {
        sentences = confirmed(input, mixUps.possible, MOST_POSSIBLE, clean);
        if (!sentences.empty())
            return sentences;
        explaining = withoutFreer(explanationsOf(input, LAST_MISTAKES, most, clean, plain));
    }
    for (const Explanation& e : explaining)
        sentences.push_back(fits(input, e, clean));
    return sentences;
}

std::vector<std::string> diagnose(const CalibrationInput& input) { return diagnose(input, findMixUps(input), fitPlainly(input), true); }

void requirePlausible(const RigData& data, const std::vector<Residual>& residuals, double rmsOfSeparateFits,
                      const CalibrationInput& input)
{
    const double now = medianCornerError(data, residuals);
    std::string fault;
    if (now > largestSoundError(data) || (now > MIN_IMPLAUSIBLE_PX && now > IMPLAUSIBLE*rmsOfSeparateFits))
        fault = format("the calibration does not fit its images: half of the corners lie more than %.2g px from where it puts "
                       "them", now);
    else if (hasPairs(input.data) && !hasPairs(data))
        fault = format("all %d pair(s) contradict the calibration", input.data.countPairs());
    if (!fault.empty())
    {
        std::vector<std::string> reasons = diagnose(input);
        reasons.insert(reasons.end(), input.notices.begin(), input.notices.end());
        throw Failure(fault + ": " + joined(reasons));
    }
}

namespace {

//! @param px of the fit
[[noreturn]] void refuse(const CalibrationInput& input, double px, std::vector<std::string> reasons)
{
    reasons.insert(reasons.begin(), input.notices.begin(), input.notices.end());        // seen without a fit
    throw Failure((px < NO_FIT ? format("the calibration does not fit its images: half of the corners lie more than %.2g px from "
                                        "where it puts them", px) : std::string("no calibration fits these images"))
                  + ": " + joined(reasons));
}

} // namespace

bool requireNoMixUp(const CalibrationInput& input, const MixUps& mixUps, std::optional<RigModel>& only)
{
    if (mixUps.clear.empty() && !(pairsFromOneMap(input.data) > WINDOWS_PX) && !areUnrelated(mixUps))
        return false;
    Fit fit;
    const double px = medianErrorOfFit(input.data, input.options, &fit);
    if (px < largestSoundError(input.data))
    {
        if (isOnlyMinimum(input.data, fit, input.options.flags))
            only = fit.rig;
        return false;
    }
    const std::vector<std::string> reasons = imageMistakes(input, mixUps, PlainFit());
    if (!reasons.empty())
        refuse(input, px, reasons);
    return true;
}

bool isSuspicious(const CalibrationInput& input, PlainFit& plain)
{
    if (!(plain.px < largestSoundError(input.data)))
        return true;
    const double clean = cleanError(input, plain.noise);
    if (clean > 0. && CLEAN*plain.px > IMPLAUSIBLE*clean)
        return true;
    // In another medium than theirs images fit to some extent, with a window that is tilted far, or with another focal length; those of
    // two cameras with what is between theirs.
    if (!(CLEAN*clean < plain.px))
        return false;
    plain.otherMedium = wrongMedium(input);
    return plain.otherMedium->px < EXPLAINS*plain.px || (!hasPairs(input.data) && camerasInOneFolder(input).px < clean);
}

bool isSound(const CalibrationInput& input, const PlainFit& plain, bool suspicious)
{
    return plain.px < largestSoundError(input.data) && !(plain.px > MIN_IMPLAUSIBLE_PX && suspicious);
}

void requireNoCause(const CalibrationInput& input, const MixUps& mixUps, const PlainFit& plain, bool imagesToo)
{
    const std::vector<std::string> reasons = diagnose(input, mixUps, plain, imagesToo);
    if (!reasons.empty())
        refuse(input, plain.px, reasons);
}

void refuseUnexplained(const CalibrationInput& input, const PlainFit& plain) { refuse(input, plain.px, {}); }

} // namespace tools
