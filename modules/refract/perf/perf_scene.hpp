// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef __OPENCV_PERF_SCENE_HPP__
#define __OPENCV_PERF_SCENE_HPP__

#include "perf_precomp.hpp"

// Two cameras before one pane, in air or with water behind it.

namespace opencv_test { namespace {

enum { AIR, WATER };
CV_ENUM(Scene, AIR, WATER)

class Refract : public TestBaseWithParam<Scene>
{
protected:
    void SetUp() CV_OVERRIDE
    {
        TestBaseWithParam<Scene>::SetUp();
        const double outerIndex = GetParam() == WATER ? 1.333 : 1;
        const Matx33d K(2438, 0, 644, 0, 2438, 500, 0, 0, 1);
        const std::vector<double> D = { -0.4082, 0.4359, 0, 0, 0.1 };
        camera1 = RefractiveCamera::create(K, D, GlassWindow(Vec3d(-0.25, 0.1, 1), 20, 1.54, 50, outerIndex));
        camera2 = RefractiveCamera::create(K, D, GlassWindow(Vec3d(0.18, 0.03, 1), 20, 1.54, 40, outerIndex));
        rvec = Vec3d(0, 0.3, 0);
        tvec = Vec3d(-180, 0, 25);
    }

    //! Points in a grid 160 mm wide, 600 mm away.
    void makePoints(int count)
    {
        const int columns = cvRound(std::sqrt((double)count));
        for (int i = 0; i < count; i++)
            points.push_back(Point3d(160.*(i % columns)/columns - 80, 160.*(i/columns)/columns - 80, 600));
        refractiveProjectPoints(points, Vec3d(), Vec3d(), camera1, pixels1);
        refractiveProjectPoints(points, rvec, tvec, camera2, pixels2);
    }

    Ptr<RefractiveCamera> camera1, camera2;
    Vec3d rvec, tvec;
    std::vector<Point3d> points;
    std::vector<Point2d> pixels1, pixels2;
};

}} // namespace

#endif
