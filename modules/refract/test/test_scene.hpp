// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef __OPENCV_TEST_SCENE_HPP__
#define __OPENCV_TEST_SCENE_HPP__

#include "test_precomp.hpp"

// Two cameras behind tilted panes 20 mm thick, as in table 3 of the paper, and boards at 600 mm.

namespace opencv_test { namespace scene {

const double NaN = std::numeric_limits<double>::quiet_NaN(), INF = std::numeric_limits<double>::infinity();

typedef std::vector<std::vector<Point3d> > ObjectViews;
typedef std::vector<std::vector<Point2d> > PixelViews;

inline Matx33d K1() { return Matx33d(2438.07, 0, 643.98, 0, 2438.08, 500.01, 0, 0, 1); }
inline Matx33d K2() { return Matx33d(2427.89, 0, 640.28, 0, 2429.12, 519.56, 0, 0, 1); }
inline Mat D1() { return (Mat_<double>(1, 4) << -0.4082, 0.4359, 0, 0); }
inline Mat D2() { return (Mat_<double>(5, 1) << -0.39, 0.31, 1e-4, -2e-4, 0.1); }
inline GlassWindow window1() { return GlassWindow(Vec3d(-0.2483, 0.0961, 1), 20, 1.5437, 50); }
inline GlassWindow window2() { return GlassWindow(Vec3d(0.1846, 0.0312, 1), 20, 1.5437, 40); }
inline Ptr<RefractiveCamera> camera1() { return RefractiveCamera::create(K1(), D1(), window1()); }
inline Ptr<RefractiveCamera> camera2() { return RefractiveCamera::create(K2(), D2(), window2()); }
// Without their windows.
inline Ptr<RefractiveCamera> bare1() { return RefractiveCamera::create(K1(), D1()); }
inline Ptr<RefractiveCamera> bare2() { return RefractiveCamera::create(K2(), D2()); }

inline Matx33d rotation(double x, double y)
{
    return Matx33d(1, 0, 0, 0, std::cos(x), -std::sin(x), 0, std::sin(x), std::cos(x))
         * Matx33d(std::cos(y), 0, std::sin(y), 0, 1, 0, -std::sin(y), 0, std::cos(y));
}

// Camera 1 -> camera 2.
inline Matx33d R() { return rotation(0.01, 0.3); }
inline Vec3d T() { return Vec3d(-180, 2, 25); }

inline std::vector<Point3d> board()
{
    std::vector<Point3d> points;
    for (int i = 0; i < 30; i++)
        points.push_back(Point3d(39*(i % 6) - 97.5, 39*(i/6) - 78., 0));
    return points;
}

// 30 points, z = 600 +- 20 in camera 1.
inline std::vector<Point3d> scenePoints()
{
    std::vector<Point3d> points = board();
    for (size_t i = 0; i < points.size(); i++)
        points[i] = Point3d(0.8*points[i].x, 0.8*points[i].y, 600 + 5.*(i % 9) - 20);
    return points;
}

inline std::vector<Point2d> project(const std::vector<Point3d>& points, const Ptr<RefractiveCamera>& camera,
                                    const Matx33d& rotation = Matx33d::eye(), const Vec3d& translation = Vec3d())
{
    std::vector<Point2d> pixels;
    Mat status;
    refractiveProjectPoints(points, rotation, translation, camera, pixels, status);
    EXPECT_EQ(0, cv::countNonZero(status));
    return pixels;
}

// Perfect views of the board in five poses, in camera 1 or by R and T in camera 2.
inline PixelViews views(const Ptr<RefractiveCamera>& camera, bool second = false)
{
    PixelViews result;
    for (int i = 0; i < 5; i++)
    {
        const Matx33d r = rotation(0.3 - 0.15*i, 0.25*(i % 3) - 0.2);
        const Vec3d t(10*(i % 2), 8*i - 15, 590 + 10*i);
        result.push_back(second ? project(board(), camera, R()*r, R()*t + T()) : project(board(), camera, r, t));
    }
    return result;
}

inline ObjectViews boards() { return ObjectViews(5, board()); }

// Angle between two unit vectors.
inline double angle(const Vec3d& a, const Vec3d& b) { return std::atan2(cv::norm(a.cross(b)), a.dot(b)); }

// The text of the exception that f throws; empty if it throws none.
template<typename F> std::string thrown(const F& f)
{
    try { f(); }
    catch (const cv::Exception& e) { return e.what(); }
    return std::string();
}

inline bool contains(const std::string& text, const std::string& word) { return text.find(word) != std::string::npos; }

// The call throws cv::Exception, whose text says so.
#define EXPECT_REFUSED(call, text) EXPECT_PRED2(contains, thrown([&] { call; }), text)

}} // namespace

#endif
