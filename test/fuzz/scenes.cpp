// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "scenes.hpp"
#include <opencv2/calib3d.hpp>

namespace fuzz {

using cv::Mat;
using cv::Vec3d;
using namespace cv::refract;

namespace {

//! A lens and a window that could be; the stranger ones are the business of the other harnesses.
cv::Ptr<RefractiveCamera> plainCamera(Bytes& bytes)
{
    const double f = 800 + 4*bytes.below(256);
    const cv::Matx33d K(f, 0, 640, 0, f, 512, 0, 0, 1);
    GlassWindow window;
    window.normal = cv::normalize(Vec3d((bytes.below(256) - 128)/400., (bytes.below(256) - 128)/400., 1));
    window.distance = bytes.below(100);
    const int layers = bytes.below(3);
    for (int i = 0; i < layers; i++)
    {
        window.thickness.push_back(1 + bytes.below(40));
        window.index.push_back(1.3 + bytes.below(256)/500.);
    }
    if (layers == 0 || bytes.maybe())
        window.outerIndex = 1.333;
    switch (bytes.below(4))
    {
    default: return RefractiveCamera::create(K, std::vector<double>{-0.2, 0.1, 1e-3, -1e-3, 0.01}, window);
    case 1: return RefractiveCamera::createFisheye(K, std::vector<double>{0.01, -0.003, 0, 0}, window);
    case 2: return RefractiveCamera::create(K, cv::noArray(), window);
    }
}

//! A little noise, now and then a wrong or missing point or no image at all.
void spoil(Bytes& bytes, std::vector<cv::Point2d>& points)
{
    if (bytes.rarely())
        points.clear();
    for (cv::Point2d& p : points)
    {
        p.x += (bytes.below(256) - 128)/1000.;
        if (bytes.rarely())
            (bytes.maybe() ? p.x : p.y) = bytes.number();
    }
}

} // namespace

Scene::Scene(Bytes& bytes, int cameraCount)
{
    const int viewCount = bytes.rarely() ? bytes.below(12) : 1 + bytes.below(4), side = 2 + bytes.below(3);
    std::vector<cv::Point3d> target;
    for (int i = 0; i < side*(side + 1); i++)
        target.emplace_back(60*(i % side - 0.5*side), 60*(i/side - 0.5*side), 0);
    if (bytes.rarely())
        for (cv::Point3d& p : target)
            p.z = bytes.about(-50, 50);
    if (bytes.rarely() && !target.empty())
        target[bytes.below((int)target.size())] = cv::Point3d(bytes.number(), bytes.number(), bytes.number());
    for (int c = 0; c < cameraCount; c++)
    {
        cameras.push_back(plainCamera(bytes));
        Mat R;
        cv::Rodrigues(c ? Vec3d(0, -0.2*c, 0.01) : Vec3d(), R);
        Rs.push_back(R);
        Ts.push_back(Mat(Vec3d(c ? -150.*c : 0., 0, 0), true));
    }
    direct.resize(cameraCount);
    refracted.resize(cameraCount);
    for (int v = 0; v < viewCount; v++)
    {
        const Vec3d rvec(bytes.about(-0.5, 0.5), bytes.about(-0.5, 0.5), bytes.about(-0.3, 0.3));
        const Vec3d tvec(bytes.about(-60, 60), bytes.about(-60, 60), bytes.about(500, 900));
        objectPoints.push_back(target);
        rvecs.push_back(Mat(rvec, true));
        tvecs.push_back(Mat(tvec, true));
        for (int c = 0; c < cameraCount; c++)
            for (bool through : {false, true})
            {
                cv::Matx33d R;
                cv::Rodrigues(rvec, R);
                const cv::Matx33d toCamera(Rs[c]);
                Vec3d r;
                cv::Rodrigues(toCamera*R, r);
                std::vector<cv::Point2d> points;
                const cv::Ptr<RefractiveCamera> bare = RefractiveCamera::create(cameras[c]->cameraMatrix(), cv::noArray());
                if (cv::checkRange(target) && cv::checkRange(r) && cv::checkRange(tvec))
                    refractiveProjectPoints(target, r, toCamera*tvec + Vec3d(Ts[c]), through ? cameras[c] : bare, points);
                else
                    points.resize(target.size());
                spoil(bytes, points);
                (through ? refracted : direct)[c].push_back(points);
            }
    }
}

namespace {

template<typename Point>
std::vector<Mat> arrays(Bytes& bytes, const std::vector<std::vector<Point>>& views)
{
    std::vector<Mat> result;
    for (const std::vector<Point>& view : views)
        result.push_back(Mat(view, true));
    if (!bytes.rarely() || result.empty())
        return result;
    Mat& one = result[bytes.below((int)result.size())];
    switch (bytes.below(7))
    {
    case 0: result.pop_back(); break;
    case 1: result.push_back(one.clone()); break;
    case 2: one = one.rowRange(0, bytes.below(one.rows + 1)).clone(); break;
    case 3: one.convertTo(one, CV_32F); break;
    case 4: one = Mat(); break;
    case 5: if (!one.empty()) one = one.reshape(1); break;
    case 6: if (!one.empty()) one = Mat(one.reshape(1, 1)); break;
    }
    return result;
}

} // namespace

std::vector<Mat> arraysOf(Bytes& bytes, const Views& views) { return arrays(bytes, views); }
std::vector<Mat> arraysOf(Bytes& bytes, const std::vector<std::vector<cv::Point3d>>& views) { return arrays(bytes, views); }

int flagsOf(Bytes& bytes)
{
    return bytes.rarely() ? bytes.below(65536) - 1000 : bytes.below(1024) & ~GLASS_USE_POSES;
}

cv::TermCriteria criteriaOf(Bytes& bytes)
{
    if (bytes.rarely())
        return cv::TermCriteria(bytes.below(5), bytes.below(300) - 20, bytes.number());
    return cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-12);
}

} // namespace fuzz
