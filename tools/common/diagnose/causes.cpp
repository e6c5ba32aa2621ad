// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/causes.hpp"
#include "diagnose/rig_vector.hpp"
#include "diagnose/value_mistakes.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double DEGREES = 180./CV_PI;

struct FittedRig
{
    const RigData& data;
    const RigOptions& options;
    const Fit& fit;

    std::vector<int> windowOwners() const
    {
        std::vector<int> owners;
        for (int c = 0; c < data.cameraCount; c++)
            if (fit.rig.ownsWindow(c))
                owners.push_back(c);
        return owners;
    }
    //! Of all cameras, or of one.
    bool hasBothStates(int camera = -1) const
    {
        bool direct = false, glass = false;
        for (int m : fit.views)
            for (int c = 0; c < data.cameraCount; c++)
                if (camera < 0 || c == camera)
                {
                    direct = direct || data.views[m].hasDirect(c);
                    glass = glass || data.views[m].hasGlass(c);
                }
        return direct && glass;
    }
};

std::string ofCamera(const FittedRig& rig, int camera)
{
    return rig.data.cameraCount == 1 ? "" : format(" of camera %d", camera + 1);
}

std::string ofWindow(const FittedRig& rig, int camera)
{
    return countWindows(rig.fit.rig) == 1 ? "" : format(" of camera %d's window", camera + 1);
}

//! By the ratio of likelihoods, of all that is freed: no distance from the given value in units of the freed one's +-.
std::string howSure(double deviations)
{
    return format(", a better fit by %.*f sigma", deviations < 10. ? 1 : 0, deviations);
}

//! The standard deviation of a sum of numbers of the rig.
double stdOfSum(const Relaxed& found, const std::vector<int>& numbers)
{
    double variance = 0.;
    for (int i : numbers)
        for (int j : numbers)
            variance += found.covariance(i, j);
    return std::sqrt(std::max(0., variance));
}

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
        {GLASS_FREE_DISTANCE, "distance", "--distance", !equalMedia && !round, {window.distance}, {options.std.distance},
         [](const ParameterColumns& at) { return at.distance; }},
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

std::string unitHint(double ratio) { return isRatioOfUnits(ratio) ? " (a wrong unit?)" : ""; }

//! A drawing may say the outer one.
std::string outerRadiusHint(double given, double found, double glass)
{
    const double NEARLY = 0.3;
    return std::abs(given - glass - found) < NEARLY*glass ? " (is that given of the outer face? --radius is of the inner one)" : "";
}

//! The side of a board's square, as it is given; 0: there is no board.
double squareOf(const RigData& data)
{
    for (const View& view : data.views)
        if (!view.neighbours.empty())
            return norm(view.objectPoints[view.neighbours[0].second] - view.objectPoints[view.neighbours[0].first]);
    return 0.;
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

//! All windows together, as one option gives them; and each alone.
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

//! The faces of all layers of one window; images tell the sum, which the first layer stands for.
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

//! The curvature of a window that is taken to be flat within --bow-std.
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

//! About the middle of what the cameras saw, so that a turn moves the boards little.
Vec3d middleOf(const Fit& fit)
{
    Vec3d sum;
    for (const Vec3d& tvec : fit.tvecs)
        sum += tvec;
    return sum*(1./std::max<size_t>(1, fit.tvecs.size()));
}

std::vector<Shift> motionAbout(const Vec3d& middle, int first, bool turns)
{
    std::vector<Shift> shifts;
    for (int k = 0; k < 3; k++)
        shifts.push_back({{{first + 3 + k, 1.}}});
    for (int k = 0; k < 3 && turns; k++)
    {
        Vec3d axis;
        axis[k] = 1.;
        const Vec3d along = -axis.cross(middle);
        shifts.push_back({{{first + k, 1.}, {first + 3, along[0]}, {first + 4, along[1]}, {first + 5, along[2]}}});
    }
    return shifts;
}

//! All boards, or the mount of the cameras, between direct images and those through the windows.
void addMotion(const FittedRig& rig, std::vector<Cause>& causes)
{
    if (rig.data.countPairs() == 0)
        return;
    const Vec3d middle = middleOf(rig.fit);
    const int first = columnCount(rig.fit.rig) + 1;
    const double known = rig.options.std.placement;
    for (bool turns : {false, true})
        causes.push_back({"motion", motionAbout(middle, first, turns), [=](const Relaxed& found, double deviations) {
            const RigidTransform& motion = found.glass.targetMotion;
            const Vec3d moved = motion*middle - middle, turned = DEGREES*rotationVector(motion.R);
            std::string text;
            for (int k = 0; k < 3; k++)
                text += (k ? ", " : "") + plusMinus(moved[k], std::sqrt(std::max(0., found.covariance(first + 3 + k, first + 3 + k))));
            if (turns)          // its columns are those of the camera's centre: the +- about the middle is that of the shifts
            {
                text.clear();
                const Eigen::Index of = found.covariance.rows() - 6;
                for (int k = 0; k < 3; k++)
                    text += (k ? ", " : "") + plusMinus(moved[k], std::sqrt(std::max(0., found.covariance(of + k, of + k))));
            }
            return format("the images contradict --placement-std=%.2g: between direct and glass images all boards (or the cameras' mount) "
                          "moved by (", known) + text + ")" + (turns ? format(", turned by %.3f degrees", norm(turned)) : std::string())
                + howSure(deviations); }});
}

//! fx and fy together.
Shift focusOf(const FittedRig& rig, int camera, bool glassOnly)
{
    const int lens = columnsOf(rig.fit.rig, camera).lens;
    const VectorXd values = toVector(rig.fit.rig);
    return {{{lens, values[lens]}, {lens + 1, values[lens + 1]}}, glassOnly};
}

void addLenses(const FittedRig& rig, std::vector<Cause>& causes)
{
    const double TELLING = 3.;          // standard deviations of a parameter alone
    for (int c = 0; c < rig.data.cameraCount; c++)
    {
        const std::string where = ofCamera(rig, c), suffix = cameraSuffix(c);
        const ParameterColumns at = columnsOf(rig.fit.rig, c);
        if (at.lensCount < 4)
            continue;
        const auto factor = [](const Relaxed& found) {
            const Eigen::Index last = found.covariance.rows() - 1;
            return plusMinus(1. + found.shifts[0], std::sqrt(std::max(0., found.covariance(last, last)))); };
        if (rig.hasBothStates(c))
            causes.push_back({format("focus %d", c), {focusOf(rig, c, true)}, [=](const Relaxed& found, double deviations) {
                return "the focus or zoom" + where + " changed: through the window the focal length is " + factor(found)
                    + " times that of the direct images" + howSure(deviations); }});
        if (!rig.options.known[c] || rig.options.knownCovariance[c].empty() == ((rig.options.flags & GLASS_FREE_INTRINSICS) != 0))
            continue;           // it is free
        causes.push_back({format("lens focus %d", c), {focusOf(rig, c, false)}, [=](const Relaxed& found, double deviations) {
            return "the images contradict --camera" + suffix + ": set free, the focal length would be " + factor(found) + " times that of "
                "the file" + howSure(deviations); }});
        std::vector<Shift> lens;
        for (int i = 0; i < at.lensCount; i++)
            lens.push_back({{{at.lens + i, 1.}}});
        const VectorXd given = toVector(rig.fit.rig);
        const bool isExact = rig.options.knownCovariance[c].empty();
        const std::vector<String> names = rig.fit.rig.cameras[c]->parameterNames();
        causes.push_back({format("lens focus %d", c), lens, [=](const Relaxed& found, double deviations) {
            const VectorXd values = toVector(found.glass);
            const auto moved = [&](int i) {
                return std::abs(values[at.lens + i] - given[at.lens + i])/stdOfSum(found, {at.lens + i}); };
            int most = 0;               // what the file errs in: the others change as they are tied to it
            for (int i = 1; i < at.lensCount; i++)
                most = moved(i) > moved(most) ? i : most;
            const std::string contradicted = "the images contradict --camera" + suffix + ": set free, the lens would ";
            if (!(moved(most) > TELLING))
                return contradicted + "differ as a whole, though in no parameter alone" + howSure(deviations);
            return contradicted + "have " + names[most] + " = "
                + plusMinus(values[at.lens + most], stdOfSum(found, {at.lens + most}))
                + (isExact ? format(" in place of %.5g", given[at.lens + most]) : std::string()) + howSure(deviations); }});
    }
}

//! A camera in its place of the rig, in the images through the windows.
std::vector<Shift> placeOfCamera(const RigModel& rig, int camera)
{
    std::vector<Shift> shifts;
    if (camera > 0)
    {
        for (int k = 0; k < 6; k++)
            shifts.push_back({{{extrinsicsColumn(rig, camera) + k, 1.}}, true});
        return shifts;
    }
    // Camera 1 is the frame: the boards move, and the other cameras with them.
    const double STEP = 1e-6;
    const int motion = columnCount(rig) + 1;
    for (int k = 0; k < 6; k++)
    {
        Vec6d back;
        back[k] = -STEP;
        const RigidTransform inverse = transformOf(Vec3d(back[0], back[1], back[2]), Vec3d(back[3], back[4], back[5]));
        Shift shift{{{motion + k, 1.}}, true};
        for (int c = 1; c < (int)rig.cameras.size(); c++)
        {
            const RigidTransform moved = rig.extrinsics[c]*inverse;
            const Vec3d turned = (rotationVector(moved.R) - rotationVector(rig.extrinsics[c].R))*(1./STEP);
            const Vec3d shifted = (moved.T - rig.extrinsics[c].T)*(1./STEP);
            for (int i = 0; i < 3; i++)
            {
                shift.numbers.push_back({extrinsicsColumn(rig, c) + i, turned[i]});
                shift.numbers.push_back({extrinsicsColumn(rig, c) + 3 + i, shifted[i]});
            }
        }
        shifts.push_back(shift);
    }
    return shifts;
}

void addPlaces(const FittedRig& rig, std::vector<Cause>& causes)
{
    for (int c = 0; c < rig.data.cameraCount && rig.data.cameraCount > 1; c++)
        if (rig.hasBothStates(c))
            causes.push_back({format("place %d", c), placeOfCamera(rig.fit.rig, c), [=](const Relaxed& found, double deviations) {
                const int other = c > 0 ? c : 1;
                const RigidTransform &before = found.direct.extrinsics[other], &after = found.glass.extrinsics[other];
                const double turned = DEGREES*norm(rotationVector(after.R*before.R.t()));
                const double moved = norm(after.R.t()*after.T - before.R.t()*before.T);
                return format("camera %d moved in the rig between direct and glass images: it turned by %.3g degrees and moved by %.2g",
                              c + 1, turned, moved) + howSure(deviations); }});
}

void addTarget(const FittedRig& rig, std::vector<Cause>& causes)
{
    const int scale = columnCount(rig.fit.rig);
    const double square = squareOf(rig.data);
    causes.push_back({"square", {{{{scale, 1.}}}}, [=](const Relaxed& found, double deviations) {
        const double factor = found.glass.targetScale, std = stdOfSum(found, {scale});
        return (square > 0. ? format("the images contradict --square=%.5g: set free, it would be ", square)
                + plusMinus(square*factor, square*std) : "the images contradict the size of the target: set free, it would be "
                + plusMinus(factor, std) + " times as large") + unitHint(factor) + howSure(deviations); }});
}

void addPoses(const FittedRig& rig, std::vector<Cause>& causes)
{
    if (!(rig.options.flags & GLASS_USE_POSES))
        return;
    const bool exact = std::all_of(rig.fit.views.begin(), rig.fit.views.end(), [&](int m) {
        return rig.data.views[m].pose && rig.data.views[m].pose->covariance.empty(); });
    causes.push_back({"poses", {}, [=](const Relaxed&, double) {
        return std::string("the images contradict --poses, which are taken as ")
            + (exact ? "exact: give their uncertainty in the columns sigma_deg and sigma, or measure them again"
               : "exact as sigma_deg and sigma say: measure them again, or say more"); }, true});
}

} // namespace

std::vector<Cause> causesOf(const RigData& data, const RigOptions& options, const Fit& fit)
{
    const FittedRig rig{data, options, fit};
    std::vector<Cause> causes;
    addValues(rig, causes);
    addWedges(rig, causes);
    addBows(rig, causes);
    addMotion(rig, causes);
    addLenses(rig, causes);
    addPlaces(rig, causes);
    addTarget(rig, causes);
    addPoses(rig, causes);
    return causes;
}

} // namespace tools
