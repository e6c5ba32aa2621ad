// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The search for the best of several minima: successive halving, and from the best to its neighbours.
#include "refit_call.hpp"
#include "start/multi_start.hpp"
#include "start/shared_window.hpp"
#include "window/place.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const double SIGMA = 0.1;

//! A camera of known lens that saw boards through its window alone.
struct Search
{
    Search(int count, unsigned seed)
    {
        Random random(seed);
        RigTruth truth = makeRig(1, { 0 }, 1);
        truth.cameras[0]->setWindow(makeWindow(PANE_IN_AIR, random));
        const RigScene scene = makeRigScene(truth, count, random, SIGMA);
        views.object = scene.object;
        views.cameras.push_back({ scenes::PixelViews(count), scene.refracted[0] });
        const RigStart given = { { { static_cast<const Camera&>(*truth.cameras[0]) }, { 0 }, { Pose() } }, {} };
        for (const WindowPlace& place : placesAround(given.rig.cameras[0].window(), 0.4, 8, 0))
        {
            tilts.push_back(given);
            REQUIRE(setPlace(tilts.back().rig, 0, place));
        }
    }

    RigViews views;
    std::vector<RigStart> tilts;
};

Vec3d normalOf(const Minimum& minimum) { return minimum.rig.cameras[0].layers().normal(); }

} // namespace

TEST_CASE("A search ends in distinct minima, the best first; a stage keeps what it is told to", "[search]")
{
    const Search search(1, 3701);
    const std::vector<Minimum> minima = multiStart(search.tilts, { { ALL_VIEWS, FINE } }, search.views, 0);
    REQUIRE(minima.size() >= 2);
    REQUIRE(minima.size() < search.tilts.size());
    for (size_t i = 1; i < minima.size(); i++)
    {
        CHECK(minima[i - 1].cost <= minima[i].cost);
        for (size_t k = 0; k < i; k++)
            CHECK(norm(normalOf(minima[i]) - normalOf(minima[k])) > 0.5*SAME_ANGLE);
    }
    Stage one = { ALL_VIEWS, FINE, 1 };
    CHECK(keptMinima(minima, one).size() == 1);
    CHECK(multiStart(search.tilts, { one }, search.views, 0)[0].cost == minima[0].cost);

    std::vector<OtherMinimum> others(1);
    describeOther(minima, others);
    CHECK(others[0].excess == Approx(std::sqrt((minima[1].cost/minima[0].cost - 1)*minima[0].freedom)));
    CHECK(norm(others[0].window.normal - minima[1].rig.cameras[0].window().normal) == 0);
    Stage plausible = { ALL_VIEWS, FINE };
    plausible.maxExcess = 0.99*others[0].excess;
    CHECK(keptMinima(minima, plausible).size() == 1);
    plausible.maxExcess = 1.01*others[0].excess;
    CHECK(keptMinima(minima, plausible).size() >= 2);
}

TEST_CASE("From the second best minimum a neighbour leads to the best", "[search]")
{
    const Search search(1, 3701);
    const std::vector<Minimum> minima = multiStart(search.tilts, { { ALL_VIEWS, FINE } }, search.views, 0);
    REQUIRE(minima.size() >= 2);
    const std::vector<Minimum> second(1, minima[1]);
    int rounds = 0;
    const auto toBest = [&](const Minimum&) { rounds++; return std::vector<RigStart>(1, minima[0].start); };
    const std::vector<Minimum> climbed = hillClimb(second, toBest, search.views, 0);
    CHECK(climbed[0].cost == minima[0].cost);
    CHECK(climbed.size() == 3);
    CHECK(rounds == 2);         // the second finds nothing better
    const auto nowhere = [](const Minimum&) { return std::vector<RigStart>(); };
    CHECK(hillClimb(second, nowhere, search.views, 0)[0].cost == minima[1].cost);
}

TEST_CASE("Stages of a search see more and more of the views", "[search]")
{
    const Search search(7, 3720);
    const Stage few = { 3, COARSE, 2 }, all = { ALL_VIEWS, FINE };
    const std::vector<Minimum> coarse = multiStart(search.tilts, { few }, search.views, 0);
    const std::vector<Minimum> fine = multiStart(search.tilts, { few, all }, search.views, 0);
    REQUIRE(!coarse.empty());
    REQUIRE(!fine.empty());
    CHECK(coarse.size() <= 2);
    CHECK(coarse[0].poses.size() == 3);
    CHECK(fine[0].poses.size() == 7);
    const int points = (int)search.views.object[0].size();
    CHECK(fine[0].freedom - coarse[0].freedom == 4*(2*points - 6));
    CHECK(fine[0].converged);
    CHECK(std::sqrt(fine[0].cost/fine[0].freedom) == Approx(SIGMA).epsilon(0.1));
    for (const Minimum& minimum : fine)         // each begins where one of the stage before has ended
        CHECK(std::any_of(coarse.begin(), coarse.end(), [&](const Minimum& before)
                          { return normalOf(before) == minimum.start.rig.cameras[0].layers().normal(); }));

    const RigViews picked = pick(search.views, { 4, 1 });
    CHECK(picked.count() == 2);
    CHECK(picked.object[0] == search.views.object[4]);
    CHECK(picked.cameras[0].refracted[1] == search.views.cameras[0].refracted[1]);
}

//! A camera that saw one board through its window: of some draws, which differ by the compiler, another minimum is plausible, too.
static RigCall callWithOtherMinimum(double& rms)
{
    for (unsigned salt = 3701; salt < 3721; salt++)
    {
        Random random(salt);
        RigTruth truth = makeRig(1, { 0 }, 1);
        truth.cameras[0]->setWindow(makeWindow(PANE_IN_AIR, random));
        RigCall call(truth, makeRigScene(truth, 1, random, SIGMA), false);
        rms = call.run(0);
        if (std::isfinite(call.otherMinima.at<double>(3)))
            return call;
    }
    throw std::runtime_error("no draw has another minimum");
}

TEST_CASE("A fit from an earlier one looks for no other minimum, unless it has to", "[search]")
{
    CAPTURE(seed());
    double rms;
    RigCall call = callWithOtherMinimum(rms);
    const GlassWindow best = call.cameras[0]->window();
    GlassWindow other = best;
    other.normal = Vec3d(call.otherMinima.ptr<double>());

    CHECK_THROWS_WITH(call.run(FROM_EARLIER_FIT), Catch::Contains("flags is 1073741824"));
    const auto fitFrom = [&](const GlassWindow& window)
    {
        call.cameras[0]->setWindow(window);
        return refit(call, 0);
    };
    CHECK(fitFrom(best) == Approx(rms).epsilon(1e-9));
    CHECK(norm(call.cameras[0]->window().normal - best.normal) < 1e-6);
    CHECK(std::isnan(call.otherMinima.at<double>(3)));
    CHECK(fitFrom(other) > 1.0001*rms);
    CHECK(norm(call.cameras[0]->window().normal - other.normal) < 1e-4);
    GlassWindow nowhere = best;
    nowhere.normal = normalize(Vec3d(1, 0, 0.02));      // which the board is not behind
    CHECK(fitFrom(nowhere) == Approx(rms).epsilon(1e-9));
    CHECK(std::isfinite(call.otherMinima.at<double>(3)));
}
