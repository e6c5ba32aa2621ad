// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A target that was moved between the images of a view.
#include "problem_scenes.hpp"
#include "adjust/moved_images.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const double SIGMA = 0.1;

RigTruth camerasOf(int count)
{
    RigTruth truth = paperStereo();
    truth.cameras.resize(count);
    truth.windows.resize(count);
    truth.Rs.resize(count);
    truth.Ts.resize(count);
    return truth;
}

//! One image again, of a target that was shifted (camera 1).
void shift(const RigTruth& truth, RigScene& scene, int camera, int view, bool refracted, const Vec3d& by, Random& random)
{
    Matx33d R;
    Vec3d rvec;
    Rodrigues(scene.rvecs[view], R);
    Rodrigues(truth.Rs[camera]*R, rvec);
    const Vec3d tvec = truth.Rs[camera]*(scene.tvecs[view] + by) + truth.Ts[camera];
    const Ptr<RefractiveCamera> seenBy = truth.cameras[camera]->clone();
    if (!refracted)
        seenBy->setWindow(GlassWindow());
    (refracted ? scene.refracted : scene.direct)[camera][view] = seen(scene.object[view], rvec, tvec, seenBy, random, SIGMA);
}

//! "camera 1 view 3 direct" of each image that was found to be moved.
std::vector<std::string> movedImages(Problem& problem)
{
    std::vector<std::string> names;
    for (const int i : findMovedImages(problem, SIGMA))
    {
        const Image& image = problem.images()[i];
        names.push_back(format("camera %d view %d %s", image.camera + 1, image.view, image.refracted ? "glass" : "direct"));
    }
    return names;
}

typedef std::vector<std::string> Names;

} // namespace

TEST_CASE("Where nothing moved, no image is taken for moved", "[moved_images]")
{
    for (int i = 0; i < 20; i++)
    {
        Random random(800 + i);
        CAPTURE(seed(), i);
        const RigTruth truth = camerasOf(1 + i % 2);
        const RigScene scene = makeRigScene(truth, 5, random, SIGMA);
        CHECK(movedImages(*problemAt(truth, scene, true, 0)) == Names());
    }
}

TEST_CASE("Of a pair that was moved the image through the window stays, and the view's pose is its own", "[moved_images]")
{
    Random random(830);
    CAPTURE(seed());
    const RigTruth truth = camerasOf(1);
    RigScene scene = makeRigScene(truth, 5, random, SIGMA);
    const Vec3d by(2, -1, 0);
    shift(truth, scene, 0, 3, true, by, random);
    const std::unique_ptr<Problem> problem = problemAt(truth, scene, true, 0);
    CHECK(movedImages(*problem) == Names{ "camera 1 view 3 direct" });
    CHECK(norm(problem->pose(3).tvec - (scene.tvecs[3] + by)) < 1);
    CHECK(problem->pose(2).tvec == scene.tvecs[2]);
}

TEST_CASE("Of several images the one that moved is found", "[moved_images]")
{
    Random random(840);
    CAPTURE(seed());
    const RigTruth truth = camerasOf(2);
    for (const bool refracted : { false, true })
        for (int camera = 0; camera < 2; camera++)
        {
            RigScene scene = makeRigScene(truth, 5, random, SIGMA);
            shift(truth, scene, camera, 1, refracted, Vec3d(2, 1, 3), random);
            CHECK(movedImages(*problemAt(truth, scene, true, 0)) ==
                  Names{ format("camera %d view 1 %s", camera + 1, refracted ? "glass" : "direct") });
        }
}

TEST_CASE("A target that lies quite elsewhere is found, one that moved less than shows is not", "[moved_images]")
{
    Random random(850);
    CAPTURE(seed());
    const RigTruth truth = camerasOf(1);
    RigScene far = makeRigScene(truth, 5, random, SIGMA), near = far;
    shift(truth, far, 0, 0, false, Vec3d(60, 40, 500), random);
    CHECK(movedImages(*problemAt(truth, far, true, 0)) == Names{ "camera 1 view 0 direct" });
    shift(truth, near, 0, 0, false, Vec3d(0.001, 0, 0), random);
    CHECK(movedImages(*problemAt(truth, near, true, 0)) == Names());
}

TEST_CASE("Nothing is moved where nothing tells: too few pairs, single images, all views alike", "[moved_images]")
{
    Random random(860);
    CAPTURE(seed());
    const RigTruth truth = camerasOf(1);
    RigScene few = makeRigScene(truth, 2, random, SIGMA);
    shift(truth, few, 0, 1, false, Vec3d(2, 1, 3), random);
    CHECK(movedImages(*problemAt(truth, few, true, 0)) == Names());

    RigScene single = makeRigScene(truth, 5, random, SIGMA);
    shift(truth, single, 0, 1, true, Vec3d(2, 1, 3), random);
    CHECK(movedImages(*problemAt(truth, single, false, 0)) == Names());

    RigScene all = makeRigScene(truth, 5, random, SIGMA);       // a wrong constant moves them all
    for (int view = 0; view < 5; view++)
        shift(truth, all, 0, view, false, Vec3d(1, 0, 0), random);
    CHECK(movedImages(*problemAt(truth, all, true, 0)) == Names());
}
