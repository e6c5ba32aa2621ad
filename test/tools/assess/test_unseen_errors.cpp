// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A given value that was wrong in the calibration and still is: does a check show as little of it as it says?
#include "check_scenes.hpp"
#include "measure/distributions.hpp"

using namespace check_scenes;

namespace {

const double FALSE_ALARM = 0.01;

struct Given
{
    std::string name;
    int column;
    double std, error;
};

//! As a calibration file has it: C W^(1/2).
UncertaintySource sourceOf(const Calibrated& c, const Given& given)
{
    const MatrixXd factor = c.covariance.col(given.column).head(columnCount(c.truth))/given.std;
    return {given.name, "1 mm", given.name == SCALE_OF_TARGETS ? 100.*given.std : given.std, toMat(factor)};
}

//! What new images without noise contradict of a calibration.
double contradiction(const Scene& scene, const Calibrated& c, unsigned seed)
{
    scenes::Random random(seed);
    return CheckProblem(c.input, newViews(scene, c.truth, random, 1e-9), c.input.sigma).fitUnchanged().chiSquare;
}

} // namespace

TEST_CASE("A check shows as little as it says of what was wrong in the calibration already", "[rig_check]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const int cameras = GENERATE(1, 2);
    const double outerIndex = GENERATE(1., 1.333);
    const Scene nominal = makeScene("", cameras, false, outerIndex);
    const int scale = columnCount(nominal.nominal), thickness = columnsOf(nominal.nominal, 0).thickness;
    bool isShown[2] = {};           // in air a thickness that was known well is not absorbed
    for (const Given& given : {Given{SCALE_OF_TARGETS, scale, 0.0005, 0.05}, Given{"thickness, camera 1", thickness, 0.1, 2.},
                               Given{"thickness, camera 1", thickness, 0.01, 1.}})
    {
        CAPTURE(cameras, outerIndex, given.name, given.std);
        Scene scene = nominal;
        scene.prior(given.column, given.column) = given.std*given.std;
        scenes::Random random(6100), same(6100), images(6101);
        Calibrated right = calibrated(scene, random);
        const Calibrated wrong = calibrated(scene, same, [&](RigModel& rig) {
            VectorXd p = parametersOf(rig);
            p[given.column] += given.error;
            setParameters(rig, p); });
        right.input.sources = {sourceOf(right, given)};
        const CheckResult result = checkRig(right.input, newViews(scene, right.truth, images), FALSE_ALARM);
        REQUIRE(result.unseen.size() == 1);
        const UnseenError unseen = result.unseen[0];
        CHECK(unseen.of == given.name.substr(0, given.name.find(',')));
        CHECK(unseen.isOfTarget == (given.column == scale));
        CHECK(unseen.unit == "mm");
        const double shown = contradiction(scene, wrong, 6102) - contradiction(scene, right, 6102);
        const double times = (given.column == scale ? 100. : 1.)*given.error/unseen.least;
        const auto power = [&](double lambda) {
            return upperTailNoncentralF(1, result.dof, lambda, quantileF(1, result.dof, result.critical)); };
        CAPTURE(shown, times);
        CHECK((times < 1. ? power(shown) < CERTAIN_POWER : power(shown) > CERTAIN_POWER));
        if (times > 2.)
            CHECK(power(shown/(times*times)) == Approx(CERTAIN_POWER).margin(0.15));
        isShown[given.std == 0.01] |= times > 2.;
    }
    CHECK_FALSE(isShown[0]);
    CHECK(isShown[1] == (outerIndex == 1.));
}
