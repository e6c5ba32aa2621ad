// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "boards.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;

namespace bench {

Boards::Boards(int views)
{
    std::mt19937_64 engine(11);
    std::uniform_real_distribution<double> angle(-0.4, 0.4), side(-30, 30), range(560, 660);
    std::normal_distribution<double> noise(0, 0.05);
    std::vector<Point3f> board;
    for (int i = 0; i < CORNERS; i++)
        board.push_back(Point3f(20.f*(i % 9 - 4), 20.f*(i/9 - 2.5f), 0));
    const Ptr<RefractiveCamera> bare = RefractiveCamera::create(scene.K, scene.D);
    for (int view = 0; view < views; view++)
    {
        const Vec3d rvec(angle(engine), angle(engine), angle(engine)), tvec(side(engine), side(engine), range(engine));
        std::vector<Point2f> through, without;
        refractiveProjectPoints(board, rvec, tvec, scene.camera, through);
        refractiveProjectPoints(board, rvec, tvec, bare, without);
        for (std::vector<Point2f>* pixels : { &through, &without })
            for (Point2f& p : *pixels)
                p += Point2f((float)noise(engine), (float)noise(engine));
        object.push_back(board);
        refracted.push_back(through);
        direct.push_back(without);
    }
}

Ptr<RefractiveCamera> Boards::startCamera() const
{
    GlassWindow window = scene.window;
    window.normal = Vec3d(0, 0, 1);
    return RefractiveCamera::create(scene.K, scene.D, window);
}

void Boards::calibrateGlass(int flags) const
{
    std::vector<Mat> rvecs, tvecs;
    refract::calibrateGlass(object, direct, refracted, startCamera(), rvecs, tvecs, flags);
}

double Boards::normalError(int flags) const
{
    const Ptr<RefractiveCamera> camera = startCamera();
    std::vector<Mat> rvecs, tvecs;
    Mat deviations;
    refract::calibrateGlass(object, direct, refracted, camera, rvecs, tvecs, deviations, noArray(), noArray(),
                            noArray(), flags);
    const int first = (int)camera->lensParameters().total();
    return norm(camera->window().normal - normalize(scene.window.normal))/norm(deviations.rowRange(first, first + 3));
}

void Boards::calibrateCamera() const
{
    Mat K, D;
    std::vector<Mat> rvecs, tvecs;
    cv::calibrateCamera(object, direct, Size((int)WIDTH, (int)HEIGHT), K, D, rvecs, tvecs);
}

void Boards::calibrateNormal() const
{
    Mat normal;
    calibrateGlassNormal(direct, refracted, scene.K, scene.D, normal);
}

} // namespace bench
