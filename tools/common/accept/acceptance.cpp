// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/acceptance.hpp"
#include "accept/measuring_lines.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace tools {

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
        all.insert(all.begin(), scale->sentence());
    if (outside())
        all.push_back(cv::format("Outside of %s (marked *): %d of %zu lengths", volume.name().c_str(), outside(), lengths.size()));
    std::string lacks;
    for (const std::string& part : missing)
        lacks += (lacks.empty() ? "" : "; ") + part;
    if (!lacks.empty())
        all.push_back("VDI/VDE 2634 part 1 asks for more: " + lacks);
    return all;
}

std::string CommonScale::sentence() const
{
    const std::string sign = value > 0 ? "+" : "";
    return "All errors share one scale, " + sign + plusMinus(100.*value, 100.*std)
        + cv::format(" %% (%d of %d have its sign): look at the square of the board that calibrated, and at the standard", ofOneSign,
                     count);
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

} // namespace tools
