// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/hypothesis_tests.hpp"
#include "diagnose/value_mistakes.hpp"
#include "calibrate/image_fit.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/starting_model.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double SURE = 6.;         // standard deviations; corners err a little together, so that they seem more sure than they are

typedef std::vector<double> Values;

struct FittedRig
{
    const RigData& data;
    const RigOptions& options;
    const Fit& fit;
};

//! One kind of value, of which each layer may have its own: how it is set free, and where it stands then.
struct GivenValue
{
    int flag;
    const char* word;
    const char* option;
    bool isGiven;
    Values (*valuesOf)(const GlassWindow&);
    int (*columnOf)(const ParameterColumns&);

    double sumOf(const GlassWindow& window) const
    {
        const Values values = valuesOf(window);
        return std::accumulate(values.begin(), values.end(), 0.);
    }
};

std::vector<GivenValue> givenValues(const RigOptions& options)
{
    const GlassWindow& window = options.window;
    const bool layers = !window.thickness.empty(), equalMedia = window.innerIndex == window.outerIndex;
    return {
        {GLASS_FREE_THICKNESS, "thickness", "--thickness", layers && options.std.thickness == 0.,
         [](const GlassWindow& w) { return w.thickness; }, [](const ParameterColumns& at) { return at.thickness; }},
        {GLASS_FREE_INDEX, "index", "--index", layers && options.std.index == 0.,
         [](const GlassWindow& w) { return w.index; }, [](const ParameterColumns& at) { return at.index; }},
        {GLASS_FREE_DISTANCE, "distance", "--distance", !equalMedia && options.std.distance == 0.,
         [](const GlassWindow& w) { return Values{w.distance}; }, [](const ParameterColumns& at) { return at.distance; }},
        {GLASS_FREE_OUTER_INDEX, "index of the scene's medium", "--outer-index", !equalMedia && options.std.outerIndex == 0.,
         [](const GlassWindow& w) { return Values{w.outerIndex}; }, [](const ParameterColumns& at) { return at.outerIndex; }}};
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

std::string sentenceOf(const GivenValue& given, const std::string& where, const std::string& typed, double before, double estimate,
                       double std)
{
    return format("the images contradict %s=%s: set free, the %s%s would be ", given.option, typed.c_str(), given.word, where.c_str())
        + plusMinus(estimate, std) + format(", %.0f standard deviations away", std::abs(estimate - before)/std);
}

std::string sentenceOfLayers(const GivenValue& given, const std::string& where, double before, double estimate, double std)
{
    return format("the images contradict %s: set free, the sum over the layers%s would be ", given.option, where.c_str())
        + plusMinus(estimate, std) + format(" and not %.5g, %.0f standard deviations away", before, std::abs(estimate - before)/std);
}

/** The thicknesses or indices of several layers, which images hardly distinguish: each free by a part of what it is, so that the prior
shares among them what the images say of their sum. */
RigModel withLayersFree(const FittedRig& c, const GivenValue& given)
{
    const double PART = 0.2;
    const Values values = given.valuesOf(c.options.window);
    RigOptions options = c.options;
    (given.flag == GLASS_FREE_THICKNESS ? options.std.thickness : options.std.index) = PART**std::min_element(values.begin(), values.end());
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

//! A given value that is set free.
std::vector<Contradiction> contradictedBy(const FittedRig& c, const GivenValue& given)
{
    const int count = (int)given.valuesOf(c.options.window).size();
    const Fit fit = count > 1 ? fitImages(c.data, withLayersFree(c, given), c.fit.views, c.options.flags)
                              : fitImages(c.data, c.fit.rig, c.fit.views, c.options.flags | given.flag);
    const int windows = countWindows(c.fit.rig);
    std::vector<Contradiction> contradictions;
    for (int k = 0; k < c.data.cameraCount; k++)
    {
        if (!c.fit.rig.ownsWindow(k))
            continue;
        const double before = given.sumOf(c.fit.rig.cameras[k]->window()), estimate = given.sumOf(fit.rig.cameras[k]->window());
        const int first = given.columnOf(columnsOf(fit.rig, k));
        const double std = std::sqrt(sum(fit.covariance(Rect(first, first, count, count)))[0]);
        const std::string where = windows == 1 ? std::string() : format(" of camera %d's window", k + 1);
        if (std::abs(estimate - before) > SURE*std)
            contradictions.push_back({count > 1 ? sentenceOfLayers(given, where, before, estimate, std)
                                      : sentenceOf(given, where, typed(c.options, given, before), before, estimate, std), fit.sigma});
    }
    return contradictions;
}

//! A window's parameters in the order of their columns.
Values parametersOf(const GlassWindow& window)
{
    Values all(window.normal.val, window.normal.val + 3);
    all.push_back(window.distance);
    all.insert(all.end(), window.thickness.begin(), window.thickness.end());
    all.insert(all.end(), window.index.begin(), window.index.end());
    all.insert(all.end(), {window.innerIndex, window.outerIndex});
    for (const Vec2d& wedge : window.wedge)
        all.insert(all.end(), {wedge[0], wedge[1]});
    return all;
}

//! The option that says how well a parameter is known, and the factor from radians to its unit.
std::pair<const char*, double> deviationOption(const ParameterColumns& at, int column)
{
    if (column >= at.wedge)
        return {"--wedge-std", 60.*180./CV_PI};
    return {column == at.outerIndex ? "--outer-index-std" : column >= at.index ? "--index-std" : column >= at.thickness
            ? "--thickness-std" : "--distance-std", 1.};
}

/** What is known to a standard deviation p, and estimated within it with the deviation s: the estimate is off the given value by a
random number of variance p^2 - s^2 if the latter is right. */
std::vector<Contradiction> contradictedPriors(const FittedRig& c)
{
    const double TOLD = 3.;             // standard deviations
    const double TELLING = 1e-3;        // part of p^2: the images tell less
    std::vector<Contradiction> contradictions;
    for (int k = 0; k < (int)c.fit.rig.known.size(); k++)
    {
        const KnownCamera& known = c.fit.rig.known[k];
        const ParameterColumns own = columnsOf(*c.fit.rig.cameras[k]);
        if (known.covariance.rows <= own.lensCount || !c.fit.rig.ownsWindow(k))
            continue;
        const int first = columnsOf(c.fit.rig, k).lens;
        const Values given = parametersOf(known.window), found = parametersOf(c.fit.rig.cameras[k]->window());
        for (int i = own.distance; i < own.end; i++)
        {
            const double prior = known.covariance.at<double>(i, i), left = c.fit.covariance.at<double>(first + i, first + i);
            if (!(prior > 0.) || !(prior - left > TELLING*prior))
                continue;
            const double before = given[i - own.normal], estimate = found[i - own.normal];
            const double deviations = std::abs(estimate - before)/std::sqrt(prior - left);
            const auto option = deviationOption(own, i);
            if (deviations > TOLD)
                contradictions.push_back({format("the images contradict %s=%.3g: %s%s would be ", option.first,
                                                 option.second*std::sqrt(prior), own.names[i].c_str(),
                                                 c.data.cameraCount == 1 ? "" : format(" of camera %d", k + 1).c_str())
                                          + plusMinus(option.second*estimate, option.second*std::sqrt(left))
                                          + format(" and not %.5g, %.1f standard deviations away", option.second*before, deviations),
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
        if (given.isGiven && !(c.options.flags & given.flag))
            add([&] { return contradictedBy(c, given); });
    add([&] { return contradictedPriors(c); });
    if (hasExactPoses(c))
        add([&] { return contradictedPoses(c); });
    keepTheBest(contradictions);
    return contradictions;
}

} // namespace tools
