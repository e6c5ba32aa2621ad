// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Seeded calibration scenes: targets seen with and without the window, with noise, and the truth.
#ifndef REFRACT_TEST_CALIBRATION_SCENES_HPP
#define REFRACT_TEST_CALIBRATION_SCENES_HPP

#include "scenes.hpp"
#include <opencv2/calib3d.hpp>

namespace scenes {

typedef std::vector<std::vector<cv::Point3d> > ObjectViews;
typedef std::vector<std::vector<cv::Point2d> > PixelViews;

//! What one camera sees of some targets.
struct CalibrationScene
{
    ObjectViews object;
    PixelViews refracted, direct;
    std::vector<cv::Vec3d> rvecs, tvecs;
};

//! The left camera of the paper's Table 3 behind the given window.
inline cv::Ptr<RefractiveCamera> paperCamera(const GlassWindow& window)
{
    return makeCamera(lensNamed("the paper's"), window);
}

inline std::vector<cv::Point3d> board(int columns = 6, int rows = 5, double square = 39)
{
    std::vector<cv::Point3d> points;
    for (int r = 0; r < rows; r++)
        for (int c = 0; c < columns; c++)
            points.push_back({ square*(c - (columns - 1)/2.), square*(r - (rows - 1)/2.), 0 });
    return points;
}

//! Not planar, not ordered.
inline std::vector<cv::Point3d> cloud(Random& random, int count = 30, double size = 90)
{
    std::vector<cv::Point3d> points;
    for (int i = 0; i < count; i++)
        points.push_back(cv::Point3d(random.vector(size)));
    return points;
}

inline std::vector<cv::Point2d> seen(const std::vector<cv::Point3d>& object, const cv::Vec3d& rvec, const cv::Vec3d& tvec,
                                     const cv::Ptr<RefractiveCamera>& camera, Random& random, double sigma)
{
    std::vector<cv::Point2d> pixels;
    cv::Mat status;
    cv::refract::refractiveProjectPoints(object, rvec, tvec, camera, pixels, status);
    REQUIRE(cv::countNonZero(status) == 0);
    for (cv::Point2d& p : pixels)
        p += cv::Point2d(random.normal(sigma), random.normal(sigma));
    return pixels;
}

//! Targets tilted by up to 30 degrees, centred within 30 mm, at a range of near to far.
inline CalibrationScene makeScene(const cv::Ptr<RefractiveCamera>& camera, const ObjectViews& targets, Random& random,
                                  double sigma, double near = 560, double far = 660)
{
    const cv::Ptr<RefractiveCamera> bare = camera->clone();      // of whatever lens
    bare->setWindow(GlassWindow());
    CalibrationScene scene;
    scene.object = targets;
    for (const std::vector<cv::Point3d>& target : targets)
    {
        const cv::Vec3d axis = cv::normalize(cv::Vec3d(random.normal(1), random.normal(1), 0.2*random.normal(1)));
        scene.rvecs.push_back(axis*random.uniform(0.1, 0.5));
        scene.tvecs.push_back({ random.uniform(-30, 30), random.uniform(-30, 30), random.uniform(near, far) });
        scene.direct.push_back(seen(target, scene.rvecs.back(), scene.tvecs.back(), bare, random, sigma));
        scene.refracted.push_back(seen(target, scene.rvecs.back(), scene.tvecs.back(), camera, random, sigma));
    }
    return scene;
}

inline CalibrationScene makeScene(const cv::Ptr<RefractiveCamera>& camera, int views, Random& random, double sigma)
{
    return makeScene(camera, ObjectViews(views, board()), random, sigma);
}

//! The same scene, its pixels with noise.
inline CalibrationScene withNoise(CalibrationScene scene, Random& random, double sigma)
{
    for (PixelViews* views : { &scene.refracted, &scene.direct })
        for (std::vector<cv::Point2d>& view : *views)
            for (cv::Point2d& p : view)
                p += cv::Point2d(random.normal(sigma), random.normal(sigma));
    return scene;
}

//! Displaces so many of the points by 1 to 20 px; what was displaced, per view.
inline std::vector<std::vector<uchar> > displace(PixelViews& views, double part, Random& random)
{
    std::vector<std::vector<uchar> > displaced;
    for (std::vector<cv::Point2d>& view : views)
    {
        displaced.push_back(std::vector<uchar>(view.size(), 0));
        for (size_t i = 0; i < view.size(); i++)
        {
            if (random.uniform(0, 1) >= part)
                continue;
            const double size = random.uniform(1, 20), azimuth = random.uniform(0, 2*CV_PI);
            view[i] += size*cv::Point2d(std::cos(azimuth), std::sin(azimuth));
            displaced.back()[i] = 1;
        }
    }
    return displaced;
}

//! The views without the points that are marked.
inline PixelViews without(PixelViews views, const std::vector<std::vector<uchar> >& marked)
{
    for (size_t view = 0; view < views.size(); view++)
        for (size_t i = 0; i < views[view].size(); i++)
            if (marked[view][i])
                views[view][i] = cv::Point2d(NaN, NaN);
    return views;
}

//! Degrees between two directions.
inline double angleBetween(const cv::Vec3d& a, const cv::Vec3d& b)
{
    return std::atan2(cv::norm(a.cross(b)), a.dot(b))*180/CV_PI;
}

//! RMS px of views whose poses are fitted, all else fixed. NaN pixels are not seen; infinite where a view has no pose.
template<typename Pixels>
double rmsOfFittedPoses(const std::vector<std::vector<cv::Point3d> >& object, const std::vector<Pixels>& pixels,
                        const cv::Ptr<RefractiveCamera>& camera)
{
    double sum = 0;
    int count = 0;
    for (size_t i = 0; i < object.size(); i++)
    {
        cv::Vec3d rvec, tvec;
        std::vector<double> error;
        if (!refractiveSolvePnP(object[i], pixels[i], camera, rvec, tvec, false, error))
            return std::numeric_limits<double>::infinity();
        int seen = 0;
        for (const cv::Point2d& p : cv::Mat_<cv::Point2d>(cv::Mat(pixels[i])))
            seen += p.x == p.x;
        sum += 2*error[0]*error[0]*seen;
        count += seen;
    }
    return std::sqrt(sum/count);
}

} // namespace scenes

#endif // REFRACT_TEST_CALIBRATION_SCENES_HPP
