// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Measures on a plane with one camera behind a window: raw pixels -> where a camera without lens distortion and window
// would see them -> lengths. In an existing pipeline replace undistortPoints by refractiveUndistortPoints.
//
//   refractive_undistort_points [--calib=calib.yml --depth=600]

#include <opencv2/calib3d.hpp>
#include <opencv2/refract.hpp>
#include <iostream>

using namespace cv;

int main(int argc, char** argv)
{
    const CommandLineParser args(argc, argv,
        "{calib | samples/data/stereo/truth.yml | calibrated camera}"
        "{depth | 600 | z of the measured plane}");
    const Ptr<refract::RefractiveCamera> camera = refract::RefractiveCamera::read(args.get<String>("calib"));
    const Mat K = camera->cameraMatrix(), D = camera->distCoeffs();
    const double depth = args.get<double>("depth");

    // A bar of 156 mm on the plane, and its two ends in the raw image.
    const std::vector<Point3d> bar = { Point3d(-78, 20, depth), Point3d(78, 20, depth) };
    std::vector<Point2d> raw, ignored, corrected;
    refract::refractiveProjectPoints(bar, Vec3d(), Vec3d(), K, D, camera->window(), raw);

    undistortPoints(raw, ignored, K, D);                                                        // before
    refract::refractiveUndistortPoints(raw, corrected, K, D, camera->window(), Mat(1, 1, CV_64F, Scalar(depth)));  // after

    std::cout << "true length        156.000\n"
              << "window ignored     " << depth*norm(ignored[0] - ignored[1]) << "\n"
              << "window corrected   " << depth*norm(corrected[0] - corrected[1]) << std::endl;
    return 0;
}
