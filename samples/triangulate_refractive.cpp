// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Points seen by two cameras behind two windows -> 3-D points. In an existing pipeline replace undistortPoints and
// triangulatePoints by triangulateRefractive.
//
//   triangulate_refractive [--calib=calib.yml --left=left.jpg --right=right.jpg --cols=6 --rows=5 --square=39]

#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/refract.hpp>
#include <iostream>

using namespace cv;

static std::vector<Point2f> findCorners(const String& filename, Size size)
{
    std::vector<Point2f> corners;
    const Mat image = imread(filename, IMREAD_GRAYSCALE);
    if (image.empty() || !findChessboardCornersSB(image, size, corners, CALIB_CB_EXHAUSTIVE | CALIB_CB_ACCURACY))
        CV_Error(Error::StsError, "no chessboard found in " + filename);
    return corners;
}

//! RMS error of the lengths of the squares in a row.
static double lengthError(const std::vector<Point3d>& points, int cols, double square)
{
    double sum = 0;
    int count = 0;
    for (size_t i = 1; i < points.size(); i++)
        if (i % cols)
        {
            const double error = norm(points[i] - points[i - 1]) - square;
            sum += error*error;
            count++;
        }
    return std::sqrt(sum/count);
}

int main(int argc, char** argv)
{
    const CommandLineParser args(argc, argv,
        "{calib | samples/data/stereo/truth.yml | calibrated stereo rig}"
        "{left  | samples/data/stereo/measure1/z600_1.jpg | image of camera 1}"
        "{right | samples/data/stereo/measure2/z600_1.jpg | image of camera 2}"
        "{cols  | 6 | inner corners in a row} {rows | 5 | inner corners in a column} {square | 39 | side of a square}");
    const String filename = args.get<String>("calib");
    std::vector<Ptr<refract::RefractiveCamera> > cameras;
    std::vector<Mat> Rs, Ts;                // camera 1 -> each camera
    refract::readRig(filename, cameras, Rs, Ts);
    if (cameras.size() < 2)
        CV_Error(Error::StsError, filename + " has only one camera");
    const Ptr<refract::RefractiveCamera> camera1 = cameras[0], camera2 = cameras[1];
    const Mat R = Rs[1], T = Ts[1];

    const Size size(args.get<int>("cols"), args.get<int>("rows"));
    const std::vector<Point2f> left = findCorners(args.get<String>("left"), size);
    const std::vector<Point2f> right = findCorners(args.get<String>("right"), size);

    std::vector<Point3d> points, ignored;
    std::vector<uchar> status;
    refract::triangulateRefractive(camera1, camera2, R, T, left, right, points, status);

    // The same cameras with their windows forgotten.
    const refract::GlassWindow none;
    refract::triangulateRefractive(camera1->cameraMatrix(), camera1->distCoeffs(), none,
                                   camera2->cameraMatrix(), camera2->distCoeffs(), none,
                                   R, T, left, right, ignored, status);

    const double square = args.get<double>("square");
    std::cout << points.size() << " points; RMS error of the squares' sides: window ignored "
              << lengthError(ignored, size.width, square) << ", corrected "
              << lengthError(points, size.width, square) << std::endl;
    return 0;
}
