// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What is known of the normals of windows, from the command line into the fit.
#include "calibrate/image_fit.hpp"
#include "calibrate/starting_model.hpp"
#include "rig_scenes.hpp"

using namespace tools;
using cv::Mat;
using cv::Point3d;
using cv::Vec3d;
using namespace cv::refract;

namespace {

const double DEGREE = CV_PI/180;

//! A board in water in three places, and the options that tell of one camera's normal.
struct Scene
{
    Scene() : truth(scenes::makeRig(1, {0}, 1.333))
    {
        scenes::Random random(4520);
        const scenes::RigScene seen = scenes::makeRigScene(truth, scenes::ObjectViews(3, scenes::board()), random, 0.3);
        data.cameraCount = 1;
        data.imageSize[0] = cv::Size(1280, 1024);
        for (size_t view = 0; view < seen.object.size(); view++)
        {
            View own;
            own.stem = std::to_string(view);
            own.objectPoints = seen.object[view];
            own.glass[0] = seen.refracted[0][view];
            data.views.push_back(own);
        }
        options.window = truth.cameras[0]->window();
        options.flags = GLASS_FREE_DISTANCE;
        options.known[0] = RefractiveCamera::create(truth.cameras[0]->cameraMatrix(), truth.cameras[0]->distCoeffs());
        options.known[0]->setImageSize(data.imageSize[0]);
        options.knownCovariance[0] = Mat();
    }

    //! @param degrees 0: nothing is known
    Fit fit(const Vec3d& normal, double degrees)
    {
        options.normals = {normalize(normal)};
        options.std.normal = degrees*DEGREE;
        std::vector<LensSource> sources;
        const RigModel start = startModel(data, options, sources);
        return fitImages(data, start, {0, 1, 2}, options.flags, 300);
    }

    scenes::RigTruth truth;
    RigData data;
    RigOptions options;
};

} // namespace

TEST_CASE("A normal that is given with a deviation is estimated within it", "[given]")
{
    Scene s;
    const Vec3d true_ = s.truth.cameras[0]->window().normal;
    const Vec3d off = normalize(true_ + 0.5*DEGREE*normalize(true_.cross(Vec3d(0, 1, 0))));
    const Fit free = s.fit(off, 0), known = s.fit(off, 1e-3);
    const Vec3d n = known.rig.cameras[0]->window().normal;
    CHECK(std::acos(n.dot(off))/DEGREE < 0.02);
    CHECK(std::acos(std::min(1., free.rig.cameras[0]->window().normal.dot(true_)))/DEGREE < 0.3);
    // Two numbers more are known.
    CHECK(known.dof == free.dof + 2);
}

TEST_CASE("One normal is that of all cameras; of each camera its own", "[given]")
{
    RigOptions options;
    CHECK(options.windowOf(3).normal == GlassWindow().normal);
    options.normals = {Vec3d(0, 0, 1)};
    CHECK(options.windowOf(3).normal == Vec3d(0, 0, 1));
    options.normals = {Vec3d(0, 0, 1), Vec3d(0.6, 0, 0.8)};
    CHECK(options.windowOf(1).normal == Vec3d(0.6, 0, 0.8));
}
