// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/acceptance.hpp"
#include "calibrate/units.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

using cv::Vec3d;

namespace tools {

namespace {

const size_t LINES = 7, LENGTHS_A_LINE = 5;
const double OF_DIAGONAL = 2./3., NEXT_TO_LINE = 0.05, ACROSS = 0.1, SAME_LENGTH = 0.01;

Vec3d endOf(const Acceptance& a, size_t length, int end) { return a.points.points[a.lengths[length].length.ends[end]].X; }

bool isOnLine(const Acceptance& a, size_t line, size_t length)
{
    const Vec3d start = endOf(a, line, 0), along = endOf(a, line, 1) - start;
    const Vec3d own = endOf(a, length, 1) - endOf(a, length, 0);
    const double scale = norm(along);
    if (norm(own.cross(along)) > ACROSS*norm(own)*scale)            // a short one that crosses it
        return false;
    for (int end : {0, 1})
        if (norm((endOf(a, length, end) - start).cross(along))/scale > NEXT_TO_LINE*scale)
            return false;
    return true;
}

//! Lengths that differ, in the volume.
size_t countDistinct(const Acceptance& a, const MeasuringLine& line)
{
    std::vector<double> lengths;
    for (size_t i : line)
        if (!a.lengths[i].outside)
            lengths.push_back(a.lengths[i].length.length);
    std::sort(lengths.begin(), lengths.end());
    size_t count = 0;
    double last = 0.;
    for (double length : lengths)
        if (length > (1 + SAME_LENGTH)*last)
        {
            count++;
            last = length;
        }
    return count;
}

const double ROUNDING = 1e-4;           // of a certificate, and of a square as it was given
const double TELLING = 0.2;             // chance that any length would agree

//! Whether a whole number within the tolerance is a sum of two squares.
bool isSumOfSquares(double number, double tolerance)
{
    for (int n = std::max(1, (int)std::ceil(number - tolerance)); n <= number + tolerance; n++)
        for (int a = 0; 2*a*a <= n; a++)
        {
            const int b = (int)std::lround(std::sqrt((double)(n - a*a)));
            if (a*a + b*b == n)
                return true;
        }
    return false;
}

} // namespace

std::vector<MeasuringLine> measuringLines(const Acceptance& a)
{
    std::vector<size_t> order(a.lengths.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t i, size_t j) {
        return a.lengths[i].length.length > a.lengths[j].length.length; });
    std::vector<MeasuringLine> lines;
    for (size_t i : order)
    {
        const auto line = std::find_if(lines.begin(), lines.end(), [&](const MeasuringLine& l) { return isOnLine(a, l[0], i); });
        if (line == lines.end())
            lines.push_back({i});
        else
            line->push_back(i);
    }
    return lines;
}

std::vector<std::string> missingOf(const Acceptance& a)
{
    const std::vector<MeasuringLine> lines = measuringLines(a);
    size_t whole = 0;
    double longest = 0.;
    for (const MeasuringLine& line : lines)
        whole += countDistinct(a, line) >= LENGTHS_A_LINE;
    for (const LengthResult& length : a.lengths)
        longest = std::max(longest, length.outside ? 0. : length.length.length);
    std::vector<std::string> missing;
    if (whole < LINES)
        missing.push_back(format("%zu of %zu measuring lines have %zu lengths or more (of %zu lines)", whole, LINES, LENGTHS_A_LINE,
                                 lines.size()));
    if (!a.volume.box)
        missing.push_back("the volume is not known, of whose diagonal the longest length must be two thirds (--volume)");
    else if (longest == 0.)
        missing.push_back("no length is within " + a.volume.name());
    else if (longest < OF_DIAGONAL*a.volume.box->diagonal())
        missing.push_back(format("the longest length is %.2g of the diagonal of %s, %.4g, not two thirds",
                                 longest/a.volume.box->diagonal(), a.volume.name().c_str(), a.volume.box->diagonal()));
    return missing;
}

const char* const DECISION_RULE = "ISO 14253-1:2017 with guard bands of expanded uncertainties for 95.45 %, as its editions of 1998 and "
    "2013 had them (its own default, a conformance probability of 95 %, is 1.65 u). "
    "Pass: |error| + U <= limit, U with the rig's calibration. "
    "Fail: |error| - U of the test > limit, with the certified length, its temperature and the noise of the points' pixels, without the "
    "calibration of the rig, which is what is tested. Else undecided";

Decision decide(double error, double U, double testU, double limit)
{
    if (std::abs(error) + U <= limit)
        return Decision::PASS;
    return std::abs(error) - testU > limit ? Decision::FAIL : Decision::UNDECIDED;
}

std::string TestVolume::numbers() const
{
    if (!box)
        return "not known";
    const cv::Point3d& p = box->least, & q = box->most;
    return cv::format("x %.4g ... %.4g, y %.4g ... %.4g, z %.4g ... %.4g", p.x, q.x, p.y, q.y, p.z, q.z);
}

std::string textOf(Decision decision)
{
    return decision == Decision::PASS ? "pass" : decision == Decision::FAIL ? "fail" : "undecided";
}

int Acceptance::count(Decision wanted) const
{
    return (int)std::count_if(lengths.begin(), lengths.end(), [&](const LengthResult& l) { return l.decision == wanted; });
}

int Acceptance::outside() const
{
    return (int)std::count_if(lengths.begin(), lengths.end(), [](const LengthResult& l) { return l.outside; });
}

Decision Acceptance::decision() const
{
    return count(Decision::FAIL) ? Decision::FAIL : count(Decision::UNDECIDED) ? Decision::UNDECIDED : Decision::PASS;
}

const LengthResult& Acceptance::decisive() const
{
    // One that fails decides before one that only uses more of its limit for its U.
    return *std::max_element(lengths.begin(), lengths.end(), [](const LengthResult& a, const LengthResult& b) {
        return std::make_pair(a.decision == Decision::FAIL, a.used()) < std::make_pair(b.decision == Decision::FAIL, b.used()); });
}

const LengthResult& Acceptance::largest() const
{
    return *std::max_element(lengths.begin(), lengths.end(), [](const LengthResult& a, const LengthResult& b) {
        return std::abs(a.error) < std::abs(b.error); });
}

double Acceptance::rms() const
{
    double squares = 0.;
    for (const LengthResult& length : lengths)
        squares += length.error*length.error;
    return std::sqrt(squares/lengths.size());
}

std::vector<std::string> Acceptance::remarks() const
{
    std::vector<std::string> all = notices;
    if (const std::optional<CommonScale> scale = commonScale(lengths))
        all.insert(all.begin(), scale->sentence(unit));
    if (outside())
        all.push_back(cv::format("Outside of %s (marked *): %d of %zu lengths", volume.name().c_str(), outside(), lengths.size()));
    std::string lacks;
    for (const std::string& part : missing)
        lacks += (lacks.empty() ? "" : "; ") + part;
    if (!lacks.empty())
        all.push_back("VDI/VDE 2634 part 1 asks for more: " + lacks);
    return all;
}

std::string CommonScale::sentence(const std::string& unit) const
{
    const std::string unitOfLengths = unitSeen(1. + value, unit);
    const std::string sign = value > 0 ? "+" : "";
    return "All errors share one scale, " + sign + plusMinus(100.*value, 100.*std)
        + cv::format(" %% (%d of %d have its sign): ", ofOneSign, count)
        + (unitOfLengths.empty() ? "look at the square of the board that calibrated, and at the standard"
           : "are the certified lengths in " + unitOfLengths + "? They must be in the unit of the calibration"
               + (unit.empty() ? "" : ", " + unit));
}

/* Least squares with the test's own errors; those of one certificate may be common, which no scatter shows: a scale is known no better than
the best of the lengths. */
std::optional<CommonScale> commonScale(const std::vector<LengthResult>& lengths)
{
    const size_t FEWEST = 3;
    const double CLEAR = 3., EXPLAINS = 0.5, NEARLY_ALL = 0.9;
    double weights = 0., sum = 0., squares = 0., common = std::numeric_limits<double>::infinity();
    for (const LengthResult& r : lengths)
    {
        const double u = 0.5*r.testU()/r.length.length, scale = r.error/r.length.length;
        weights += 1./(u*u);
        sum += scale/(u*u);
        squares += scale*scale/(u*u);
        common = std::min(common, 0.5*r.length.U/r.length.length);
    }
    CommonScale scale{sum/weights, std::hypot(1./std::sqrt(weights), common), 0, (int)lengths.size()};
    for (const LengthResult& r : lengths)
        scale.ofOneSign += r.error*scale.value > 0;
    const bool explains = squares - sum*scale.value < EXPLAINS*squares && scale.ofOneSign >= NEARLY_ALL*scale.count;
    if (lengths.size() < FEWEST || !(std::abs(scale.value) > CLEAR*scale.std) || !explains)
        return std::nullopt;
    return scale;
}

Acceptance testLengths(const TestPoints& points, const PointErrors& errors, const std::vector<CalibratedLength>& lengths,
                       const PermissibleError& limit, const TestVolume& volume)
{
    Acceptance result{points, limit, {}, volume, {}, {}, "", false};
    for (const CalibratedLength& length : lengths)
    {
        const LinearQuantity distance = distanceOf(points, length.ends[0], length.ends[1]);
        LengthResult r{length, distance.value, distance.value - length.length, limit.of(length.length), GumTable(), Decision::UNDECIDED};
        r.budget = errors.table(distance, sourcesOf(length));
        r.budget.quantity = "error of the length '" + length.name + "'";
        r.budget.value = r.error;
        if (!std::isfinite(r.budget.U))
            throw Failure("the uncertainty of the length '" + length.name + "' is not known: its points are seen by fewer cameras than it "
                          "takes, or the calibration has no noise of a pixel; calibrate with refract_calib, or give --pixel-sigma");
        r.decision = decide(r.error, r.U(), r.testU(), r.limit);
        for (size_t end : length.ends)
            r.outside = r.outside || (volume.box && !volume.box->contains(points.points[end].X));
        result.lengths.push_back(r);
    }
    result.missing = missingOf(result);
    return result;
}

bool areOfBoard(const std::vector<CalibratedLength>& lengths, double square)
{
    int telling = 0;
    for (const CalibratedLength& length : lengths)
    {
        const double squares = length.length/square, tolerance = 2.*squares*(length.U/square + ROUNDING*squares);
        if (!(square > 0) || !(tolerance < TELLING))
            continue;
        telling++;
        if (!isSumOfSquares(squares*squares, tolerance))
            return false;
    }
    return telling > 0;
}

} // namespace tools
