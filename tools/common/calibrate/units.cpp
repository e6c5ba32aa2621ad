// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/units.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"
#include <cmath>
#include <map>

namespace tools {

namespace {

const std::map<std::string, double> MILLIMETRES = {{"mm", 1.}, {"cm", 10.}, {"m", 1000.}, {"inch", 25.4}};
const double NEARLY = 0.05;
const double OTHER_BOARD = 3.;      // boards of one caller differ less, most of the time

} // namespace

std::vector<std::string> unitNames()
{
    std::vector<std::string> names;
    for (const auto& unit : MILLIMETRES)
        names.push_back(unit.first);
    return names;
}

double millimetresIn(const std::string& unit)
{
    return MILLIMETRES.at(unit);
}

double bowOf(double curvature, const std::string& unit) { return curvature/curvatureOf(1., unit); }

double curvatureOf(double bow, const std::string& unit) { return 8.*bow/(1000.*1000.)*millimetresIn(unit); }

static bool isRatioOfUnits(double ratio, double tolerance)
{
    for (const auto& a : MILLIMETRES)
        for (const auto& b : MILLIMETRES)
            if (a.second != b.second && std::abs(ratio*b.second/a.second - 1.) < tolerance)
                return true;
    return false;
}

bool isRatioOfUnits(double ratio) { return isRatioOfUnits(ratio, NEARLY); }

std::string unitSeen(double ratio, const std::string& unit)
{
    const double ROUNDED = 0.01;        // 24 for 24.14
    if (!isRatioOfUnits(ratio, ROUNDED))
        return "";
    for (const auto& other : MILLIMETRES)
        if (!unit.empty() && std::abs(ratio*millimetresIn(unit)/other.second - 1.) < ROUNDED)
            return other.first;
    return "another unit";
}

void requireSameUnit(const Calibration& calibration, double square, const std::string& unit)
{
    if (!unit.empty() && !calibration.unit.empty() && unit != calibration.unit)
        throw Failure("--unit=" + unit + ": the calibration's lengths are in " + calibration.unit + ", so give --square in "
                      + calibration.unit + " too");
    if (!unit.empty() || !(calibration.square > 0) || !(square > 0))       // a target of dots has no squares
        return;
    const double ratio = square/calibration.square;
    if ((ratio > OTHER_BOARD || ratio < 1./OTHER_BOARD) && isRatioOfUnits(ratio))
        throw Failure(format("the calibration's board has squares of %g %s, this one %g: another unit? Lengths are in the "
                             "calibration's. If the boards do differ so much, say --unit=", calibration.square,
                             calibration.unit.c_str(), square) + (calibration.unit.empty() ? "..." : calibration.unit));
}

} // namespace tools
