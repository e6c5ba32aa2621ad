// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The uncertainty budget: its rows against what each source does by itself.
#include "assess/budget.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/units.hpp"
#include "math/dense.hpp"
#include "measure/eigen_matrix.hpp"
#include "fitted_rig.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

const double SQUARE = 39.;

RigCalibration calibrated(const GivenStd& std) { return calibratedPairs(std, 1210, 0.1, SQUARE); }

const BudgetRow& rowOf(const std::vector<BudgetRow>& rows, const std::string& source)
{
    for (const BudgetRow& row : rows)
        if (row.source == source)
            return row;
    FAIL("no row " << source);
    return rows[0];
}

} // namespace

TEST_CASE("What a source is known to is a number of the unit that stands beside it", "[budget]")
{
    GivenStd std;
    std.thickness = 0.05;
    std.index = {Std(0.0007)};
    std.wedge = 2.*ARC_MINUTE;
    std.scale = 1e-4;
    RigCalibration c = calibrated(std);
    CHECK(c.fit.stdDeviations.rows == c.fit.covariance.rows);       // without the targets' scale
    int told = 0;
    for (const double square : {SQUARE, 0.})            // a board, and targets of points
    {
        c.square = square;
        for (const UncertaintySource& source : uncertaintySources(c))
            if (source.std > 0)
            {
                CAPTURE(source.name, source.given, source.std);
                CHECK(std::stod(source.given) == Approx(source.std).epsilon(0.06));     // two digits
                told++;
            }
    }
    CHECK(told == 2*(2*3 + 1));
}

TEST_CASE("The budget of a point adds up, and each source is worth what it does by itself", "[budget]")
{
    GivenStd std;
    // Better than the images could tell them: then each prior is the whole of its row.
    std.thickness = 0.005;
    std.scale = 1e-4;
    const RigCalibration c = calibrated(std), exact = calibrated(GivenStd());
    const std::vector<BudgetRow> rows = uncertaintyBudget(c), ofExact = uncertaintyBudget(exact);
    REQUIRE(rows.back().source == "total");
    double squares = 0., shares = 0.;
    for (const BudgetRow& row : rows)
        if (row.source != "total")
        {
            squares += row.effect*row.effect;
            shares += row.share;
        }
    CHECK(std::sqrt(squares) == Approx(rows.back().effect).epsilon(1e-9));
    CHECK(shares == Approx(1.).epsilon(1e-9));

    // All lengths are in proportion to the square: points at 500 to 750 mm.
    const BudgetRow& square = rowOf(rows, "square of the board");
    CHECK(square.given == "0.0039 mm");
    CHECK(square.effect > 0.05);
    CHECK(square.effect < 0.08);
    // What is not given exactly leaves the images' own part as it was.
    CHECK(rowOf(ofExact, "total").effect < rows.back().effect);
    CHECK(rowOf(rows, "noise of the calibration's images").effect
          == Approx(rowOf(ofExact, "noise of the calibration's images").effect).epsilon(0.2));
    CHECK(rowOf(rows, "noise of the point's own pixels").effect
          == Approx(rowOf(ofExact, "noise of the point's own pixels").effect).epsilon(0.1));
    CHECK(rowOf(rows, "thickness, camera 1").effect > 0.);
    CHECK(ofExact.size() == 3);
    CHECK(Std(192.4, "not given").text(" mm") == "190 mm (not given)");
}

TEST_CASE("Where a covariance was widened its sources are no more than all of it", "[budget]")
{
    GivenStd std;
    std.thickness = 0.1;
    std.index = {0.001};
    std.scale = 5e-4;
    RigCalibration c = calibrated(std);
    const auto left = [&] {         // the least part of a direction's variance that is noise
        MatrixXd rest = toEigen(c.fit.covariance);
        for (const UncertaintySource& source : uncertaintySources(c))
            rest -= product(toEigen(source.factor), toEigen(source.factor).transpose());
        const CorrelationSpectrum spectrum(toEigen(c.fit.covariance));
        const MatrixXd inverseRoot = spectrum.inverseRoot(spectrum.rank(1e-9));
        return SymmetricEigen(product(product(inverseRoot.transpose(), rest), inverseRoot)).values.minCoeff(); };
    CHECK(left() > -1e-6);
    // As a profile widens it: along a direction that a distance or a tilt has.
    const int at = columnsOf(c.fit.rig, 0).thickness;
    const Mat wide = 1.5*c.fit.withTargets.col(at)*c.fit.withTargets.row(at)/c.fit.withTargets.at<double>(at, at);
    c.fit.withTargets += wide;
    c.fit.covariance += wide(Rect(0, 0, c.fit.covariance.cols, c.fit.covariance.rows));
    CHECK(left() > -1e-6);
    CHECK(uncertaintyBudget(c).back().source == "total");
}
