// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The window's normal from one pair of images of an unmoved chessboard, without and with the window.
//
//   calibrate_glass_normal [--camera=camera.yml --direct=direct.jpg --glass=glass.jpg --cols=6 --rows=5]

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

int main(int argc, char** argv)
{
    const CommandLineParser args(argc, argv,
        "{camera | samples/data/stereo/truth.yml     | lens: camera_matrix, distortion_coefficients}"
        "{direct | samples/data/stereo/direct1/pair1.jpg | image without the window}"
        "{glass  | samples/data/stereo/glass1/pair1.jpg  | image through the window, board not moved}"
        "{cols   | 6 | inner corners in a row} {rows | 5 | inner corners in a column}");
    const Size size(args.get<int>("cols"), args.get<int>("rows"));
    const Ptr<refract::RefractiveCamera> camera = refract::RefractiveCamera::read(args.get<String>("camera"));

    const std::vector<std::vector<Point2f>> direct(1, findCorners(args.get<String>("direct"), size));
    const std::vector<std::vector<Point2f>> glass(1, findCorners(args.get<String>("glass"), size));

    Vec3d normal;
    Vec2d center;
    Matx33d covariance;
    const double rms = refract::calibrateGlassNormal(direct, glass, camera->cameraMatrix(), camera->distCoeffs(),
                                                     normal, center, covariance);

    std::cout << "normal " << normal << ", +- " << std::sqrt(trace(covariance)/2)*180/CV_PI << " degrees per axis\n"
              << "distortion centre " << center << " px, RMS " << rms << " px\n"
              << "off the truth by " << std::acos(std::min(1., normal.dot(camera->window().normal)))*180/CV_PI
              << " degrees: this pane has a wedge of 2 arc minutes, which looks like a tilt; refract_calib knows that" << std::endl;
    return 0;
}
