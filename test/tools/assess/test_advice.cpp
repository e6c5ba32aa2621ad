// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What the next images would bring, where a part of the near plane lies before the window.
#include "assess/advice.hpp"
#include "fitted_rig.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;

TEST_CASE("No image is advised where a board would be before the window", "[advice]")
{
    scenes::Random random(1310);
    RigModel rig = paperRig(1);
    rig.cameras[0]->setWindow(GlassWindow(Vec3d(1.732, 0, 1), 5, 1.5, 60));      // near at the right edge, far at the left one
    const double square = 3;
    RigData data = dataOf(rig);
    for (int i = 0; i < 8; i++)
    {
        const Vec3d tvec(random.uniform(6, 10), random.uniform(-8, 2), random.uniform(128, 145)), rvec = random.vector(0.15);
        data.views.push_back(observe(rig, board(6, 5, square), rvec, tvec, true, 0.1, random));
    }
    const RigCalibration c = fittedRig(rig, data, square);

    const double near = workingDepth(c, 0)[0];
    std::vector<Point3d> left;
    refractivePointsOnPlane(std::vector<Point2d>{{0.3*1280, 512}}, left, c.fit.rig.cameras[0], Vec4d(0, 0, 1, near));
    CAPTURE(near);
    REQUIRE(std::isnan(left[0].x));
    const Advice advice = adviseImages(c);
    CHECK_FALSE(advice.pairs.empty());
    for (const PlannedImage& image : advice.pairs)
        CHECK(image.quality.placeStd[0] <= advice.now.placeStd[0]);
}
