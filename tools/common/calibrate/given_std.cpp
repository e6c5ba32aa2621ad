// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/given_std.hpp"
#include "calibrate/units.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/options.hpp"
#include <opencv2/refract.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <limits>

using namespace cv::refract;
using namespace cv;

namespace tools {

namespace {

bool isName(const std::string& text)
{
    double number;
    return !text.empty() && std::isalpha((unsigned char)text[0]) && !parseNumber(text, number);
}

//! What is known is a name: the light may be of any colour of the band, the piece of any batch.
double deviationOf(const std::string& name, const Light& light)
{
    return std::hypot(refractiveIndexTolerance(name), 0.5*(refractiveIndex(name, light.shortest) - refractiveIndex(name, light.longest)));
}

GivenIndex named(const std::string& name, const Light& light, const std::string& option)
{
    bool isKnown = false;
    try
    {
        refractiveIndexTolerance(name);
        isKnown = true;
        return {refractiveIndex(name, light.wavelength), name, name, light, deviationOf(name, light)};
    }
    catch (const cv::Exception& e)
    {
        if (isKnown)    // then it is the wavelength that is out of range
            throw Failure(format("--wavelength=%g: ", light.wavelength) + e.err + "; give nm, as 550");
        throw Failure(option + "=" + name + ": " + e.err);
    }
}

// What is usual where nothing is said.
const double THICKNESS_MM = 0.1;            // a data sheet's tolerance, or a caliper on a built-in pane
const double INDEX = 0.001;                 // of a number; a material's name tells its own
const double DISTANCE_MM = 1.;              // a ruler to where the centre of projection is thought to be
const double WEDGE_MINUTES = 1.;            // plate glass
const double RADIUS_MM = 0.1;               // a drawing's tolerance

const char* const DEFAULT = "default";

} // namespace

std::string GivenIndex::sentence() const
{
    return format("the index of %s at %g nm: %.5f", name.c_str(), of.wavelength, value);
}

std::string GivenIndex::light() const
{
    return name + (of.shortest < of.longest ? format(", light of %g to %g nm", of.shortest, of.longest) : std::string());
}

GivenIndex readIndex(const std::string& text, const Light& light, const std::string& option)
{
    if (isName(text))
        return named(text, light, option);
    const std::vector<double> numbers = parseNumbers(text, option);
    if (numbers.size() != 1)
        throw Failure(option + "=" + text + ": give one number, or the name of a material");
    return {numbers[0]};
}

std::vector<GivenIndex> readIndices(const std::string& text, const Light& light, const std::string& option)
{
    std::vector<GivenIndex> indices;
    for (const std::string& item : splitAtCommas(text))
    {
        if (item.find('=') != std::string::npos)
            throw Failure(option + "=" + text + ": '" + item + "': a layer's material stands without parameters");
        indices.push_back(readIndex(item, light, option));
    }
    return indices;
}

std::string Std::text(const std::string& unit, double factor) const
{
    const double number = value*factor;
    std::string digits = cv::format("%.2g", number);
    if (number >= 100.)
        digits = cv::format("%.0f", std::stod(digits));     // no power of ten
    return digits + unit + (source.empty() ? "" : " (" + source + ")");
}

Std usualStdOf(const GivenIndex& index)
{
    if (index.isNamed())        // a rectangular distribution of that half width (GUM 4.3.7)
        return Std(index.deviation/std::sqrt(3.), index.light());
    return Std(index.value == 1. ? 0. : INDEX, DEFAULT);
}

bool GivenStd::ofIndices() const
{
    return std::any_of(index.begin(), index.end(), [](const Std& std) { return std > 0.; });
}

bool GivenStd::ofWindow() const
{
    return thickness > 0. || ofIndices() || outerIndex > 0. || distance > 0. || wedge > 0. || radius > 0. || center > 0. || normal > 0.
        || curvature > 0.;
}

void GivenStdOptions::addTo(OptionParser& parser, bool target)
{
    std::fill(said_, said_ + COUNT, std::numeric_limits<double>::quiet_NaN());
    const auto add = [&](const char* name, int which, const std::string& about) {
        parser.add(name, said_[which], about).check(notNegative());
    };
    add("--thickness-std", THICKNESS, "how well the thickness of each layer is known, one standard deviation; it is estimated within it, "
        "and is in every +-; 0: exact (default: 0.1 mm)");
    add("--index-std", INDEX, "the same of each index (default: 0.001; of a material, its tolerance and the light's band)");
    add("--outer-index-std", OUTER_INDEX, "the same of --outer-index (default: the same)");
    add("--distance-std", DISTANCE, "the same of --distance (default: 1 mm)");
    add("--wedge-std", WEDGE, "the same of the angle between the faces of each layer, about 0, in arc minutes: polished optics 0.2, plate "
        "glass 1 to 3 (default: 1)");
    add("--radius-std", RADIUS, "the same of --radius (default: 0.1 mm)");
    add("--center-std", CENTER, "the same of each coordinate of --center, of a dome or tube (default: nothing is known of it)");
    add("--bow-std", BOW, "how much a flat window may be bent, one standard deviation, in mm of sag per metre: tempered plate 1 to 3; "
        "its curvature is then estimated within it (default: 0, flat; a pane that bows by 2 is off by 2 to 4 times the stated +- then)");
    if (target)
    {
        add("--square-std", SQUARE, "the same of --square (default: 0.05 %)");
        add("--scale-std", SCALE, "the same of the scale of targets that come in points.csv, in percent of their lengths (default: "
            "0.05)");
        add("--placement-std", PLACEMENT, "by how much all boards, or the camera's mount, moved between the direct and the glass images, "
            "along each axis, one standard deviation (default: 0.02 mm)");
    }
    parser.addFlag("--exact", exact_, "what is given is exact, where none of these options says another thing (simulated images)");
}

bool GivenStdOptions::isSaid() const
{
    return exact_ || std::any_of(said_, said_ + COUNT, [](double std) { return !std::isnan(std); });
}

//! Deviations of what windows of this shape have.
void GivenStdOptions::requireShape(const GivenValues& v) const
{
    std::vector<int> shapes = v.others;
    shapes.push_back(v.shape);
    const auto any = [&shapes](const std::function<bool(int)>& is) { return std::any_of(shapes.begin(), shapes.end(), is); };
    const bool hasFlat = any([](int shape) { return shape == WINDOW_FLAT || shape == WINDOW_BENT; });
    const bool hasRound = any([](int shape) { return shape == WINDOW_DOME || shape == WINDOW_TUBE; });
    if (!hasFlat && isMoreThanZero(WEDGE))
        throw Failure("--wedge-std is of a flat window: the faces of a dome or tube have one centre; leave it out");
    if (!hasFlat && isMoreThanZero(DISTANCE))
        throw Failure("--distance-std is of a flat window: where a dome or tube is, its centre says, which is estimated; leave it out");
    if (!hasFlat && isMoreThanZero(BOW))
        throw Failure("--bow-std is of a flat window; how well a dome's or tube's radius is known is --radius-std");
    if (!hasRound && isMoreThanZero(RADIUS))
        throw Failure("--radius-std is of a dome or tube: add --window=dome and --radius, or leave it out");
    if (!hasRound && isMoreThanZero(CENTER))
        throw Failure("--center-std is of a dome or tube: add --window=dome and --radius, or leave it out");
}

GivenStd GivenStdOptions::of(const GivenValues& v) const
{
    const bool isFlat = v.shape == WINDOW_FLAT || v.shape == WINDOW_BENT;
    const bool layers = !v.layers.empty();
    const auto isSaid = [this](int which) { return isMoreThanZero(which); };
    requireShape(v);
    if (!layers && isSaid(BOW))
        throw Failure("--bow-std is of a pane: give --thickness and --index");
    if (!layers && (isSaid(THICKNESS) || isSaid(INDEX) || isSaid(WEDGE)))
        throw Failure("--thickness-std, --index-std and --wedge-std are of layers: give --thickness and --index");
    if (v.equalMedia && isSaid(OUTER_INDEX))
        throw Failure("--outer-index-std: the medium on both sides of the window is what indices are relative to; leave it out");
    if (isSaid(SQUARE) && !(v.square > 0.))
        throw Failure("--square-std is of the square of a board: add --square; of points (points.csv) give --scale-std, in percent");
    if (isSaid(SCALE) && v.square > 0.)
        throw Failure("--scale-std is of targets in points.csv; how well the square of a board is known is --square-std");
    const auto choose = [&](int which, double factor, const Std& usual, bool hasDefault) {
        if (!std::isnan(said_[which]))
            return Std(factor*said_[which]);
        return hasDefault && !exact_ ? usual : Std();
    };
    const auto isFree = [&v](int flag) { return (v.flags & flag) != 0; };
    GivenStd std;
    std.thickness = choose(THICKNESS, 1., Std(THICKNESS_MM*v.millimetre, DEFAULT), layers && !isFree(GLASS_FREE_THICKNESS));
    for (const GivenIndex& layer : v.layers)
        std.index.push_back(choose(INDEX, 1., usualStdOf(layer), !isFree(GLASS_FREE_INDEX)));
    std.outerIndex = choose(OUTER_INDEX, 1., usualStdOf(v.outer), !v.equalMedia && !isFree(GLASS_FREE_OUTER_INDEX));
    std.wedge = choose(WEDGE, ARC_MINUTE, Std(WEDGE_MINUTES*ARC_MINUTE, DEFAULT), layers && isFlat && !isFree(GLASS_FREE_WEDGE));
    // Between equal media parallel faces hide where they are; a wedge turns rays there.
    const bool showsDistance = isFlat && (!v.equalMedia || (layers && (std.wedge > 0. || isFree(GLASS_FREE_WEDGE))));
    if (isSaid(DISTANCE) && isFlat && !showsDistance)
        throw Failure("--distance-std: with the same medium on both sides of the window and parallel faces the distance has no effect on "
                      "the image; leave it out");
    if (isSaid(DISTANCE) && !v.distance)
        throw Failure("--distance-std is of a distance that is given: add --distance");
    std.distance = choose(DISTANCE, 1., Std(DISTANCE_MM*v.millimetre, DEFAULT),
                          showsDistance && v.distance && !isFree(GLASS_FREE_DISTANCE));
    std.isDistanceOpen = showsDistance && v.equalMedia && !v.distance;
    std.radius = choose(RADIUS, 1., Std(RADIUS_MM*v.millimetre, DEFAULT), !isFlat && !isFree(GLASS_FREE_RADIUS));
    std.center = isFlat ? Std() : choose(CENTER, 1., Std(), false);
    std.bow = choose(BOW, 1., Std(), false);
    // A sag s over a length L is a curvature of 8 s/L^2; the length is a metre.
    std.curvature = 8.*std.bow*v.millimetre/std::pow(1000.*v.millimetre, 2);
    const double PERCENT = 0.01;
    const Std scale(USUAL_SQUARE_STD, DEFAULT);
    std.scale = v.square > 0. ? choose(SQUARE, 1./v.square, scale, true) : choose(SCALE, PERCENT, scale, true);
    std.placement = choose(PLACEMENT, 1., Std(USUAL_PLACEMENT_MM*v.millimetre, DEFAULT), true);
    return std;
}

} // namespace tools
