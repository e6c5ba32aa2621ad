// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Decisions with a guard band: how often they are wrong; lines; what is read.
#include "acceptance_scene.hpp"
#include "accept/acceptance.hpp"
#include "console/failure.hpp"
#include "temporary_file.hpp"
#include <fstream>
#include <iostream>

using namespace acceptance_scene;

namespace {

const std::vector<Point3d> ENDS = {{-90, -60, 560}, {90, 50, 640}};

struct Rates
{
    int trials = 0, pass = 0, fail = 0, wrongFail = 0;      //!< wrongFail: of a rig that errs by exactly the limit
    double squares = 0.;            //!< of errors over their standard uncertainty

    double of(int count) const { return (double)count/trials; }
    //! Standard deviation of a rate with this probability.
    double scatter(double p) const { return std::sqrt(p*(1 - p)/trials); }
};

/** Rigs that are calibrated as well as they say, each with one length, whose true error of indication is so many limits.
@param limit in standard uncertainties of the error */
Rates simulate(double trueError, double limit, int trials, uint64_t seed)
{
    const Calibration calibration = calibrated();
    const TrueRigs rigs(calibration);
    const double U = 0.02, trueLength = norm(ENDS[1] - ENDS[0]);
    scenes::Random random(seed);
    const auto pointsOf = [&](const RigModel& rig, double sigma) {
        return testPoints(calibration, pixelsOf(rig, ENDS, sigma, random), SIGMA); };
    const TestPoints nominal = pointsOf(modelOf(calibration), 0.);
    const double u = PointErrors(calibration, nominal, SIGMA, std::nullopt).table(distanceOf(nominal, 0, 1), {{"", "", 0.5*U, 1.}}).u;
    const PermissibleError permitted(format("%.9f", limit*u));
    Rates rates;
    for (int i = 0; i < trials; i++)
    {
        const RigModel rig = rigs.draw(random);
        const TestPoints points = pointsOf(rig, SIGMA);
        // What the certificate says is off by its own error, and the rig by what no covariance contains.
        const double certified = trueLength + random.normal(0.5*U) - trueError*limit*u;
        const PointErrors errors(calibration, points, SIGMA, std::nullopt);
        const Acceptance a = testLengths(points, errors, {{"bar", {0, 1}, certified, U}}, permitted, TestVolume());
        // A failure is of what this rig errs by, its own calibration's error included: here by exactly the limit.
        const TestPoints exact = pointsOf(rig, 0.);
        const double own = norm(Vec3d(exact.points[1].X - exact.points[0].X)) - limit*u + random.normal(0.5*U);
        rates.wrongFail += testLengths(points, errors, {{"bar", {0, 1}, own, U}}, permitted, TestVolume()).decision() == Decision::FAIL;
        rates.trials++;
        rates.pass += a.decision() == Decision::PASS;
        rates.fail += a.decision() == Decision::FAIL;
        rates.squares += std::pow((a.lengths[0].error - trueError*limit*u)/a.lengths[0].budget.u, 2);
    }
    return rates;
}

//! P(z <= x) of a normal number.
double normalBelow(double x) { return 0.5*std::erfc(-x/std::sqrt(2.)); }

void testRates(int trials, uint64_t seed)
{
    const double LIMIT = 4.;
    std::cout << "seed " << seed << ", " << trials << " rigs\n";
    const Rates atLimit = simulate(1., LIMIT, trials, seed), right = simulate(0., LIMIT, trials, seed + 1);
    std::cout << format("[numbers] at the limit: wrong pass %.4f, fail %.4f; right: pass %.4f, fail %.4f; errors over u, RMS: %.4f\n",
                        atLimit.of(atLimit.pass), atLimit.of(atLimit.wrongFail), right.of(right.pass), right.of(right.fail),
                        std::sqrt((atLimit.squares + right.squares)/(2*trials)));
    const double tail = normalBelow(-2.), within = 2*normalBelow(LIMIT - 2.) - 1;       // as the guide states them
    CHECK(atLimit.of(atLimit.pass) <= 0.025 + 3*atLimit.scatter(0.025));
    CHECK(std::abs(atLimit.of(atLimit.pass) - tail) < 3*atLimit.scatter(tail));
    CHECK(std::abs(atLimit.of(atLimit.wrongFail) - tail) < 3*atLimit.scatter(tail));
    CHECK(std::abs(right.of(right.pass) - within) < 3*right.scatter(within));
    CHECK(right.fail <= right.trials/1000);         // 4 u_test: one in 16000, and no more than the rig may err by
    CHECK(std::sqrt((atLimit.squares + right.squares)/(2*trials)) == Approx(1.).margin(3/std::sqrt(4.*trials)));
}

//! Lengths between points on straight lines: five from the start of each.
Acceptance onLines(int lines, double longest)
{
    TestPoints points;
    std::vector<LengthResult> lengths;
    for (int line = 0; line < lines; line++)
    {
        const Vec3d start(20.*line, -10.*line, 500), along = normalize(Vec3d(1, 0.3*line, 0.2*line));
        points.points.push_back({"i", format("%d start", line), start, {}, {}, 0});
        const size_t first = points.points.size() - 1;
        for (int k = 1; k <= 5; k++)
        {
            points.points.push_back({"i", format("%d %d", line, k), start + longest*k/5*along, {}, {}, 0});
            lengths.push_back({{"l", {first, points.points.size() - 1}, longest*k/5, 0.01}, 0., 0., 1., GumTable(), Decision::PASS, false});
        }
    }
    return {points, PermissibleError("1"), lengths, TestVolume(CalibratedVolume{{-100, -100, 500}, {100, 100, 600}}), {}, {}, "mm", false};
}

} // namespace

TEST_CASE("A wrong pass at the limit is as rare as two standard uncertainties make it", "[acceptance]")
{
    testRates(scenes::trials(150), 1240);
}

TEST_CASE("A wrong pass at the limit is as rare as stated: many rigs", "[.monte-carlo][acceptance-many]")
{
    testRates(scenes::trials(1000), 1241);
}

TEST_CASE("The decision of ISO 14253-1 at its borders", "[acceptance]")
{
    CHECK(decide(0.07, 0.03, 0.03, 0.1) == Decision::PASS);
    CHECK(decide(-0.07, 0.03, 0.03, 0.1) == Decision::PASS);
    CHECK(decide(0.0701, 0.03, 0.03, 0.1) == Decision::UNDECIDED);
    CHECK(decide(-0.125, 0.03, 0.03, 0.1) == Decision::UNDECIDED);
    CHECK(decide(-0.1301, 0.03, 0.03, 0.1) == Decision::FAIL);
    CHECK(decide(0., 0.2, 0.01, 0.1) == Decision::UNDECIDED);   // U alone is too large
    CHECK(decide(0.15, 0.2, 0.01, 0.1) == Decision::FAIL);      // what is not known of the rig is no excuse
    CHECK(PermissibleError("0.05").of(1000.) == 0.05);
    CHECK(PermissibleError("0.05+L/1000").of(500.) == Approx(0.55));
    CHECK(PermissibleError("L/1000").of(500.) == Approx(0.5));
    for (const char* bad : {"", "-1", "0", "nan", "inf", "0.1+", "0.1+L", "0.1+L/0", "0.1+L/-5", "a+L/5", "L", "0.1-L/5", "0.1x",
                            "0.1+K/5"})
    {
        CAPTURE(bad);
        CHECK_THROWS_AS(PermissibleError(bad), Failure);
    }
}

TEST_CASE("Errors that share one scale are told, and those that do not are not", "[acceptance]")
{
    scenes::Random random(1242);
    const auto of = [&](double scale, double noise) {
        std::vector<LengthResult> lengths;
        for (int i = 0; i < 24; i++)
        {
            LengthResult r{{"l", {0, 1}, 150. + 5*i, 0.004}, 0., 0., 0.1, GumTable(), Decision::PASS, false};
            r.error = scale*r.length.length + random.normal(noise);
            r.budget.testU = 2*std::hypot(noise, 0.002);
            lengths.push_back(r);
        }
        return lengths;
    };
    const std::optional<CommonScale> scale = commonScale(of(1e-3, 0.01));
    REQUIRE(scale);
    CHECK(scale->value == Approx(1e-3).margin(4*scale->std));
    CHECK_THAT(scale->sentence("mm"), Catch::StartsWith("All errors share one scale, +0."));
    CHECK_THAT(scale->sentence("mm"), Catch::Contains("(24 of 24 have its sign): look at the square"));
    const std::optional<CommonScale> inch = commonScale(of(1/25.4 - 1, 0.01)), tenfold = commonScale(of(9., 0.01));
    REQUIRE(inch);
    REQUIRE(tenfold);
    CHECK_THAT(inch->sentence("inch"), Catch::Contains("are the certified lengths in mm?") && Catch::Contains("calibration, inch"));
    CHECK_THAT(inch->sentence(""), Catch::Contains("are the certified lengths in another unit?"));
    CHECK_THAT(tenfold->sentence("mm"), Catch::Contains("are the certified lengths in cm?"));
    CHECK_FALSE(commonScale(of(0., 0.01)));
    CHECK_FALSE(commonScale(of(1e-5, 0.01)));
}

TEST_CASE("Seven lines of five lengths make a whole test; what is missing is said", "[acceptance]")
{
    const double diagonal = 300.;           // of 200 x 200 x 100
    const Acceptance whole = onLines(7, 0.7*diagonal), six = onLines(6, 0.7*diagonal), brief = onLines(7, 0.6*diagonal);
    CHECK(measuringLines(whole).size() == 7);
    CHECK(missingOf(whole).empty());
    REQUIRE(missingOf(six).size() == 1);
    CHECK_THAT(missingOf(six)[0], Catch::Contains("6 of 7 measuring lines"));
    REQUIRE(missingOf(brief).size() == 1);
    CHECK_THAT(missingOf(brief)[0], Catch::Contains("0.6 of the diagonal of the calibrated volume, 300"));
    Acceptance unknown = whole;
    unknown.volume = TestVolume();
    CHECK(missingOf(unknown).size() == 1);
    Acceptance four = whole;                // a length twice is one
    four.lengths[1].length.length = four.lengths[0].length.length;
    CHECK_THAT(missingOf(four)[0], Catch::Contains("6 of 7 measuring lines"));
    Acceptance reaching = whole;            // a smaller volume does not make a test whole by what is not in it
    for (LengthResult& length : reaching.lengths)
        length.outside = length.length.length > 0.5*diagonal;
    REQUIRE(missingOf(reaching).size() == 2);
    CHECK_THAT(missingOf(reaching)[0], Catch::Contains("0 of 7 measuring lines"));
    CHECK_THAT(missingOf(reaching)[1], Catch::Contains("of the diagonal of the calibrated volume"));
}
