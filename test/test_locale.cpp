// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Numbers in files and options mean the same where people write a decimal comma.
#include "german.hpp"
#include "scenes.hpp"

#include <fstream>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

TEST_CASE("An mrcal .cameramodel is read whatever the locale", "[locale][camera]")
{
    const TemporaryFolder folder;
    std::ofstream(folder / "a.cameramodel") <<
        "{ 'lensmodel': 'LENSMODEL_OPENCV4', 'extrinsics': [0,0,0,0,0,0,], 'imagersize': [ 1280, 1024,],\n"
        "  'intrinsics': [ 2.3500e+03, 2351.25, 639.5, 511.5, -0.25, 1.25e-1, -5e-4, +.5, ], }";
    const German german;
    const Ptr<RefractiveCamera> camera = RefractiveCamera::read(folder / "a.cameramodel");
    CHECK(camera->imageSize() == Size(1280, 1024));
    const std::vector<double> expected = { 2350, 2351.25, 639.5, 511.5, -0.25, 0.125, -5e-4, 0.5 };
    CHECK(largestDifference(camera->lensParameters(), expected) == 0);
}

TEST_CASE("A camera is saved and read whatever the locale", "[locale][camera]")
{
    const std::string suffix = GENERATE(".yml", ".xml", ".json");
    const TemporaryFolder folder;
    const std::string path = folder/("camera" + suffix);
    const Ptr<RefractiveCamera> camera = makeCamera(lensNamed("the paper's"), GlassWindow(Vec3d(0.1, -0.05, 1), 20.5, 1.52, 31.7));
    {
        const German german;
        camera->save(path);
        CHECK(largestDifference(RefractiveCamera::read(path)->lensParameters(), camera->lensParameters()) == 0);
    }
    CHECK(largestDifference(RefractiveCamera::read(path)->lensParameters(), camera->lensParameters()) == 0);
    CHECK(RefractiveCamera::read(path)->window().thickness == camera->window().thickness);
}
