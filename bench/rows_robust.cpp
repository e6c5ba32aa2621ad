// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "rows.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;

namespace bench {

namespace {

//! Calls of a robust estimator: of each the matches, and what it found.
struct Trials
{
    Trials(double outerIndex, int points, double wrong) : scene(FIVE, outerIndex)
    {
        std::mt19937_64 engine(11);
        const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); };
        std::normal_distribution<double> noise(0, 0.2);
        const Ptr<RefractiveCamera> bare = RefractiveCamera::create(scene.K, scene.D);
        for (int trial = 0; trial < 20; trial++)
        {
            std::vector<Point3d> target;
            for (int i = 0; i < points; i++)
                target.push_back(Point3d(uniform(-80, 80), uniform(-70, 70), uniform(-60, 60)));
            rvecs.push_back(Vec3d(uniform(-0.5, 0.5), uniform(-0.5, 0.5), uniform(-0.5, 0.5)));
            tvecs.push_back(Vec3d(uniform(-20, 20), uniform(-20, 20), uniform(550, 700)));
            objects.push_back(target);
            std::vector<Point2d> seen, seenBare;
            refractiveProjectPoints(target, rvecs.back(), tvecs.back(), scene.camera, seen);
            refractiveProjectPoints(target, rvecs.back(), tvecs.back(), bare, seenBare);
            for (int i = 0; i < points; i++)
            {
                const bool isWrong = i < wrong*points;
                const Point2d off(noise(engine), noise(engine)), random(uniform(0, WIDTH), uniform(0, HEIGHT));
                seen[i] = isWrong ? random : seen[i] + off;
                seenBare[i] = isWrong ? random : seenBare[i] + off;
            }
            pixels.push_back(seen);
            pixelsBare.push_back(seenBare);
        }
    }
    Scene scene;
    std::vector<std::vector<Point3d> > objects;
    std::vector<std::vector<Point2d> > pixels, pixelsBare;      //!< through the window, without
    std::vector<Vec3d> rvecs, tvecs;                            //!< the truth
    std::vector<Mat> foundRvecs, foundTvecs;                    //!< empty where there is no pose
    int successes = 0;
};

typedef std::shared_ptr<Trials> Data;

const double CONFIDENCE = 0.999;
const int ITERATIONS = 1000;
const float LIMIT = 8;

//! Largest distance of a found target's centre from the truth.
double centreError(const Data& d)
{
    double worst = 0;
    for (size_t i = 0; i < d->foundTvecs.size(); i++)
        worst = d->foundTvecs[i].empty() ? NAN : std::max(worst, norm(d->foundTvecs[i], Mat(d->tvecs[i])));
    return worst;
}

Row pnpRow(const Data& d, const std::string& key, const std::string& work)
{
    const int count = (int)d->objects.size();
    Row r = { key, work, "cv::solvePnPRansac, AP3P", { 0, 0 }, count, {}, {}, {}, {}, 0, "mm", 3, {}, {}, {} };
    const auto run = [=](const std::function<bool(int, Mat&, Mat&)>& solve)
    {
        d->foundRvecs.assign(count, Mat());
        d->foundTvecs.assign(count, Mat());
        d->successes = 0;
        for (int i = 0; i < count; i++)
            d->successes += solve(i, d->foundRvecs[i], d->foundTvecs[i]);
    };
    r.ours = [=] { run([&](int i, Mat& rvec, Mat& tvec)
        { return refractiveSolvePnPRansac(d->objects[i], d->pixels[i], d->scene.camera, rvec, tvec, false, ITERATIONS, LIMIT,
                                          CONFIDENCE); }); };
    r.peer = [=] { run([&](int i, Mat& rvec, Mat& tvec)
        { return solvePnPRansac(d->objects[i], d->pixelsBare[i], d->scene.K, d->scene.D, rvec, tvec, false, ITERATIONS, LIMIT,
                                CONFIDENCE, noArray(), SOLVEPNP_AP3P); }); };
    r.error = [=] { return centreError(d); };
    r.peerError = [=] { r.peer(); return centreError(d); };
    r.successes = [=] { return d->successes; };
    return r;
}

//! Two cameras' matches, wrong ones uniformly random.
struct Matched
{
    Matched(double outerIndex, int count, double wrong) : scene1(FIVE, outerIndex), scene2(FIVE, outerIndex, true)
    {
        std::mt19937_64 engine(12);
        const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); };
        std::normal_distribution<double> noise(0, 0.2);
        std::vector<Point3d> points;
        for (int i = 0; i < count; i++)
            points.push_back(Point3d(uniform(-80, 80), uniform(-80, 80), uniform(450, 800)));
        refractiveProjectPoints(points, Vec3d(), Vec3d(), scene1.camera, pixels1);
        refractiveProjectPoints(points, rvec, truth, scene2.camera, pixels2);
        refractiveProjectPoints(points, Vec3d(), Vec3d(), RefractiveCamera::create(scene1.K, scene1.D), bare1);
        refractiveProjectPoints(points, rvec, truth, RefractiveCamera::create(scene2.K, scene2.D), bare2);
        for (int i = 0; i < count; i++)
        {
            const Point2d off1(noise(engine), noise(engine)), off2(noise(engine), noise(engine));
            const Point2d random(uniform(0, WIDTH), uniform(0, HEIGHT));
            pixels1[i] += off1;
            bare1[i] += off1;
            pixels2[i] = i < wrong*count ? random : pixels2[i] + off2;
            bare2[i] = i < wrong*count ? random : bare2[i] + off2;
        }
    }
    Scene scene1, scene2;
    Vec3d rvec = Vec3d(0, 0.3, 0), truth = Vec3d(-180, 0, 25);
    std::vector<Point2d> pixels1, pixels2, bare1, bare2;        //!< through the windows, without
    Mat R, T;
    int inliers = 0;
};

double degreesOff(const Matched& m)
{
    Matx33d R;
    Rodrigues(m.rvec, R);
    Vec3d between;
    Rodrigues(Matx33d(m.R).t()*R, between);
    return norm(between)*180/CV_PI;
}

Row recoverRow(const std::shared_ptr<Matched>& m, const std::string& key, const std::string& work)
{
    Row r = { key, work, "cv::findEssentialMat, recoverPose", { 0, 0 }, 1, {}, {}, {}, {}, 0, "deg", 0.5, {}, {}, {} };
    r.ours = [=] { m->inliers = refractiveRecoverPose(m->pixels1, m->pixels2, m->scene1.camera, m->scene2.camera, m->R,
                                                       m->T); };
    r.peer = [=]
    {
        std::vector<Point2d> n1, n2;
        undistortPoints(m->bare1, n1, m->scene1.K, m->scene1.D);
        undistortPoints(m->bare2, n2, m->scene2.K, m->scene2.D);
        Mat mask;
        const Mat E = findEssentialMat(n1, n2, Mat(Matx33d::eye()), RANSAC, 0.999, 1/m->scene1.K(0, 0), 1000, mask);
        recoverPose(E, n1, n2, Mat(Matx33d::eye()), m->R, m->T, mask);
    };
    r.error = [=] { return degreesOff(*m); };
    r.peerError = [=] { r.peer(); return degreesOff(*m); };
    r.successes = [=] { return m->inliers >= 0.55*(double)m->pixels1.size() ? 1 : 0; };
    return r;
}

} // namespace

void addRobustRows(std::vector<Row>& rows)
{
    rows.push_back(pnpRow(std::make_shared<Trials>(1, 100, 0.7), "pnp_ransac", "PnP, 70 of 100 matches wrong"));
    rows.push_back(pnpRow(std::make_shared<Trials>(1.333, 100, 0.7), "pnp_ransac_water", "the same in water"));
    rows.push_back(recoverRow(std::make_shared<Matched>(1, 200, 0.4), "recover_pose", "relative pose, 80 of 200 wrong"));
    rows.push_back(recoverRow(std::make_shared<Matched>(1.333, 200, 0.4), "recover_pose_water", "the same in water"));
    rows.push_back(recoverRow(std::make_shared<Matched>(1, 5000, 0.4), "recover_pose_many", "relative pose, 2000 of 5000 wrong"));
    rows.push_back(recoverRow(std::make_shared<Matched>(1.333, 5000, 0.4), "recover_pose_many_water", "the same in water"));
}

} // namespace bench
