// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The ordinary OpenCV way from a pair of images to the depth of the scene. Its twin depth_of_scene_behind_glass.cpp is the same
// program for cameras behind windows (doc/drop_in.md).
//
//   depth_of_scene [--rig=rig.yml --left=left.jpg --right=right.jpg]

#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <iostream>
#if CV_VERSION_MAJOR >= 5
#include <opencv2/stereo.hpp>
#endif

using namespace cv;

//! Share of the pixels that have a point, and how well the points of the back wall lie on it.
static void report(const Mat& points, const Mat& R1, const FileNode& wall)
{
    Vec3d point, normal;
    wall["point"] >> point;
    wall["normal"] >> normal;
    normal /= norm(normal);
    const double NEAR = 20;
    double squares = 0;
    int found = 0, onWall = 0;
    for (const Vec3f& rectified : Mat_<Vec3f>(points))
    {
        const Vec3d X = Matx33d(R1).t()*Vec3d(rectified);
        const double distance = normal.dot(X - point);
        found += X[2] > 0 && X[2] < 2000;
        if (std::abs(distance) < NEAR)
        {
            squares += distance*distance;
            onWall++;
        }
    }
    std::cout << format("%.0f %% of the pixels have a point; %d are of the back wall, %.2f mm RMS from it",
                        100.*found/points.total(), onWall, std::sqrt(squares/onWall)) << std::endl;
}

int main(int argc, char** argv)
{
    const CommandLineParser args(argc, argv,
        "{rig   | samples/data/scene/rig.yml | cameras, R and T, and the scene}"
        "{left  | samples/data/scene/glass1/scene.jpg | image of camera 1}"
        "{right | samples/data/scene/glass2/scene.jpg | image of camera 2}"
        "{minDisparity | -112 | of the rectified images} {numDisparities | 272 | a multiple of 16}");
    const FileStorage file(args.get<String>("rig"), FileStorage::READ);
    const Mat left = imread(args.get<String>("left")), right = imread(args.get<String>("right"));
    const Mat K1 = file["camera1"]["camera_matrix"].mat(), D1 = file["camera1"]["distortion_coefficients"].mat();
    const Mat K2 = file["camera2"]["camera_matrix"].mat(), D2 = file["camera2"]["distortion_coefficients"].mat();
    const Mat R = file["R"].mat();
    Vec3d T;
    file["T"] >> T;
    const Size size = left.size();

    Mat R1, R2, P1, P2, Q, map11, map12, map21, map22, rectified1, rectified2, fixed, disparity, points;
    stereoRectify(K1, D1, K2, D2, size, R, T, R1, R2, P1, P2, Q, 0);
    const Ptr<StereoSGBM> matcher = StereoSGBM::create(args.get<int>("minDisparity"), args.get<int>("numDisparities"), 5, 200, 800, 1,
                                                       31, 10, 100, 2, StereoSGBM::MODE_SGBM_3WAY);
    initUndistortRectifyMap(K1, D1, R1, P1, size, CV_16SC2, map11, map12);
    initUndistortRectifyMap(K2, D2, R2, P2, size, CV_16SC2, map21, map22);
    remap(left, rectified1, map11, map12, INTER_LINEAR);
    remap(right, rectified2, map21, map22, INTER_LINEAR);
    matcher->compute(rectified1, rectified2, fixed);
    fixed.convertTo(disparity, CV_32F, 1./StereoMatcher::DISP_SCALE);
    reprojectImageTo3D(disparity, points, Q, true);
    report(points, R1, *file["scene"].begin());
    return 0;
}
