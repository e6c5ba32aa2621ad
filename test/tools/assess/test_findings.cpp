// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What the verdict says of a window's distance that a fit stopped at, and of what the images do not show; the +- of a tilt.
#include "assess/findings.hpp"
#include "fitted_rig.hpp"
#include "programs/run_tool.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

//! Boards behind a wall of a tank, one camera before it, of which nothing is known but its lens and the wall's material.
RigCalibration calibratedTank(double distance, double nearest, unsigned seed)
{
    scenes::Random random(seed);
    const Matx33d K(8571, 0, 1151.5, 0, 8571, 859.5, 0, 0, 1);
    const auto camera = [&](const Vec3d& normal, double d) {
        const Ptr<RefractiveCamera> made = RefractiveCamera::create(K, noArray(), GlassWindow(normal, 4, 1.49, d, 1.33));
        made->setImageSize(Size(2304, 1720));
        return made;
    };
    RigModel truth, start;
    truth.add(camera(normalize(Vec3d(0.05, -0.1, 1)), distance), {});
    start.add(camera(Vec3d(0, 0, 1), 0), {});
    RigData data = dataOf(truth);
    for (int i = 0; i < 8; i++)
    {
        const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(nearest, nearest + 130));
        data.views.push_back(observe(truth, board(9, 6, 5), random.vector(0.4), tvec, false, 0.3, random));
    }
    RigCalibration c = fittedRig(start, data, 5, GLASS_FREE_DISTANCE);
    c.options.flags = GLASS_FREE_DISTANCE;
    c.baselines.throughGlass = {1.};        // px
    return c;
}

//! Whether one of a few such tanks makes the verdict say that.
bool isSaid(const std::string& what, double distance, double nearest)
{
    for (unsigned seed = 1; seed <= 3; seed++)
        for (const std::string& weak : findingsOf(calibratedTank(distance, nearest, seed), Assessment()).weak)
            if (mentions(weak, what))
                return true;
    return false;
}

} // namespace

TEST_CASE("The verdict says at which bound a window's distance ended", "[findings]")
{
    CHECK(isSaid("ended where a target touches it", 615, 640));
    CHECK(isSaid("ended at its bound, 0.0 +- ", 0, 400));
    CHECK_FALSE(isSaid("ended", 200, 650));
}

TEST_CASE("A camera that one view joins to the others is a weak point", "[findings]")
{
    RigCalibration c = calibratedPairs(GivenStd(), 11, 0.1, 39.);
    const auto says = [&] {
        const std::vector<std::string> weak = findingsOf(c, Assessment()).weak;
        return std::any_of(weak.begin(), weak.end(), [](const std::string& of) { return mentions(of, "only 'joint' is of other"); }); };
    c.baselines.throughGlass = {1., 1.};
    c.data.views[5].stem = "joint";
    CHECK_FALSE(says());
    for (size_t i = 0; i < c.data.views.size(); i++)
        if (i != 5)
        {
            View& view = c.data.views[i];
            view.direct[i % 2].clear();
            view.glass[i % 2].clear();
        }
    c.fit = fitImages(c.data, c.fit.rig, allViews(c.data), 0);
    c.residuals = residualsOf(c.data, c.fit);
    CHECK(says());
    c.options.flags |= GLASS_USE_POSES;         // each board is where it is said to be, and joins them
    CHECK_FALSE(says());
}

TEST_CASE("A tilt's +- is that of its angle", "[findings]")
{
    scenes::Random random(5);
    CAPTURE(scenes::seed());
    for (double tilt : {0., 0.02, 0.3, 0.9})
    {
        // Known better towards the axis than across it, or worse.
        for (const Vec2d& std : {Vec2d(0.002, 0.01), Vec2d(0.01, 0.002)})
        {
            const double azimuth = random.uniform(0, 6.28);
            const Vec3d to(std::cos(azimuth), std::sin(azimuth), 0), axis(0, 0, 1), across = axis.cross(to);
            const Vec3d normal = std::sin(tilt)*to + std::cos(tilt)*axis, along = std::cos(tilt)*to - std::sin(tilt)*axis;
            Fit fit;
            fit.rig.add(RefractiveCamera::create(Matx33d(900, 0, 500, 0, 900, 400, 0, 0, 1), noArray(), GlassWindow(normal, 20, 1.5)), {});
            const ParameterColumns at = columnsOf(fit.rig, 0);
            fit.covariance = Mat::zeros(columnCount(fit.rig), columnCount(fit.rig), CV_64F);
            Mat(std[0]*std[0]*along*along.t() + std[1]*std[1]*across*across.t()).copyTo(fit.covariance(Rect(at.normal, at.normal, 3, 3)));
            const double stated = tiltStdDegrees(fit, 0)*CV_PI/180;
            const int draws = 4000;
            int within = 0;
            for (int i = 0; i < draws; i++)
            {
                const Vec3d drawn = normalize(normal + random.normal(std[0])*along + random.normal(std[1])*across);
                within += std::abs(std::acos(std::min(1., drawn[2])) - tilt) < stated;
            }
            const double share = (double)within/draws;
            CAPTURE(tilt, std, share, stated);
            CHECK(share > 0.65);                            // 0.683 of a normal distribution
            CHECK(share < (tilt > 0.1 ? 0.72 : 0.8));
        }
    }
}
