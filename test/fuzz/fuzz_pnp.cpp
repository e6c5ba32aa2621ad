// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "harness.hpp"
#include "scenes.hpp"

// The pose of a known target.

using namespace cv::refract;
using namespace fuzz;

void fuzz::tryInput(Bytes& bytes)
{
    Input objects, points;
    cv::Mat rvec, tvec;
    cv::Ptr<RefractiveCamera> camera;
    if (bytes.maybe())          // a scene that there could be
    {
        const Scene scene(bytes);
        if (scene.objectPoints.empty())
            return;
        const auto& X = scene.objectPoints[0];
        const auto& x = scene.refracted[0][0];
        size_t i = 0, j = 0;
        objects = Input::items(bytes, (int)X.size(), 3, [&](int c) { const double v = (&X[i].x)[c]; i += c == 2; return v; });
        points = Input::items(bytes, (int)x.size(), 2, [&](int c) { const double v = (&x[j].x)[c]; j += c == 1; return v; });
        camera = scene.cameras[0];
        rvec = scene.rvecs[0];
        tvec = scene.tvecs[0];
    }
    else
    {
        const int count = countOf(bytes);
        objects = objectPoints(bytes, count, bytes.maybe());
        points = pixels(bytes, bytes.rarely() ? countOf(bytes) : count);
        camera = cameraOf(bytes);
        rvec = rotation(bytes, 3).mat();
        tvec = translation(bytes, 200, 500).mat();
    }
    const bool guess = bytes.maybe();
    bool found;
    cv::Mat error;
    if (bytes.maybe())
    {
        const Lens lens(bytes);
        found = refractiveSolvePnP(objects, points, lens.cameraMatrix, lens.distCoeffs, lens.window, rvec, tvec, guess, error);
    }
    else
        found = refractiveSolvePnP(objects, points, camera, rvec, tvec, guess, error);
    promise(!found || (rvec.total() == 3 && tvec.total() == 3), "a pose has six numbers");
    promise(!found || (cv::checkRange(rvec) && cv::checkRange(tvec) && cv::checkRange(error)), "a pose is finite");
}
