// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/hypothesis_tests.hpp"
#include "diagnose/value_mistakes.hpp"
#include "calibrate/image_fit.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/starting_model.hpp"
#include "calibrate/units.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

// Standard deviations: told, and decided. Corners err a little together, so that they seem more sure than they are.
const double TOLD = 3., SURE = 6.;

typedef std::vector<double> Values;

struct FittedRig
{
    const RigData& data;
    const RigOptions& options;
    const Fit& fit;
};

//! One kind of value, of which each layer may have its own: how it is set free, how well it was known, and where it stands then.
struct GivenValue
{
    int flag;
    const char* word;
    const char* option;
    bool isGiven;
    Values (*valuesOf)(const GlassWindow&);
    int (*columnOf)(const ParameterColumns&);
    Values known;                                   //!< standard deviations, as many as there are values
    void (*setKnown)(GivenStd&, size_t, double);    //!< all of them to one

    double sumOf(const GlassWindow& window) const
    {
        const Values values = valuesOf(window);
        return std::accumulate(values.begin(), values.end(), 0.);
    }
    double varianceOfSum() const { return std::inner_product(known.begin(), known.end(), known.begin(), 0.); }
};

std::vector<GivenValue> givenValues(const RigOptions& options)
{
    const GlassWindow& window = options.window;
    const bool layers = !window.thickness.empty(), equalMedia = window.innerIndex == window.outerIndex;
    Values indices;
    for (size_t i = 0; i < window.index.size(); i++)
        indices.push_back(options.std.indexOf(i));
    std::vector<GivenValue> values = {
        {GLASS_FREE_THICKNESS, "thickness", "--thickness", layers,
         [](const GlassWindow& w) { return w.thickness; }, [](const ParameterColumns& at) { return at.thickness; },
         Values(window.thickness.size(), options.std.thickness), [](GivenStd& std, size_t, double value) { std.thickness = value; }},
        {GLASS_FREE_INDEX, "index", "--index", layers,
         [](const GlassWindow& w) { return w.index; }, [](const ParameterColumns& at) { return at.index; },
         indices, [](GivenStd& std, size_t count, double value) { std.index.assign(count, value); }},
        {GLASS_FREE_DISTANCE, "distance", "--distance", !equalMedia,
         [](const GlassWindow& w) { return Values{w.distance}; }, [](const ParameterColumns& at) { return at.distance; },
         {options.std.distance}, [](GivenStd& std, size_t, double value) { std.distance = value; }},
        {GLASS_FREE_OUTER_INDEX, "index of the scene's medium", "--outer-index", !equalMedia,
         [](const GlassWindow& w) { return Values{w.outerIndex}; }, [](const ParameterColumns& at) { return at.outerIndex; },
         {options.std.outerIndex}, [](GivenStd& std, size_t, double value) { std.outerIndex = value; }}};
    for (GivenValue& value : values)
        value.isGiven = value.isGiven && (!(options.flags & value.flag) || value.varianceOfSum() > 0.);
    return values;
}

//! As it was given; the value may have come by the name of a material.
std::string typed(const RigOptions& options, const GivenValue& given, double value)
{
    if (given.flag == GLASS_FREE_INDEX && options.layers.size() == 1 && options.layers[0].isNamed())
        return typedIndex(options.layers[0], 5);
    if (given.flag == GLASS_FREE_OUTER_INDEX && options.outer.isNamed())
        return typedIndex(options.outer, 5);
    return format("%.5g", value);
}

std::string howFar(double deviations)
{
    return format(", %.*f standard deviations away", deviations < 10. ? 1 : 0, deviations);
}

std::string sentenceOf(const GivenValue& given, const std::string& where, const std::string& typed, double estimate, double std,
                       double deviations)
{
    const double known = std::sqrt(given.varianceOfSum());
    return format("the images contradict %s=%s%s: set free, the %s%s would be ", given.option, typed.c_str(),
                  known > 0. ? format(" +- %.2g", known).c_str() : "", given.word, where.c_str())
        + plusMinus(estimate, std) + howFar(deviations);
}

std::string sentenceOfLayers(const GivenValue& given, const std::string& where, double before, double estimate, double std,
                             double deviations)
{
    return format("the images contradict %s: set free, the sum over the layers%s would be ", given.option, where.c_str())
        + plusMinus(estimate, std) + format(" and not %.5g", before) + howFar(deviations);
}

/** A rig in which nothing is known of a value any more. The thicknesses or indices of several layers, which images hardly distinguish,
are free by a part of what they are, so that the prior shares among them what the images say of their sum. */
RigModel withoutPrior(const FittedRig& c, const GivenValue& given)
{
    const double PART = 0.2;
    const Values values = given.valuesOf(c.options.window);
    RigOptions options = c.options;
    given.setKnown(options.std, values.size(), values.size() > 1 ? PART**std::min_element(values.begin(), values.end()) : 0.);
    RigModel rig = c.fit.rig.clone();
    rig.known.resize(rig.cameras.size());
    for (size_t k = 0; k < rig.cameras.size(); k++)
    {
        const Mat lens = rig.known[k].lens;
        rig.known[k] = knownOf(*rig.cameras[k], options, (int)k);
        if (!lens.empty())
            rig.known[k].lens = lens;
    }
    return rig;
}

/** A given value that is set free. How far a fit within its prior has moved it does not tell: where the value is far off, the noise
seems large, and the prior is as strong as that. */
std::vector<Contradiction> contradictedBy(const FittedRig& c, const GivenValue& given)
{
    const int count = (int)given.known.size(), windows = countWindows(c.fit.rig);
    const Fit fit = fitImages(c.data, withoutPrior(c, given), c.fit.views, count > 1 ? c.options.flags : c.options.flags | given.flag);
    std::vector<Contradiction> contradictions;
    for (int k = 0; k < c.data.cameraCount; k++)
    {
        if (!c.fit.rig.ownsWindow(k))
            continue;
        const double before = given.sumOf(c.options.window), estimate = given.sumOf(fit.rig.cameras[k]->window());
        const int first = given.columnOf(columnsOf(fit.rig, k));
        const double variance = sum(fit.covariance(Rect(first, first, count, count)))[0], std = std::sqrt(variance);
        const double deviations = std::abs(estimate - before)/std::sqrt(variance + given.varianceOfSum());
        const std::string where = windows == 1 ? std::string() : format(" of camera %d's window", k + 1);
        if (deviations > TOLD)
            contradictions.push_back({count > 1 ? sentenceOfLayers(given, where, before, estimate, std, deviations)
                                      : sentenceOf(given, where, typed(c.options, given, before), estimate, std, deviations),
                                      fit.sigma, deviations > SURE});
    }
    return contradictions;
}

//! Wedges, which are about 0.
std::vector<Contradiction> contradictedWedges(const FittedRig& c)
{
    const double prior = std::pow(c.options.std.wedge, 2), minutes = 1./ARC_MINUTE;
    std::vector<Contradiction> contradictions;
    for (int k = 0; k < c.data.cameraCount && prior > 0.; k++)
    {
        const ParameterColumns at = columnsOf(c.fit.rig, k);
        const GlassWindow window = c.fit.rig.cameras[k]->window();
        for (int i = at.wedge; i < at.end && c.fit.rig.ownsWindow(k); i++)
        {
            const double wedge = window.wedge[(i - at.wedge)/2][(i - at.wedge) % 2], left = c.fit.covariance.at<double>(i, i);
            const double deviations = std::abs(wedge)/std::sqrt(std::max(prior - left, 1e-3*prior));
            if (deviations > TOLD)
                contradictions.push_back({format("the images contradict --wedge-std=%.3g: %s%s would be ", minutes*std::sqrt(prior),
                                                 at.names[i - at.lens].c_str(),
                                                 c.data.cameraCount == 1 ? "" : format(" of camera %d", k + 1).c_str())
                                          + plusMinus(minutes*wedge, minutes*std::sqrt(left))
                                          + format(" arc minutes, %.1f standard deviations away", deviations),
                                          c.fit.sigma, deviations > SURE});
        }
    }
    return contradictions;
}

//! Poses that are taken as exact.
std::vector<Contradiction> contradictedPoses(const FittedRig& c)
{
    const Fit fit = fitImages(c.data, c.fit.rig, c.fit.views, c.options.flags & ~GLASS_USE_POSES);
    const double ratio = c.fit.sigma/fit.sigma;
    if (!(ratio*ratio > 1 + SURE*std::sqrt(2/fit.dof)))
        return {};
    return {{format("the images contradict --poses, which are taken as exact: without them the corners agree within %.2g px, with them "
                    "within %.2g px; give their uncertainty in the columns sigma_deg and sigma, or measure them again", fit.sigma,
                    c.fit.sigma), fit.sigma}};
}

bool hasExactPoses(const FittedRig& c)
{
    return (c.options.flags & GLASS_USE_POSES) && std::all_of(c.fit.views.begin(), c.fit.views.end(), [&](int m) {
        return c.data.views[m].pose && c.data.views[m].pose->covariance.empty(); });
}

//! What makes the images agree best comes first; what does so much worse than that is a consequence of it.
void keepTheBest(std::vector<Contradiction>& contradictions)
{
    const double AS_GOOD = 1.2;
    const auto isBetter = [](const Contradiction& one, const Contradiction& other) { return one.sigma < other.sigma; };
    std::stable_sort(contradictions.begin(), contradictions.end(), isBetter);
    const auto isMuchWorse = [&](const Contradiction& one) { return one.sigma > AS_GOOD*contradictions[0].sigma; };
    contradictions.erase(std::find_if(contradictions.begin(), contradictions.end(), isMuchWorse), contradictions.end());
}

} // namespace

std::vector<Contradiction> testGivenValues(const RigData& data, const RigOptions& options, const Fit& fit)
{
    const FittedRig c{data, options, fit};
    std::vector<Contradiction> contradictions;
    const auto add = [&](const auto& of) {
        try
        {
            const std::vector<Contradiction> more = of();
            contradictions.insert(contradictions.end(), more.begin(), more.end());
        }
        catch (const cv::Exception&) {}     // the images do not determine it, so they do not contradict it either
    };
    for (const GivenValue& given : givenValues(c.options))
        if (given.isGiven)
            add([&] { return contradictedBy(c, given); });
    add([&] { return contradictedWedges(c); });
    if (hasExactPoses(c))
        add([&] { return contradictedPoses(c); });
    keepTheBest(contradictions);
    return contradictions;
}

} // namespace tools
