// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/causes.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"
#include "diagnose/value_mistakes.hpp"
#include "measure/rig_vector.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double DEGREES = 180./CV_PI;

double sumOf(const Relaxed& found, const std::vector<int>& numbers)
{
    const VectorXd values = toVector(found.glass);
    return std::accumulate(numbers.begin(), numbers.end(), 0., [&](double sum, int i) { return sum + values[i]; });
}

//! One kind of given value, of which each layer may have its own.
struct GivenValue
{
    int flag;
    const char* word;
    const char* option;
    bool isGiven;
    std::vector<double> values, known;              //!< as many as there are layers, or one; their standard deviations
    int (*firstOf)(const ParameterColumns&);

    double sum() const { return std::accumulate(values.begin(), values.end(), 0.); }
    double std() const { return std::sqrt(std::inner_product(known.begin(), known.end(), known.begin(), 0.)); }
};

std::vector<GivenValue> givenValues(const RigOptions& options)
{
    const GlassWindow& window = options.window;
    const bool layers = !window.thickness.empty(), equalMedia = !hasDifferentMedia(window), round = isRound(window);
    std::vector<double> indices;
    for (size_t i = 0; i < window.index.size(); i++)
        indices.push_back(options.std.indexOf(i));
    std::vector<GivenValue> values = {
        {GLASS_FREE_THICKNESS, "thickness", "--thickness", layers, window.thickness,
         std::vector<double>(window.thickness.size(), options.std.thickness), [](const ParameterColumns& at) { return at.thickness; }},
        {GLASS_FREE_INDEX, "index", "--index", layers, window.index, indices, [](const ParameterColumns& at) { return at.index; }},
        {GLASS_FREE_DISTANCE, "distance", "--distance", !equalMedia && !round && !options.areMarkersGiven(), {window.distance},
         {options.std.distance}, [](const ParameterColumns& at) { return at.distance; }},
        {GLASS_FREE_RADIUS, "radius", "--radius", round, {window.radius}, {options.std.radius},
         [](const ParameterColumns& at) { return at.radius; }},
        {GLASS_FREE_OUTER_INDEX, "index of the scene's medium", "--outer-index", !equalMedia, {window.outerIndex},
         {options.std.outerIndex}, [](const ParameterColumns& at) { return at.outerIndex; }}};
    values.erase(std::remove_if(values.begin(), values.end(), [&](const GivenValue& value) {
        return !value.isGiven || ((options.flags & value.flag) && !(value.std() > 0.)); }), values.end());
    return values;
}

//! As it was given; the value may have come by the name of a material.
std::string typed(const RigOptions& options, const GivenValue& given)
{
    if (given.flag == GLASS_FREE_INDEX && options.layers.size() == 1 && options.layers[0].isNamed())
        return typedIndex(options.layers[0], 5);
    if (given.flag == GLASS_FREE_OUTER_INDEX && options.outer.isNamed())
        return typedIndex(options.outer, 5);
    return format("%.5g", given.sum());
}

//! A drawing may say the outer one.
std::string outerRadiusHint(double given, double found, double glass)
{
    const double NEARLY = 0.3;
    return std::abs(given - glass - found) < NEARLY*glass ? " (is that given of the outer face? --radius is of the inner one)" : "";
}

/** Images of a pane between equal media show its thickness in squares of the board: another square explains as much. Near what is given
that is a cause of its own. */
std::string squareHint(double square, double ratio)
{
    const double NEAR = 0.2;
    return !(square > 0.) || std::abs(ratio - 1.) < NEAR ? ""
        : format(", or --square would be %.3g in place of %.4g, as only their ratio shows", square/ratio, square);
}

/** Of some windows together. Of several layers, which images hardly distinguish, each takes its part of what their sum changes by. */
Cause valueCause(const FittedRig& rig, const GivenValue& given, const std::vector<int>& owners)
{
    Shift shift;
    const int count = (int)given.values.size();
    std::vector<int> numbers;
    for (int c : owners)
        for (int i = 0; i < count; i++)
        {
            const int number = given.firstOf(columnsOf(rig.fit.rig, c)) + i;
            shift.numbers.push_back({number, given.values[i]/given.sum()});
            if (c == owners[0])
                numbers.push_back(number);
        }
    const std::string where = owners.size() == 1 ? ofWindow(rig, owners[0]) : std::string(" of all windows");
    const std::string value = typed(rig.options, given);
    const double glass = glassOf(rig.options.window);
    const GlassWindow& window = rig.options.window;
    const bool isRatio = given.flag == GLASS_FREE_THICKNESS && owners == rig.windowOwners() && !hasDifferentMedia(window)
                         && !(rig.options.flags & GLASS_USE_POSES);
    const double square = isRatio ? squareOf(rig.data) : 0.;
    return {format("%s %d", given.option, owners.size() == 1 ? owners[0] : -1), {shift},
            [=](const Relaxed& found, double deviations) {
        const std::string estimate = plusMinus(sumOf(found, numbers), stdOfSum(found, numbers));
        if (count > 1)
            return format("the images contradict %s: set free, the sum over the layers%s would be ", given.option, where.c_str())
                + estimate + format(" and not %.5g", given.sum()) + howSure(deviations);
        return format("the images contradict %s=%s%s: set free, the %s%s would be ", given.option, value.c_str(),
                      given.std() > 0. ? format(" +- %.2g", given.std()).c_str() : "", given.word, where.c_str())
            + estimate + unitHint(sumOf(found, numbers)/given.sum())
            + squareHint(square, sumOf(found, numbers)/given.sum())
            + (given.flag == GLASS_FREE_RADIUS ? outerRadiusHint(given.sum(), sumOf(found, numbers), glass) : std::string())
            + howSure(deviations); }};
}

} // namespace

std::string ofWindow(const FittedRig& rig, int camera)
{
    return countWindows(rig.fit.rig) == 1 ? "" : format(" of camera %d's window", camera + 1);
}

std::string howSure(double deviations)
{
    return format(", a better fit by %.*f sigma", deviations < 10. ? 1 : 0, deviations);
}

double stdOfSum(const Relaxed& found, const std::vector<int>& numbers)
{
    double variance = 0.;
    for (int i : numbers)
        for (int j : numbers)
            variance += found.covariance(i, j);
    return std::sqrt(std::max(0., variance));
}

std::string unitHint(double ratio) { return isRatioOfUnits(ratio) ? " (a wrong unit?)" : ""; }

double squareOf(const RigData& data)
{
    for (const View& view : data.views)
        if (!view.neighbours.empty())
            return norm(view.objectPoints[view.neighbours[0].second] - view.objectPoints[view.neighbours[0].first]);
    return 0.;
}

void addValues(const FittedRig& rig, std::vector<Cause>& causes)
{
    const std::vector<int> owners = rig.windowOwners();
    for (const GivenValue& given : givenValues(rig.options))
    {
        causes.push_back(valueCause(rig, given, owners));
        for (int c : owners)
            if (owners.size() > 1 && given.flag != GLASS_FREE_OUTER_INDEX)      // there is one medium
                causes.push_back(valueCause(rig, given, {c}));
    }
}

void addKnownPlaces(const FittedRig& rig, std::vector<Cause>& causes)
{
    for (int c : rig.options.places.empty() ? std::vector<int>() : rig.windowOwners())
    {
        const GivenPlace given = rig.options.placeOf(c);
        const ParameterColumns at = columnsOf(rig.fit.rig, c);
        std::vector<Shift> freed;
        const Matx32d turns = tangents(given.normal);
        for (int k = 0; k < 2; k++)
            freed.push_back({{{at.normal, turns(0, k)}, {at.normal + 1, turns(1, k)}, {at.normal + 2, turns(2, k)}}});
        const bool freesDistance = given.tellsDistance() && hasDifferentMedia(rig.options.window);
        if (freesDistance)
            freed.push_back({{{at.distance, 1.}}});
        const std::string contradicted = "the images contradict " + rig.options.placeOption + ofWindow(rig, c) + ": set free, ";
        causes.push_back({format("known place %d", c), freed, [=](const Relaxed& found, double deviations) {
            const GlassWindow window = found.glass.cameras[c]->window();
            const double turned = DEGREES*std::acos(std::min(1., window.normal.dot(given.normal)));
            return contradicted + format("the window would be turned by %.3g degrees", turned)
                + (freesDistance ? " and " + plusMinus(window.distance, stdOfSum(found, {at.distance}))
                       + format(" away and not %.5g", given.distance) : std::string()) + howSure(deviations); }});
    }
}

void addWedges(const FittedRig& rig, std::vector<Cause>& causes)
{
    for (int c : rig.windowOwners())
    {
        const ParameterColumns at = columnsOf(rig.fit.rig, c);
        if (at.wedge == at.curvature || ((rig.options.flags & GLASS_FREE_WEDGE) && !(rig.options.std.wedge > 0.)))
            continue;
        const std::string where = ofWindow(rig, c);
        const double known = rig.options.std.wedge;
        const std::vector<Shift> freed = {{{{at.wedge, 1.}}}, {{{at.wedge + 1, 1.}}}};
        causes.push_back({format("wedge %d", c), freed, [=](const Relaxed& found, double deviations) {
            const VectorXd values = toVector(found.glass);
            const auto angle = [&](int i) { return plusMinus(values[i]/ARC_MINUTE, stdOfSum(found, {i})/ARC_MINUTE); };
            return format("the images contradict --wedge-std=%.3g: set free, the wedge%s would be (", known/ARC_MINUTE, where.c_str())
                + angle(at.wedge) + ", " + angle(at.wedge + 1) + ") arc minutes" + howSure(deviations); }});
    }
}

void addBows(const FittedRig& rig, std::vector<Cause>& causes)
{
    for (int c : rig.windowOwners())
    {
        const ParameterColumns at = columnsOf(rig.fit.rig, c);
        if (!at.has(at.curvature) || !(rig.options.std.curvature > 0.))
            continue;
        const std::string where = ofWindow(rig, c);
        const double known = rig.options.std.bow, sag = known/rig.options.std.curvature;
        causes.push_back({format("bow %d", c), {{{{at.curvature, 1.}}}}, [=](const Relaxed& found, double deviations) {
            return format("the images contradict --bow-std=%.2g: set free, the bow%s would be ", known, where.c_str())
                + plusMinus(sag*toVector(found.glass)[at.curvature], sag*stdOfSum(found, {at.curvature})) + " mm per metre"
                + howSure(deviations); }});
    }
}

} // namespace tools
