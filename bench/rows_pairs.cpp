// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "rows.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;

namespace bench {

namespace {

const Matx33d R(0.9553364891256061, 0, 0.2955202066613396, 0, 1, 0, -0.2955202066613396, 0, 0.9553364891256061);
const Vec3d T(-180, 0, 25);

//! Two cameras, and noisy pixels of the same points in both.
struct Pair
{
    explicit Pair(int count) : scene1(FIVE, 1), scene2(FIVE, 1, true)
    {
        std::mt19937_64 engine(7);
        std::uniform_real_distribution<double> side(-80, 80), depth(500, 720);
        std::normal_distribution<double> noise(0, 0.1);
        std::vector<Point3d> points(count);
        for (Point3d& X : points)
            X = Point3d(side(engine), side(engine), depth(engine));
        refractiveProjectPoints(points, Vec3d(), Vec3d(), scene1.camera, pixels1);
        refractiveProjectPoints(points, R, T, scene2.camera, pixels2);
        for (std::vector<Point2d>* pixels : { &pixels1, &pixels2 })
            for (Point2d& p : *pixels)
                p += Point2d(noise(engine), noise(engine));
        // cv::triangulatePoints wants normalised points of pinhole cameras: given to it for nothing.
        Mat(2, count, CV_64F).copyTo(normal1);
        normal1.copyTo(normal2);
        for (int i = 0; i < count; i++)
        {
            const Point3d& X = points[i];
            const Vec3d Y = R*Vec3d(X) + T;
            normal1.at<double>(0, i) = X.x/X.z + noise(engine)/2438;
            normal1.at<double>(1, i) = X.y/X.z + noise(engine)/2438;
            normal2.at<double>(0, i) = Y[0]/Y[2] + noise(engine)/2438;
            normal2.at<double>(1, i) = Y[1]/Y[2] + noise(engine)/2438;
        }
        hconcat(Mat(R), Mat(T), P2);
    }
    Scene scene1, scene2;
    std::vector<Point2d> pixels1, pixels2;
    Mat normal1, normal2, P2, homogeneous;
    std::vector<Point3d> points;
    std::vector<uchar> status;
    std::vector<std::vector<Point2d> > lines;
    std::vector<double> distances;
    std::vector<Vec3d> straight;        //!< epipolar lines
};

using reference::dot;

typedef std::shared_ptr<Pair> Data;

Point toCamera(const Matx33d& rotation, const Vec3d& translation, const Point& X)
{
    Point Y;
    for (int r = 0; r < 3; r++)
        Y[r] = (long double)rotation(r, 0)*X[0] + (long double)rotation(r, 1)*X[1] + (long double)rotation(r, 2)*X[2]
               + translation[r];
    return Y;
}
Point toCamera2(const Point& X) { return toCamera(R, T, X); }

//! A camera for the reference, and what it sees.
struct View
{
    reference::Camera<long double> camera;
    Matx33d R;
    Vec3d T;
    const std::vector<Point2d>* pixels;
};

//! Gradient of the squared pixel errors by X over their curvature: how far X is from the optimum.
long double distanceToOptimum(const std::vector<View>& views, int i, const Point& X)
{
    const auto residual = [&](const Point& Y)
    {
        std::vector<long double> e;
        for (const View& v : views)
        {
            const Pixel a = v.camera.project(toCamera(v.R, v.T, Y)), p = exact((*v.pixels)[i]);
            const bool isSeen = p[0] == p[0];
            e.push_back(isSeen ? a[0] - p[0] : 0);
            e.push_back(isSeen ? a[1] - p[1] : 0);
        }
        return e;
    };
    const long double h = 1e-5L;
    const auto e = residual(X);
    Matx33d A;
    Vec3d g;
    std::vector<long double> J[3];
    for (int c = 0; c < 3; c++)
    {
        Point up = X, down = X;
        up[c] += h;
        down[c] -= h;
        const auto a = residual(up), b = residual(down);
        for (size_t k = 0; k < e.size(); k++)
            J[c].push_back((a[k] - b[k])/(2*h));
    }
    for (int r = 0; r < 3; r++)
        for (size_t k = 0; k < e.size(); k++)
        {
            g[r] += (double)(J[r][k]*e[k]);
            for (int c = 0; c < 3; c++)
                A(r, c) += (double)(J[r][k]*J[c][k]);
        }
    return norm(A.inv()*g);
}

double optimumError(const std::vector<View>& views, const std::vector<Point3d>& points)
{
    long double worst = 0;
    for (int i : sample((int)points.size(), 200))
        worst = std::max(worst, distanceToOptimum(views, i, exact(points[i])));
    return (double)worst;
}

double optimumError(const Data& d)
{
    return optimumError({ { d->scene1.parts<long double>(), Matx33d::eye(), Vec3d(), &d->pixels1 },
                          { d->scene2.parts<long double>(), R, T, &d->pixels2 } }, d->points);
}

double midpointError(const Data& d)
{
    const auto c1 = d->scene1.parts<long double>(), c2 = d->scene2.parts<long double>();
    long double worst = 0;
    for (int i : sample((int)d->points.size(), 200))
    {
        const auto a = c1.unproject(exact(d->pixels1[i]));
        auto b = c2.unproject(exact(d->pixels2[i]));
        Point o = reference::add(b.origin, -1.L, Point{ T[0], T[1], T[2] }), o2, d2;
        for (int r = 0; r < 3; r++)
        {
            o2[r] = R(0, r)*o[0] + R(1, r)*o[1] + R(2, r)*o[2];
            d2[r] = R(0, r)*b.direction[0] + R(1, r)*b.direction[1] + R(2, r)*b.direction[2];
        }
        // Both normal equations of |o1 + s d1 - o2 - t d2|^2.
        const Point between = reference::add(o2, -1.L, a.origin);
        const long double c = dot(a.direction, d2), e = dot(between, a.direction), f = dot(between, d2);
        const long double dd1 = dot(a.direction, a.direction), dd2 = dot(d2, d2), det = dd1*dd2 - c*c;
        const long double s = (e*dd2 - f*c)/det, t = (e*c - f*dd1)/det;
        const Point X = reference::add(a.origin, s, a.direction), Y = reference::add(o2, t, d2);
        for (int r = 0; r < 3; r++)
            worst = std::max(worst, std::abs((X[r] + Y[r])/2 - (r == 0 ? d->points[i].x : r == 1 ? d->points[i].y
                                                                                                 : d->points[i].z)));
    }
    return (double)worst;
}

Row triangulateRow(const Data& d, const std::string& key, const std::string& work, int flags, double target)
{
    Row r = { key, work, "cv::triangulatePoints", { target, target }, (int)d->pixels1.size(), {}, {}, {}, {}, 57, "mm", 1e-8,
              {}, {}, {} };
    r.ours = [=] { triangulateRefractive(d->scene1.camera, d->scene2.camera, R, T, d->pixels1, d->pixels2, d->points,
                                         d->status, flags); };
    r.peer = [=] { triangulatePoints(Matx34d::eye(), d->P2, d->normal1, d->normal2, d->homogeneous); };
    r.error = [=] { return flags ? midpointError(d) : optimumError(d); };
    r.successes = [=] { return countOk(d->status); };
    return r;
}

/* The covariance of each point beside the point alone: both in one run. A calibration's covariance is full: every parameter is
correlated with every other. */
Row covarianceRow(const Data& d, const std::string& key, const std::string& work, bool isCalibrated, double target)
{
    Row r = triangulateRow(d, key, work, TRIANGULATE_OPTIMAL, target);
    r.peerName = "triangulateRefractive without";
    r.bytes = 57 + 72;
    const int own = (int)d->scene1.camera->parameterNames().size(), count = 2*own + 6;
    Mat calibration;
    if (isCalibrated)
    {
        std::mt19937_64 engine(9);
        std::normal_distribution<double> normal(0, 1e-4);
        Mat_<double> root(count, count);
        for (double& value : root)
            value = normal(engine);
        calibration = root*root.t();
    }
    const auto covariance = std::make_shared<Mat>();
    r.ours = [=] { triangulateRefractive(d->scene1.camera, d->scene2.camera, R, T, d->pixels1, d->pixels2, d->points, d->status,
                                         TRIANGULATE_OPTIMAL, 0.1, calibration, *covariance); };
    r.peer = [=] { triangulateRefractive(d->scene1.camera, d->scene2.camera, R, T, d->pixels1, d->pixels2, d->points,
                                         d->status); };
    return r;
}

//! Four cameras round a volume, and noisy pixels of the same points in all of them.
struct Rig
{
    //! Of a point in `hideOneIn` one pixel, of a camera in turn, was not seen; 0: all were.
    Rig(int count, int hideOneIn)
    {
        const double c = R(0, 0), s = R(0, 2);
        const Matx33d turns[] = { Matx33d::eye(), R, R.t(), Matx33d(1, 0, 0, 0, c, s, 0, -s, c) };
        const Vec3d moves[] = { Vec3d(), T, Vec3d(-T[0], 0, T[2]), Vec3d(0, T[0], T[2]) };
        std::mt19937_64 engine(8);
        std::uniform_real_distribution<double> side(-80, 80), depth(500, 720);
        std::normal_distribution<double> noise(0, 0.1);
        std::vector<Point3d> truth(count);
        for (Point3d& X : truth)
            X = Point3d(side(engine), side(engine), depth(engine));
        pixels.resize(4);
        for (int k = 0; k < 4; k++)
        {
            scenes.push_back(Scene(FIVE, 1, k % 2 == 1));
            cameras.push_back(scenes[k].camera);
            Rs.push_back(Mat(turns[k], true));
            Ts.push_back(moves[k]);
            refractiveProjectPoints(truth, turns[k], moves[k], cameras[k], pixels[k]);
            for (Point2d& p : pixels[k])
                p += Point2d(noise(engine), noise(engine));
        }
        for (int i = 0; i < count && hideOneIn; i += hideOneIn)
            pixels[i/hideOneIn % 4][i] = Point2d(NAN, NAN);
    }
    std::vector<View> views() const
    {
        std::vector<View> all;
        for (int k = 0; k < 4; k++)
            all.push_back({ scenes[k].parts<long double>(), Matx33d(Rs[k].ptr<double>()), Ts[k], &pixels[k] });
        return all;
    }
    std::vector<Scene> scenes;
    std::vector<Ptr<RefractiveCamera> > cameras;
    std::vector<Mat> Rs;
    std::vector<Vec3d> Ts;
    std::vector<std::vector<Point2d> > pixels;
    std::vector<Point3d> points, others;
    std::vector<uchar> status;
};

//! Four cameras beside the first two of them.
Row rigRow(int count, const std::string& key, const std::string& work, int hideOneIn, double target)
{
    const auto d = std::make_shared<Rig>(count, hideOneIn), all = hideOneIn ? std::make_shared<Rig>(count, 0) : d;
    Row r = { key, work, "triangulateRefractive, the pair", { target, target }, count, {}, {}, {}, {}, 89, "mm", 1e-8, {}, {}, {} };
    r.ours = [=] { triangulateRefractive(d->cameras, d->Rs, d->Ts, d->pixels, d->points, d->status); };
    r.peer = [=] { triangulateRefractive(all->cameras[0], all->cameras[1], all->Rs[1], all->Ts[1], all->pixels[0],
                                         all->pixels[1], all->others); };
    r.error = [=] { return optimumError(d->views(), d->points); };
    r.successes = [=] { return countOk(d->status); };
    return r;
}

/* A point of a camera and a sheet of light, each behind its own window, beside that of two cameras; pixels without noise, which
the second camera of both has as well. */
Row sheetRow(int count, const std::string& key, const std::string& work, double target)
{
    const auto d = std::make_shared<Rig>(count, 0), stereo = std::make_shared<Rig>(count, 0);
    const auto truth = std::make_shared<std::vector<Point3d> >();
    for (const auto& rig : { d, stereo })
    {
        rig->cameras.resize(2); rig->Rs.resize(2); rig->Ts.resize(2); rig->pixels.resize(2);
    }
    triangulateRefractive(stereo->cameras, stereo->Rs, stereo->Ts, stereo->pixels, *truth);
    for (int k = 0; k < 2; k++)
        refractiveProjectPoints(*truth, d->Rs[k], d->Ts[k], d->cameras[k], d->pixels[k]);
    for (Point2d& p : d->pixels[1])
        p.y = NAN;
    Row r = { key, work, "triangulateRefractive, two cameras", { target, target }, count, {}, {}, {}, {}, 57, "mm", 1e-8, {}, {}, {} };
    r.ours = [=] { triangulateRefractive(d->cameras, d->Rs, d->Ts, d->pixels, d->points, d->status); };
    r.peer = [=] { triangulateRefractive(stereo->cameras, stereo->Rs, stereo->Ts, stereo->pixels, stereo->points, stereo->status); };
    r.error = [=]
    {
        double worst = 0;
        for (size_t i = 0; i < truth->size(); i++)
            worst = std::max(worst, norm(d->points[i] - (*truth)[i]));
        return worst;
    };
    r.successes = [=] { return countOk(d->status); };
    return r;
}

//! Largest distance of exact points of the curves from their polylines.
double curveError(const Data& d)
{
    const auto c1 = d->scene1.parts<long double>(), c2 = d->scene2.parts<long double>();
    double worst = 0;
    for (int i : sample((int)d->lines.size(), 100))
    {
        const auto ray = c1.unproject(exact(d->pixels1[i]));
        for (int k = 0; k <= 100; k++)
        {
            const long double z = 1/(1/300.L + k*(1/1500.L - 1/300.L)/100);
            const Pixel p = c2.project(toCamera2(reference::add(ray.origin, (z - ray.origin[2])/ray.direction[2], ray.direction)));
            double nearest = DBL_MAX;
            for (size_t j = 1; j < d->lines[i].size(); j++)
            {
                const Point2d a = d->lines[i][j - 1], ab = d->lines[i][j] - a, ap = Point2d((double)p[0], (double)p[1]) - a;
                const double t = std::min(1., std::max(0., ap.dot(ab)/ab.dot(ab)));
                nearest = std::min(nearest, norm(ap - t*ab));
            }
            worst = std::max(worst, nearest);
        }
    }
    return worst;
}

//! What a user without this call has: F, one line a point, the other's distance from it.
void distancesFromLines(const Data& d)
{
    const Matx33d cross(0, -T[2], T[1], T[2], 0, -T[0], -T[1], T[0], 0);
    const Matx33d F = d->scene2.K.inv().t()*cross*R*d->scene1.K.inv();
    computeCorrespondEpilines(d->pixels1, 1, F, d->straight);
    d->distances.resize(d->pixels1.size());
    for (size_t i = 0; i < d->pixels2.size(); i++)
        d->distances[i] = d->straight[i].dot(Vec3d(d->pixels2[i].x, d->pixels2[i].y, 1));
}

//! Largest error of the distances, against a ternary search along the exact curve.
double distanceError(const Data& d)
{
    const auto c1 = d->scene1.parts<long double>(), c2 = d->scene2.parts<long double>();
    long double worst = 0;
    for (int i : sample((int)d->distances.size(), 100))
    {
        const auto ray = c1.unproject(exact(d->pixels1[i]));
        const auto distance = [&](long double s)
        {
            const Pixel p = c2.project(toCamera2(reference::add(ray.origin, s, ray.direction)));
            return std::hypot(p[0] - d->pixels2[i].x, p[1] - d->pixels2[i].y);
        };
        long double low = 200, high = 1e5L;
        for (int k = 0; k < 200; k++)
        {
            const long double a = low + (high - low)/3, b = high - (high - low)/3;
            (distance(a) < distance(b) ? high : low) = distance(a) < distance(b) ? b : a;
        }
        worst = std::max(worst, std::abs(distance(low) - std::abs(d->distances[i])));
    }
    return (double)worst;
}

Row distanceRow(const Data& d, const std::string& key, const std::string& work)
{
    Row r = triangulateRow(d, key, work, 0, 0);
    r.bytes = 41;
    r.peerName = "cv::computeCorrespondEpilines, distance";
    r.ours = [=] { refractiveEpipolarDistance(d->pixels1, d->pixels2, d->scene1.camera, d->scene2.camera, R, T, d->distances,
                                              d->status); };
    r.peer = [=] { distancesFromLines(d); };
    r.error = [=] { return distanceError(d); };
    r.tolerance = 1e-6;
    r.unit = "px";
    return r;
}

} // namespace

void addPairRows(std::vector<Row>& rows, int count)
{
    const Data many = std::make_shared<Pair>(count), few = std::make_shared<Pair>(std::min(count, 2000));
    rows.push_back(triangulateRow(many, "triangulate", "triangulate, maximum likelihood", TRIANGULATE_OPTIMAL, 1/4.));
    rows.push_back(triangulateRow(many, "midpoint", "triangulate, midpoint", TRIANGULATE_MIDPOINT, 1/15.));
    rows.push_back(covarianceRow(many, "triangulate_covariance", "triangulate, with covariance", false, 2));
    rows.push_back(covarianceRow(many, "triangulate_calibrated", "triangulate, with the calibration's covariance", true, 3));
    rows.push_back(rigRow(count, "triangulate_rig", "triangulate, 4 cameras", 0, 2.2));
    rows.push_back(rigRow(count, "triangulate_missing", "triangulate, 4 cameras, some unseen", 2, 0));
    rows.push_back(sheetRow(count, "triangulate_sheet", "triangulate, camera and sheet of light", 1));
    Row cv = rigRow(count, "triangulate_cv", "triangulate, 4 cameras", 0, 2.2/12);
    cv.peerName = "3 cv::triangulatePoints";
    cv.peer = [=] { for (int k = 0; k < 3; k++) triangulatePoints(Matx34d::eye(), many->P2, many->normal1, many->normal2,
                                                                  many->homogeneous); };
    rows.push_back(cv);
    Row lines = triangulateRow(few, "epilines", "epipolar curve, 300-1500 mm", 0, 0);
    lines.bytes = 0;
    lines.peerName = "cv::computeCorrespondEpilines";
    lines.ours = [=] { computeRefractiveEpilines(few->pixels1, 1, few->scene1.camera, few->scene2.camera, R, T,
                                                 Vec2d(300, 1500), few->lines, 0.01, few->status); };
    lines.peer = [=] { Mat straight; computeCorrespondEpilines(few->pixels1, 1, Mat(R), straight); };
    lines.error = [=] { return curveError(few); };
    lines.tolerance = 0.01;
    lines.unit = "px";
    rows.push_back(lines);
    rows.push_back(distanceRow(many, "epipolar_distance", "epipolar distance"));
    const Data wrong = std::make_shared<Pair>(count);       // 40 % of the matches
    for (size_t i = 0; i + 5 < wrong->pixels2.size(); i += 5)
        std::swap(wrong->pixels2[i], wrong->pixels2[i + 3]);
    rows.push_back(distanceRow(wrong, "epipolar_distance_wrong", "epipolar distance, 40 % wrong"));
}

} // namespace bench
