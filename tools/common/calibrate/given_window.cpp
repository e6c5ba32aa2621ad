// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/given_window.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/options.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>
#include <set>

using namespace cv::refract;

using cv::format;

namespace tools {

namespace {

const char* const OPTIONS[] = {"--window", "--radius", "--center", "--axis", "--thickness", "--index", "--inner-index", "--outer-index",
                               "--wavelength", "--distance"};

const std::map<std::string, int> SHAPES = {{"flat", WINDOW_FLAT}, {"dome", WINDOW_DOME}, {"tube", WINDOW_TUBE}, {"bent", WINDOW_BENT}};

const double MOST_INDEX = 4.1;          // germanium in the infrared has 4.0

/** Only ratios of indices count, and the module takes none below 1: where a medium is air that is thinner than that which
indices are relative to, all become relative to the thinner one. */
void makeRelativeToThinnest(GivenWindow& given)
{
    const GivenIndex unit = given.inner.value < given.outer.value ? given.inner : given.outer;
    if (!unit.isNamed() || unit.value >= 1.)
        return;
    std::vector<GivenIndex*> indices = {&given.inner, &given.outer};
    for (GivenIndex& layer : given.layers)
        indices.push_back(&layer);
    for (GivenIndex* index : indices)
    {
        if (index->isNamed())
            index->name += index->value == unit.value ? ", which all are relative to," : ", relative to " + unit.name + ",";
        index->value /= unit.value;
    }
}

} // namespace

cv::Vec3d parseVector(const std::string& text, const char* option)
{
    const std::vector<double> numbers = parseNumbers(text, option);
    if (numbers.size() != 3)
        throw Failure(std::string(option) + "=" + text + ": give three numbers, X,Y,Z in the camera's frame (x to the right, y down, "
                      "z ahead)");
    return cv::Vec3d(numbers.data());
}

bool GivenWindow::hasMaterials() const
{
    const auto named = [](const GivenIndex& index) { return index.isNamed(); };
    return named(inner) || named(outer) || std::any_of(layers.begin(), layers.end(), named);
}

void GivenWindowOptions::addTo(OptionParser& parser, const std::string& distance)
{
    parser_ = &parser;
    std::vector<std::string> shapes;
    for (const auto& entry : SHAPES)
        shapes.push_back(entry.first);
    parser.add("--window", shape_, "shape of the windows: flat, bent (flat with --bow-std), dome or tube")
        .check(isMember(shapes)).captureDefault();
    parser.add("--radius", radius_, "of a dome's or tube's inner face").check(moreThanZero());
    parser.add("--center", center_, "of a dome, or a point of a tube's axis, from which to start: X,Y,Z in the camera's frame "
        "(default: 0,0,0, the camera itself)");
    parser.add("--axis", axis_, "of a tube, its direction, from which to start: X,Y,Z in the camera's frame, 0,1,0 if upright");
    parser.add("--thickness", thickness_, "thickness of each layer, from the camera outwards: T[,T...]");
    parser.add("--index", index_, "index of refraction of each layer, or its material: N[,N...], as 1.52 "
        "or N-BK7,PMMA,N-BK7");
    parser.add("--inner-index", innerIndex_, "index of the medium round the camera, or its name")
        .captureDefault();
    parser.add("--outer-index", outerIndex_, "index of the scene's medium, or its name: 1.333, water, "
        "seawater:T=12,S=35").captureDefault();
    parser.add("--wavelength", wavelength_, "of the light, nm, for materials that are named (default: 550; of red images "
        "610, green 540, blue 465)").check(moreThanZero());
    parser.add("--distance", distance_, "from the camera's centre of projection to a flat window; " + distance);
}

bool GivenWindowOptions::isSaid() const
{
    return std::any_of(std::begin(OPTIONS), std::end(OPTIONS), [this](const char* name) { return parser_->get(name).count() > 0; });
}

bool GivenWindowOptions::isDistanceSaid() const { return parser_->get("--distance").count() > 0; }

//! Options of what windows of this shape do not have.
void GivenWindowOptions::requireOptionsOfShape() const
{
    const bool isRoundWindow = shape_ == "dome" || shape_ == "tube";
    if (!isRoundWindow)
    {
        if (radius_ > 0.)
            throw Failure("--radius and --free=radius are of a dome or tube, and --window is " + shape_ + ": add --window=dome or "
                          "--window=tube, or leave them out");
        if (!center_.empty() || !axis_.empty())
            throw Failure("--center and --axis are of a dome or tube, and --window is " + shape_ + ": add --window=dome or --window=tube, "
                          "or leave them out");
        return;
    }
    if (!(radius_ > 0.))
        throw Failure("--window=" + shape_ + " needs --radius, of its inner face");
    if (isDistanceSaid())
        throw Failure("--distance is of a flat window: where a " + shape_ + " is, its centre says, which is estimated (--center: where to "
                      "start); leave it out");
    if (shape_ == "tube" && axis_.empty())
        throw Failure("--window=tube needs --axis, roughly the direction of its axis in the camera's frame: 0,1,0 if it is upright");
    if (shape_ == "dome" && !axis_.empty())
        throw Failure("--axis is of a tube; a dome has none: leave it out");
}

//! Numbers, or by the materials' names.
void GivenWindowOptions::takeIndices(Channel channel, GivenWindow& given) const
{
    const Light light = lightOf(channel, wavelength_);
    if (!index_.empty())
        given.layers = readIndices(index_, light, "--index");
    given.inner = readIndex(innerIndex_, light, "--inner-index");
    given.outer = readIndex(outerIndex_, light, "--outer-index");
    if (wavelength_ > 0 && !given.hasMaterials())
        throw Failure("--wavelength: no material is named, and indices that are numbers do not depend on it; leave it out");
    makeRelativeToThinnest(given);
    for (const GivenIndex& layer : given.layers)
        given.window.index.push_back(layer.value);
    given.window.innerIndex = given.inner.value;
    given.window.outerIndex = given.outer.value;
    if (!given.hasMaterials())
        return;
    given.window.wavelength = light.wavelength;
    given.window.materials = {given.inner.material};
    for (const GivenIndex& layer : given.layers)
        given.window.materials.push_back(layer.material);
    given.window.materials.push_back(given.outer.material);
}

//! Layers and media that there are.
void GivenWindowOptions::requireMaterials(const GlassWindow& window) const
{
    for (double thickness : window.thickness)
        if (!(thickness > 0))
            throw Failure("--thickness=" + thickness_ + ": a layer is thicker than 0; without glass (a bare water surface) "
                          "leave --thickness and --index out");
    // Among several layers, one of index 1 is the gap of double glazing.
    double most = 0.;
    for (double index : window.index)
    {
        most = std::max(most, index);
        if (!(index >= 1) || index > MOST_INDEX)
            throw Failure("--index=" + index_ + format(": no material has the index %g; glass has 1.4 to 2, the data sheet "
                                                       "says which", index));
    }
    if (!window.index.empty() && most == 1)
        throw Failure("--index=" + index_ + ": that is air; glass has an index of 1.4 to 2, the data sheet says which");
    const std::pair<const char*, double> media[] = {{"--inner-index", window.innerIndex}, {"--outer-index", window.outerIndex}};
    for (const auto& medium : media)
        if (!(medium.second >= 1) || medium.second > MOST_INDEX)
            throw Failure(format("%s=%g: no medium has that index; air has 1, water 1.333", medium.first, medium.second));
}

//! Where a dome or tube is, to start from.
void GivenWindowOptions::takePlace(GlassWindow& window) const
{
    if (!isRound(window))
    {
        window.distance = distance_;
        return;
    }
    window.radius = radius_;
    if (!center_.empty())
        window.center = parseVector(center_, "--center");
    if (!axis_.empty())
    {
        const cv::Vec3d axis = parseVector(axis_, "--axis");
        if (!(cv::norm(axis) > 0.))
            throw Failure("--axis=" + axis_ + ": that is no direction; give 0,1,0 for an upright tube");
        window.axis = cv::normalize(axis);
    }
    const double offset = offsetOf(window);
    if (!(offset < window.radius))
        throw Failure("--center=" + center_ + format(": there the camera would be %g from the %s of the %s, outside its radius of %g: "
                      "give the centre in the camera's frame, nearer than the radius", offset, shape_ == "dome" ? "centre" : "axis",
                      shape_.c_str(), window.radius));
}

GivenWindow GivenWindowOptions::of(int flags, Channel channel) const
{
    GivenWindow given;
    GlassWindow& window = given.window;
    window.shape = shape_ == "bent" ? (int)WINDOW_FLAT : SHAPES.at(shape_);
    if (!thickness_.empty())
        window.thickness = parseNumbers(thickness_, "--thickness");
    takeIndices(channel, given);
    requireOptionsOfShape();
    requireFreeOfShape(window, flags);
    takePlace(window);
    if (window.thickness.size() != window.index.size())
        throw Failure(format("--thickness has %d, --index %d: both must have one number for each layer, with commas between layers and "
                             "points for decimals", (int)window.thickness.size(), (int)window.index.size()));
    requireMaterials(window);
    if (!refracts(window))
        throw Failure("there is no window to calibrate: give --thickness and --index, or an --outer-index that differs from "
                      "--inner-index (a bare water surface)");
    window.check();
    return given;
}

void GivenWindowOptions::requireBow(const GivenStd& std, int flags) const
{
    if (shape_ == "bent" && !(std.curvature > 0.) && !(flags & GLASS_FREE_CURVATURE))
        throw Failure("--window=bent: say how much it may be bent, --bow-std=2 for 2 mm of sag per metre (tempered plate), or "
                      "--free=curvature");
}

const std::map<std::string, int>& freeFlags()
{
    static const std::map<std::string, int> FLAGS = {
        {"thickness", GLASS_FREE_THICKNESS}, {"index", GLASS_FREE_INDEX}, {"distance", GLASS_FREE_DISTANCE},
        {"outer-index", GLASS_FREE_OUTER_INDEX}, {"intrinsics", GLASS_FREE_INTRINSICS}, {"wedge", GLASS_FREE_WEDGE},
        {"radius", GLASS_FREE_RADIUS}, {"curvature", GLASS_FREE_CURVATURE}};
    return FLAGS;
}

void requireFreeOfShape(const GlassWindow& window, int flags)
{
    const std::string shape = nameOfShape(window);
    const bool isEqual = !hasDifferentMedia(window);
    if (!isRound(window) && flags & GLASS_FREE_RADIUS)
        throw Failure("--free=radius is of a dome or tube, and a flat window has none: leave it out");
    if (isRound(window) && flags & GLASS_FREE_DISTANCE)
        throw Failure("--free=distance is of a flat window: where a " + shape + " is, its centre says, which is estimated; leave it out");
    if (isRound(window) && flags & GLASS_FREE_WEDGE)
        throw Failure("--free=wedge is of a flat window: the faces of a " + shape + " have one centre; leave it out");
    if (isRound(window) && flags & GLASS_FREE_CURVATURE)
        throw Failure("--free=curvature is of a flat window; for a " + shape + " say --free=radius");
    if (window.thickness.empty() && flags & (GLASS_FREE_THICKNESS | GLASS_FREE_INDEX))
        throw Failure("--free=thickness and --free=index need a layer to start from: give --thickness and --index roughly");
    if (isEqual && flags & GLASS_FREE_DISTANCE)
        throw Failure("--free=distance: with the same medium on both sides of the window the distance has exactly no effect "
                      "on the image and cannot be found; leave it out, or say what the target was in (--outer-index=water)");
}

GlassWindow withEstimated(GlassWindow window, const GivenStd& std, int flags)
{
    if (isRound(window))
        return window;
    if (window.wedge.empty() && (std.wedge > 0. || flags & GLASS_FREE_WEDGE))
        window.wedge.assign(window.thickness.size(), cv::Vec2d());
    if (std.curvature > 0. || flags & GLASS_FREE_CURVATURE)
        window.shape = WINDOW_BENT;
    return window;
}

void putVariances(const GivenStd& std, const ParameterColumns& at, cv::Mat& covariance)
{
    const auto put = [&](int first, int count, double deviation) {
        for (int i = first; i < first + count && at.has(first); i++)
            covariance.at<double>(i, i) = deviation*deviation;
    };
    put(at.thickness, at.layers, std.thickness);
    for (int i = 0; i < at.layers; i++)
        put(at.index + i, 1, std.indexOf(i));
    put(at.wedge, at.curvature - at.wedge, std.wedge);
    put(at.normal, 3, std.normal);
    put(at.distance, 1, std.distance);
    put(at.radius, 1, std.radius);
    put(at.center, 3, std.center);
    put(at.curvature, 1, std.curvature);
    put(at.outerIndex, 1, std.outerIndex);
}

bool GivenRigOptions::isDistanceKnown() const { return window.isDistanceSaid() || places.areOfMarkers(); }

std::vector<int> GivenRigOptions::windowsOf(int cameras) const
{
    if (sharedWindow)
        return std::vector<int>(cameras, 0);
    if (windowOfCamera.empty())
        return {};
    std::vector<int> windows;
    for (double number : parseNumbers(windowOfCamera, "--window-of-camera"))
    {
        if (number != std::floor(number) || std::abs(number) > 1e6)
            throw Failure("--window-of-camera=" + windowOfCamera + ": give whole numbers, as 1,1,2,2");
        windows.push_back((int)number);
    }
    if ((int)windows.size() != cameras)
        throw Failure(format("--window-of-camera=%s has %zu numbers, but there are %d cameras: give one for each",
                             windowOfCamera.c_str(), windows.size(), cameras));
    return windows;
}

//! Standard deviations of what is given.
void GivenRigOptions::takeStd(double square, RigOptions& rig) const
{
    GivenValues values;
    values.layers = rig.layers;
    values.outer = rig.outer;
    values.equalMedia = !hasDifferentMedia(rig.window);
    values.distance = isDistanceKnown();
    values.shape = rig.window.shape;
    values.square = square;
    values.millimetre = 1./millimetresIn(unit);
    values.flags = rig.flags;
    rig.std = std.of(values);
    rig.std.normal = places.normalStd();
    window.requireBow(rig.std, rig.flags);
    rig.window = withEstimated(rig.window, rig.std, rig.flags);
    const std::set<int> windows(rig.windows.begin(), rig.windows.end());
    if (rig.window.shape == WINDOW_BENT && !rig.window.wedge.empty() && windows.size() < rig.windows.size())
        throw Failure("a bent window that several cameras share cannot have a wedge, too, as its faces would have no common centre: say "
                      "--wedge-std=0 (and no --free=wedge), or leave --bow-std out");
}

void GivenRigOptions::takePlaces(int cameras, RigOptions& rig) const
{
    const std::string option = places.option();
    if (places.isSaid() && isRound(rig.window))
        throw Failure(option + " is of a flat window; where a " + window.shape() + " is, --center says, with --center-std");
    if (places.areOfMarkers() && rig.flags & GLASS_FREE_DISTANCE)
        throw Failure("--free=distance says that the images alone tell the distance, and --pane-points what is known of it: leave one out");
    rig.places = places.of(cameras, rig.windows);
    rig.placeOption = option;
}

RigOptions GivenRigOptions::of(int cameras, Channel channel, bool knowsPoses, double square) const
{
    RigOptions rig;
    for (const std::string& name : free)
        rig.flags |= freeFlags().at(name);
    const GivenWindow given = window.of(rig.flags, channel);
    rig.window = given.window;
    rig.layers = given.layers;
    rig.inner = given.inner;
    rig.outer = given.outer;
    rig.channel = channel;
    rig.windows = windowsOf(cameras);
    takePlaces(cameras, rig);
    if (knowsPoses)
        rig.flags |= GLASS_USE_POSES;
    if (hasDifferentMedia(rig.window) && !isDistanceKnown() && !isRound(rig.window))
        rig.flags |= GLASS_FREE_DISTANCE;
    takeStd(square, rig);
    return rig;
}

std::string GivenRigOptions::noticeOfLiquid(const GlassWindow& given) const
{
    const double LEAST_SOLID = 1.36;        // no solid that windows are made of has less; water has 1.333
    for (size_t i : {(size_t)0, given.index.size() - 1})
        if (!given.index.empty() && given.index[i] < LEAST_SOLID)
            return "--index=" + window.index() + format(": the %s has the index %.4g, as a liquid: no window is made of that. "
                   "The medium behind the window is --outer-index, a bare surface has no --thickness and no --index",
                   given.index.size() == 1 ? "window" : i ? "outermost layer" : "innermost layer", given.index[i]);
    return "";
}

} // namespace tools
