// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "bundle/bundle_findings.hpp"
#include "bundle/bundle_start.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "diagnose/plain_fit.hpp"
#include "measure/rig_vector.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double DEGREES = 180./CV_PI;

//! Standard deviation along the worst direction.
double worstStd(const Mat& covariance, int at)
{
    Mat values;
    eigen(covariance(Rect(at, at, 3, 3)), values);
    return std::sqrt(std::max(0., values.at<double>(0)));
}

CameraCorrection correctionOf(const BundleStart& start, const Fit& fit, int c)
{
    CameraCorrection correction;
    const GlassWindow before = start.rig.cameras[c]->window(), now = fit.rig.cameras[c]->window();
    const double std = placeStd(fit.covariance, fit.rig, c);
    correction.name = placeName(now);
    correction.place = {std > 0., placeChange(before, now), std};
    correction.worstDeg = isRound(now) ? std/now.radius*DEGREES : std;
    if (now.shape == WINDOW_TUBE)
    {
        const double axisStd = worstStd(fit.covariance, columnsOf(fit.rig, c).axis);
        correction.axis = {axisStd > 0., std::asin(std::min(1., norm(before.axis.cross(now.axis))))*DEGREES, axisStd*DEGREES};
    }
    if (c == 0)
        return correction;
    const RigidTransform& was = start.rig.extrinsics[c];
    const RigidTransform& is = fit.rig.extrinsics[c];
    const int at = extrinsicsColumn(fit.rig, c);
    const double rStd = worstStd(fit.covariance, at), tStd = worstStd(fit.covariance, at + 3);
    correction.R = {rStd > 0., norm(rotationVector(is.R*was.R.t()))*DEGREES, rStd*DEGREES};
    correction.T = {tStd > 0., norm(is.t - was.t), tStd};
    return correction;
}

std::string scaleOf(const BundleStart& start, const GivenLengths& lengths, const Fit& fit)
{
    if (!lengths.list.empty())
    {
        const GivenLength& first = lengths.list.front();
        const std::string of = lengths.objects == 1 ? format(" of one object, %g +- %g", first.length, first.std)
                                                    : format(" of %d objects", lengths.objects);
        return format("%zu length%s", lengths.list.size(), lengths.list.size() == 1 ? "" : "s") + of;
    }
    if (fit.rig.cameras.size() == 1)
        return "";                      // something else tells it
    const int at = extrinsicsColumn(fit.rig, 1) + 3;
    const Vec3d T = start.rig.extrinsics[1].t;
    if (start.covariance.empty() || !(start.covariance.at<double>(at, at) > 0))
        return "T of the start, taken as exact (no --lengths)";
    const Mat direction = Mat(T/norm(T)), C = start.covariance(Rect(at, at, 3, 3));
    return format("T of the start, +- %.2g %% (no --lengths)", 100.*std::sqrt(direction.dot(C*direction))/norm(T));
}

const double FAR_OFF = 2./DEGREES;      // of a direction: it says next to nothing

//! The window that a column is of.
GlassWindow windowOfColumn(const RigModel& rig, int column, ParameterColumns& at)
{
    int c = 0;
    while (column >= columnsOf(rig, c).end)
        c++;
    at = columnsOf(rig, c);
    return rig.cameras[c]->window();
}

//! Standard deviations beyond which a value says next to nothing.
bool isWeak(const EstimatedParameter& p, const RigModel& rig)
{
    ParameterColumns at;
    const GlassWindow window = windowOfColumn(rig, p.column, at);
    const auto isOf = [&](int first, int count) { return at.has(first) && p.column >= first && p.column < first + count; };
    if (p.isNormal)
        return p.std > FAR_OFF;
    if (isOf(at.center, 3))             // as seen from a radius away
        return p.std > FAR_OFF*window.radius;
    if (isOf(at.curvature, 1))          // by so much it turns the pane from the middle of an image to where it is as far as it is away
        return p.std*window.distance > FAR_OFF;
    if (isOf(at.index, at.layers) || isOf(at.outerIndex, 1))
        return p.std > 0.05;
    return isOf(at.wedge, at.curvature - at.wedge) ? p.std > 3*ARC_MINUTE : p.std > 0.25*p.value;
}

const double FAR_DEG = 15., FAR_SHARE = 1./3.;      // of T

/* A start is good to some degrees and per cent. What fits far from it may be another minimum, of matches that are not what they are given
for. What is known of R and T has its contradictions.
@param many standard deviations that a step may be long by itself */
void findFarSteps(const BundleStart& start, double many, BundleFindings& findings)
{
    double worst = 1.;
    std::string sentence;
    for (size_t c = 1; c < findings.corrections.size() && (start.flags & GLASS_FREE_EXTRINSICS); c++)
    {
        const Correction &R = findings.corrections[c].R, &T = findings.corrections[c].T;
        const double away = norm(start.rig.extrinsics[c].t);
        const double far = std::max((R.by - many*R.std)/FAR_DEG, (T.by - many*T.std)/(FAR_SHARE*away));
        if (far <= worst)
            continue;
        worst = far;
        sentence = format("R of camera %zu is %.3g degrees from the start and T %.3g, where T is %.3g long: is the start good to some "
                          "degrees and per cent, in the unit of the lengths, and are the cameras in its order? Else the matches fit at a "
                          "wrong place", c + 1, R.by, T.by, away);
    }
    if (!sentence.empty())
        findings.contradictions.push_back(sentence);
}

double shareLeftOut(const BundleAdjustment& adjustment)
{
    return adjustment.seenPixels > 0 ? 1. - (double)adjustment.usedPixels/adjustment.seenPixels : 0.;
}

/** px a coordinate, of all matches, what is left out counted where the robust fit cuts: what leaves out enough makes the rest of any wrong
matches fit. */
double noiseOfAll(const BundleAdjustment& adjustment)
{
    const double CUT2 = -2.*std::log(1e-4);     // squared length of an error that is left out, in variances of a coordinate; 2 is usual
    const double left = shareLeftOut(adjustment);
    return adjustment.fit.sigma*std::sqrt(1. - left + left*CUT2/2.);
}

//! Of matches that are wrong, or do not go with the start.
void findNoise(const BundleAdjustment& adjustment, double knownSigma, BundleFindings& findings)
{
    const double NOISIER = 5., NO_DETECTOR = 2.;     // px
    const double MOST_LEFT_OUT = 1./3.;
    if (knownSigma > 0. && adjustment.fit.sigma > NOISIER*knownSigma)
        findings.contradictions.push_back(format("the matches are off by %.3g px, where the noise is known to be %.3g px: matches are "
                                                 "wrong, or something is not as the start says", adjustment.fit.sigma, knownSigma));
    else if (!(knownSigma > 0.) && noiseOfAll(adjustment) > NO_DETECTOR)
        findings.contradictions.push_back(format("the matches are off by %.3g px, more than found points are: are the cameras in the "
                                                 "order of the start, the pixels raw and not mirrored, and is what is not free as the "
                                                 "start says? (If they are that noisy, say --pixel-sigma)", noiseOfAll(adjustment)));
    else if (shareLeftOut(adjustment) > MOST_LEFT_OUT)
        findings.contradictions.push_back(format("%.0f %% of the pixels do not fit the others, and so many wrong ones agree with each "
                                                 "other, too: are the cameras in the order of the start, the pixels raw and not mirrored?",
                                                 100.*shareLeftOut(adjustment)));
}

std::vector<CameraCorrection> correctionsOf(const BundleStart& start, const Fit& fit)
{
    std::vector<CameraCorrection> corrections;
    for (int c = 0; c < (int)fit.rig.cameras.size(); c++)
        corrections.push_back(correctionOf(start, fit, c));
    return corrections;
}

/** Whether the rest is as the start says. If not, measures need not be what is wrong. Without them its scale is what windows tell, which
may be next to nothing: only a common factor of lengths asks for it. */
bool isRestSound(const BundleStart& start, const ContradictedMeasures& measures, double knownSigma)
{
    Fit fit = measures.rest.fit;
    const double base = fit.rig.cameras.size() > 1 ? norm(fit.rig.extrinsics[1].t) : 0.;
    for (RigidTransform& place : fit.rig.extrinsics)
        place.t *= base > 0. && !measures.isFactor ? norm(start.rig.extrinsics[1].t)/base : 1.;
    BundleFindings findings;
    findings.corrections = correctionsOf(start, fit);
    findFarSteps(start, 0., findings);                  // not known, it is no sooner right
    findNoise(measures.rest, knownSigma, findings);
    for (size_t c = 0; c < findings.corrections.size() && findings.contradictions.empty(); c++)
    {
        const GlassWindow window = fit.rig.cameras[c]->window();
        const double by = findings.corrections[c].place.by;
        if ((isRound(window) ? by/window.radius*DEGREES : by) > FAR_DEG)
            return false;
    }
    return findings.contradictions.empty();
}

} // namespace

std::string BundleFindings::verdict() const
{
    if (!contradictions.empty())
        return "NOT USABLE";
    if (!limitMet)
        return "LIMIT NOT MET";
    return weak.empty() ? maxRms > 0. ? "PASS" : "USABLE" : "USABLE, WITH WEAK POINTS";
}

BundleFindings findingsOf(const BundleStart& start, const GivenLengths& lengths, const BundleAdjustment& adjustment,
                          const Readjust& adjust, double knownSigma, double maxRms, const MeasuredBundle* measured)
{
    const Fit& fit = adjustment.fit;
    BundleFindings findings;
    findings.corrections = correctionsOf(start, fit);
    findings.scale = scaleOf(start, lengths, fit);
    for (const EstimatedParameter& p : estimatedWindowParameters(fit))
        if (isWeak(p, fit.rig))
            findings.weak.push_back(p.name + " = " + plusMinus(p.value, p.std));
    const double FEW = 60.;
    if (fit.dof < FEW)
        findings.weak.push_back("so few data (every +- may be 1.4 times larger)");
    const ContradictedMeasures measures = measured ? contradictedMeasures(*measured, adjustment) : ContradictedMeasures();
    findings.areMeasuresWrong = !measures.sentence.empty() && isRestSound(start, measures, knownSigma);
    findings.pixelStd = findings.areMeasuresWrong ? measures.rest.fit.sigma : fit.sigma;
    const std::string contradiction = findings.areMeasuresWrong ? measures.sentence : contradictionOf(start, adjustment, adjust);
    if (!contradiction.empty())
        findings.contradictions.push_back(contradiction);
    findFarSteps(start, 2., findings);
    if (!findings.areMeasuresWrong)     // else right pixels do not fit, either
        findNoise(adjustment, knownSigma, findings);
    findings.maxRms = maxRms;
    findings.limitMet = !(maxRms > 0.) || fit.rms <= maxRms;
    return findings;
}

void checkPlaces(const BundleStart& start, const Readjust& adjust, BundleFindings& findings)
{
    const double MANY = 5.;
    if (start.placeOption.empty())
        return;
    BundleStart freed = start;
    forget({"normal", "distance"}, freed.rig, freed.covariance);
    freed.flags &= ~GLASS_FIX_NORMAL;
    for (const Ptr<RefractiveCamera>& camera : start.rig.cameras)
        freed.flags |= hasDifferentMedia(camera->window()) ? (int)GLASS_FREE_DISTANCE : 0;
    Fit free;
    try
    {
        free = adjust(freed).fit;
    }
    catch (const Failure&)              // the matches alone tell nothing of it
    {
        return;
    }
    for (int c = 0; c < (int)free.rig.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(free.rig, c);
        const Rect place(at.normal, at.normal, 4, 4);
        const GlassWindow given = start.rig.cameras[c]->window(), now = free.rig.cameras[c]->window();
        const double apart = deviationsBetween(given, Mat(start.covariance(place)), now, Mat(free.covariance(place)));
        if (free.rig.ownsWindow(c) && apart > MANY)
            findings.contradictions.push_back(format("the matches contradict %s of camera %d's window by %.0f standard deviations: set "
                "free, it would be turned by %.2g degrees and %s away and not %.5g; was all measured in the camera's frame, and on the "
                "face towards it?", start.placeOption.c_str(), c + 1, apart, placeChange(given, now),
                plusMinus(now.distance, std::sqrt(free.covariance.at<double>(at.distance, at.distance))).c_str(), given.distance));
    }
}

std::string explanationOf(const std::vector<std::string>& free, double sigma,
                          const std::function<BundleAdjustment(const std::vector<std::string>&)>& adjust)
{
    const double EXPLAINS = 0.5, AS_GOOD = 1.1;     // of the noise
    const char* const MAY_CHANGE[] = {"normal", "center", "extrinsics", "intrinsics", "distance", "radius", "outer-index", "thickness",
                                      "index", "curvature"};
    std::vector<std::pair<double, std::string>> explains;
    for (const std::string name : MAY_CHANGE)
    {
        std::vector<std::string> more = free;
        more.push_back(name);
        if (std::find(free.begin(), free.end(), name) != free.end())
            continue;
        try
        {
            const double noise = adjust(more).fit.sigma;
            if (noise < EXPLAINS*sigma)
                explains.push_back({noise, name});
        }
        catch (const Failure&)              // not of this rig, or not determined: no explanation
        {
        }
    }
    std::sort(explains.begin(), explains.end());
    std::string text;
    for (const auto& one : explains)
        if (one.first < AS_GOOD*explains.front().first)     // these cannot be told apart
            text += (text.empty() ? "" : " or ") + one.second;
    return text.empty() ? text : format("explained, with %.3g px of noise, if free: ", explains.front().first) + text;
}

} // namespace tools
