// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/acceptance.hpp"
#include "accept/measuring_lines.hpp"
#include "console/failure.hpp"
#include <algorithm>
#include <cmath>

namespace tools {

Decision decide(double error, double U, double limit)
{
    if (std::abs(error) + U <= limit)
        return Decision::PASS;
    return std::abs(error) - U > limit ? Decision::FAIL : Decision::UNDECIDED;
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

Acceptance testLengths(const TestPoints& points, const PointErrors& errors, const std::vector<CalibratedLength>& lengths,
                       const PermissibleError& limit, const std::optional<CalibratedVolume>& volume)
{
    Acceptance result{points, limit, {}, volume, {}, {}, "", false};
    for (const CalibratedLength& length : lengths)
    {
        const LinearQuantity distance = distanceOf(points, length.ends[0], length.ends[1]);
        LengthResult r{length, distance.value, distance.value - length.length, limit.of(length.length), GumTable(), Decision::UNDECIDED};
        r.budget = errors.table(distance, "the length as certified", length.U);
        r.budget.quantity = "error of the length '" + length.name + "'";
        r.budget.value = r.error;
        if (!std::isfinite(r.budget.U))
            throw Failure("the uncertainty of the length '" + length.name + "' is not known: its points are seen by fewer cameras than it "
                          "takes, or the calibration has no noise of a pixel; calibrate with refract_calib, or give --pixel-sigma");
        r.decision = decide(r.error, r.budget.U, r.limit);
        for (size_t end : length.ends)
            r.outside = r.outside || (volume && !volume->contains(points.points[end].X));
        result.lengths.push_back(r);
    }
    result.missing = missingOf(result);
    return result;
}

} // namespace tools
