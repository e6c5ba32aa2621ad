// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

// Two cameras behind tilted panes measure a bar of 100 mm: the panes ignored, and taken into account. Then the first pane is
// calibrated. Needs no images.

#include <opencv2/refract.hpp>
#include <iostream>

using namespace cv;

int main()
{
    //! [rig]
    const Matx33d K(2400, 0, 640, 0, 2400, 512, 0, 0, 1);
    const Vec4d D(-0.2, 0.1, 0, 0);
    const refract::GlassWindow window1(Vec3d(-0.25, 0.10, 1), 20, 1.54, 50);    // normal, thickness, index, distance
    const refract::GlassWindow window2(Vec3d(0.18, 0.03, 1), 20, 1.54, 40);
    const Ptr<refract::RefractiveCamera> camera1 = refract::RefractiveCamera::create(K, D, window1);
    const Ptr<refract::RefractiveCamera> camera2 = refract::RefractiveCamera::create(K, D, window2);
    const Vec3d R(0, 0.3, 0), T(-180, 0, 25);                                   // camera 1 -> camera 2
    //! [rig]

    //! [project]
    const std::vector<Point3d> bar = { Point3d(-50, 20, 600), Point3d(50, 20, 600) };
    std::vector<Point2d> pixels1, pixels2;
    refract::refractiveProjectPoints(bar, Vec3d(), Vec3d(), camera1, pixels1);
    refract::refractiveProjectPoints(bar, R, T, camera2, pixels2);
    //! [project]

    //! [triangulate]
    std::vector<Point3d> points, ignored;
    std::vector<uchar> status;
    refract::triangulateRefractive(camera1, camera2, R, T, pixels1, pixels2, points, status);
    if (status[0] != refract::REFRACT_OK || status[1] != refract::REFRACT_OK)
        return 1;
    //! [triangulate]

    const refract::GlassWindow none;
    refract::triangulateRefractive(K, D, none, K, D, none, R, T, pixels1, pixels2, ignored);
    std::cout << "true length   100\n"
              << "panes ignored " << norm(ignored[0] - ignored[1]) << ", the bar off by "
              << norm(ignored[0] - bar[0]) << "\n"
              << "corrected     " << norm(points[0] - points[1]) << std::endl;

    //! [pairs]
    std::vector<Point3f> board;
    for (int i = 0; i < 54; i++)
        board.push_back(Point3f(20.f*(i % 9) - 80, 20.f*(i/9) - 50, 0));
    const Vec3d tilts[] = { Vec3d(0.4, 0, 0), Vec3d(-0.4, 0, 0.2), Vec3d(0, 0.4, 0), Vec3d(0, -0.4, -0.2) };
    const Ptr<refract::RefractiveCamera> withoutWindow = refract::RefractiveCamera::create(K, D);
    std::vector<std::vector<Point3f> > boards(4, board);
    std::vector<std::vector<Point2f> > direct(4), refracted(4);
    RNG random(1);
    for (int pair = 0; pair < 4; pair++)
    {
        refract::refractiveProjectPoints(board, tilts[pair], Vec3d(0, 0, 550 + 30*pair), withoutWindow, direct[pair]);
        refract::refractiveProjectPoints(board, tilts[pair], Vec3d(0, 0, 550 + 30*pair), camera1, refracted[pair]);
        for (size_t i = 0; i < board.size(); i++)
        {
            direct[pair][i] += Point2f((float)random.gaussian(0.1), (float)random.gaussian(0.1));
            refracted[pair][i] += Point2f((float)random.gaussian(0.1), (float)random.gaussian(0.1));
        }
    }
    //! [pairs]

    //! [calibrate]
    refract::GlassWindow window(Vec3d(0, 0, 1), 20, 1.54, 50);      // how it is tilted is not known
    std::vector<Mat> rvecs, tvecs;
    const double rms = refract::calibrateGlass(boards, direct, refracted, K, D, window, rvecs, tvecs);
    //! [calibrate]
    std::cout << "true normal   " << window1.normal << "\n"
              << "calibrated    " << window.normal << ", " << rms << " px RMS" << std::endl;
    return std::abs(norm(points[0] - points[1]) - 100) < 1e-6 && norm(window.normal - window1.normal) < 1e-3 ? 0 : 1;
}
