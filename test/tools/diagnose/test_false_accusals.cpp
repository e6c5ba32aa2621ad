// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

/* How often right images would be refused. A calibration is refused if a cause explains what would happen by chance once in 5e8 times,
which no simulation counts. So the tail of what the causes explain of right images is compared with that of chi^2, from probabilities p of
P0 on: if the law is chi^2, log(P0/p) is distributed exponentially with a mean of 1. Its mean, and how often p is below P0, give the rate
of refusals, extrapolated. One calibration is fitted; then values, targets and noise are drawn again and again, and what each cause
explains is found by the quick fit that starts from it. */
#include "diagnose/mistake_scenes.hpp"
#include "diagnose/causes.hpp"
#include "measure/distributions.hpp"

using namespace mistakes;

namespace {

const double P0 = 0.02;             // below PROMISING: all are known
const double REFUSED = 1e-4;        // of right images, at most

//! The values and targets of a rig drawn again, as they are known; its windows and cameras stay where they are.
Scene drawnAgain(const Scene& scene, scenes::Random& random)
{
    Scene again = scene;
    again.truth = scene.truth.clone();
    const GivenStd& std = scene.calibration.options.std;
    const GlassWindow& given = scene.calibration.options.window;
    const double outer = given.outerIndex + random.normal(std.outerIndex);
    for (Ptr<RefractiveCamera>& camera : again.truth.cameras)
    {
        GlassWindow nominal = camera->window();
        nominal.thickness = given.thickness;
        nominal.index = given.index;
        nominal.outerIndex = given.outerIndex;
        GlassWindow pane = drawnPane(nominal, std, random);
        pane.outerIndex = outer;
        camera->setWindow(pane);
    }
    again.truth = withVector(again.truth, toVector(again.truth));
    drawTarget(again.truth, std, random);
    again.throughWindow = again.truth.clone();
    return again;
}

//! New images of the same boards at the same places.
RigData seenAgain(const Scene& scene, const RigData& before, const std::vector<RigidTransform>& places, scenes::Random& random)
{
    RigData data = before;
    for (size_t i = 0; i < places.size(); i++)
    {
        const View view = look(scene, places[i], places[i], true, true, random);
        for (int c = 0; c < scene.cameras(); c++)
            for (bool glass : {false, true})
            {
                std::vector<Point2d>& pixels = (glass ? data.views[i].glass : data.views[i].direct)[c];
                const std::vector<Point2d>& seenNow = (glass ? view.glass : view.direct)[c];
                for (size_t p = 0; p < pixels.size(); p++)
                    if (seen(pixels[p]))
                        pixels[p] = seenNow.empty() || !seen(seenNow[p]) ? pixels[p] : seenNow[p];
            }
    }
    return data;
}

struct Tail
{
    int draws = 0, beyond = 0, causes = 0;
    double logs = 0., least = 1.;

    double mean() const { return beyond > 0 ? logs/beyond : 0.; }
    //! @param mean of log(P0/p)
    double refusals(double mean) const
    {
        return mean > 0. ? (double)beyond/draws*std::exp(-std::log(P0/CERTAIN)/mean) : 0.;
    }
};

Tail tailOf(RigKind kind, bool isHandHeld, int draws, unsigned salt)
{
    scenes::Random random(salt);
    Scene scene = makeScene(kind, random);
    scene.isHandHeld = isHandHeld;
    std::vector<RigidTransform> places;
    RigCalibration& c = scene.calibration;
    takeImages(scene, false, random, &places);
    calibrateImages(c, false, [] {});
    Tail tail;
    tail.causes = (int)causesOf(c.data, c.options, c.fit).size();
    for (; tail.draws < draws; tail.draws++)
    {
        const Scene again = drawnAgain(scene, random);
        for (const CauseTest& test : testCauses(seenAgain(again, c.data, places, random), c.options, c.fit))
        {
            const double p = upperTailChiSquared(test.parameters, test.deviance);
            tail.least = std::min(tail.least, p);
            if (!(p < P0))
                continue;
            tail.beyond++;
            tail.logs += std::log(P0/p);
        }
    }
    return tail;
}

void checkTails(int draws)
{
    std::cout << "seed " << scenes::seed() << '\n';
    const std::pair<RigKind, bool> rigs[] = {{ONE_IN_AIR, true}, {ONE_IN_AIR, false}, {STEREO_IN_AIR, true}, {STEREO_IN_WATER, false}};
    for (const auto& rig : rigs)
    {
        const Tail tail = tailOf(rig.first, rig.second, draws, 6500);
        // The mean of n exponential numbers is known to 1/sqrt(n), of its own size.
        const double most = tail.mean()*(1. + 2./std::sqrt((double)std::max(1, tail.beyond)));
        std::cout << format("[numbers] %s%s, right images, %d draws, %d causes: p < %.2g of %d (expected %.0f), mean of log(%.2g/p) "
                            "%.2f (expected 1), least p %.1g; refused, extrapolated: %.1g, at most %.1g",
                            RIG_NAMES[rig.first], rig.second ? ", hand-held" : "", tail.draws, tail.causes, P0, tail.beyond,
                            P0*tail.causes*tail.draws, P0, tail.mean(), tail.least, tail.refusals(tail.mean()), tail.refusals(most))
                  << std::endl;
        CAPTURE(RIG_NAMES[rig.first], rig.second);
        const double expected = P0*tail.causes*tail.draws;
        CHECK(tail.beyond > 0.4*expected - 4.);         // causes that are nearly one are found together: less spread is expected of
        CHECK(tail.beyond < 2.*expected + 10.);         // as many that are independent
        CHECK(tail.least > CERTAIN);
        CHECK(tail.refusals(most) < REFUSED);
    }
}

} // namespace

TEST_CASE("What causes explain of right images is distributed as it is taken to be: a few", "[mistakes][slow]") { checkTails(30); }

TEST_CASE("What causes explain of right images is distributed as it is taken to be: many", "[.monte-carlo][mistakes]")
{
    checkTails(scenes::trials(300));
}
