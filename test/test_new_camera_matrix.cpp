// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// getOptimalNewRefractiveCameraMatrix: the new camera matrix that keeps the view.
#include "scenes.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

const Size SIZE(1280, 960), NEW(900, 700);
const double BOW = 0.05;        // px: what a border may bow between the places where it was asked

std::vector<Ptr<RefractiveCamera> > someCameras()
{
    const std::vector<double> D = { -0.28, 0.09, 7e-4, -4e-4 };
    return { RefractiveCamera::create(PLAIN_K, D, paper::pane()),
             RefractiveCamera::create(PLAIN_K, D, GlassWindow(Vec3d(0.1, -0.05, 1), 12, 1.5, 40, 1.333)),
             RefractiveCamera::createFisheye(PLAIN_K, std::vector<double>{ 0.02, -0.01, 0, 0 }, paper::pane()) };
}

bool isInside(const Vec2d& p, Size size)
{
    return p[0] >= -BOW && p[1] >= -BOW && p[0] <= size.width - 1 + BOW && p[1] <= size.height - 1 + BOW;
}

std::vector<Vec2d> border()
{
    std::vector<Vec2d> pixels;
    for (int x = 0; x < SIZE.width; x++)
        for (int y : { 0, SIZE.height - 1 })
            pixels.push_back(Vec2d(x, y));
    for (int y = 0; y < SIZE.height; y++)
        for (int x : { 0, SIZE.width - 1 })
            pixels.push_back(Vec2d(x, y));
    return pixels;
}

//! How many pixels of a rectangle of the new image have none of the raw one.
int invalid(const Ptr<RefractiveCamera>& camera, const Mat& K, const Rect& where)
{
    Mat map, none;
    initRefractiveUndistortRectifyMap(camera, 600., noArray(), K, NEW, CV_32FC2, map, none);
    int count = 0;
    for (const Vec2f& p : Mat_<Vec2f>(map(where)))
        count += !isInside(p, SIZE);
    return count;
}

} // namespace

TEST_CASE("alpha 0 leaves no invalid pixel of a plane's image, alpha 1 loses no raw one", "[new_camera_matrix]")
{
    for (const Ptr<RefractiveCamera>& camera : someCameras())
        for (bool isCentred : { false, true })
        {
            CAPTURE(camera->lensModel(), isCentred);
            Rect roi0, roi1;
            const Mat all = getOptimalNewRefractiveCameraMatrix(camera, 600., SIZE, 0, NEW, &roi0, isCentred);
            const Mat whole = getOptimalNewRefractiveCameraMatrix(camera, 600., SIZE, 1, NEW, &roi1, isCentred);
            const Mat between = getOptimalNewRefractiveCameraMatrix(camera, 600., SIZE, 0.5, NEW, nullptr, isCentred);
            REQUIRE(all.size() == Size(3, 3));
            REQUIRE(all.type() == CV_64FC1);
            CHECK(norm(between, 0.5*(all + whole), NORM_INF) < 1e-9*norm(all));
            CHECK(all.at<double>(0, 0) > whole.at<double>(0, 0));

            CHECK(invalid(camera, all, Rect(Point(), NEW)) == 0);
            CHECK(roi0 == Rect(Point(), NEW));
            // No larger than need be: a little wider, and something is missing.
            Mat wider = all.clone();
            wider.at<double>(0, 0) *= 0.99;
            wider.at<double>(1, 1) *= 0.99;
            CHECK(invalid(camera, wider, Rect(Point(), NEW)) > 0);

            std::vector<Vec2d> shown;
            refractiveUndistortPoints(border(), shown, camera, 600., noArray(), whole);
            int outside = 0;
            Vec2d low(1e9, 1e9), high(-1e9, -1e9);
            for (const Vec2d& p : shown)
            {
                outside += !isInside(p, NEW);
                for (int c = 0; c < 2; c++)
                {
                    low[c] = std::min(low[c], p[c]);
                    high[c] = std::max(high[c], p[c]);
                }
            }
            CHECK(outside == 0);
            if (!isCentred)     // it fits on all sides
                CHECK(norm(low) + norm(high - Vec2d(NEW.width - 1, NEW.height - 1)) < 4*BOW);
            CHECK(roi1.area() > 0);
            CHECK(roi1.area() < NEW.area());
            CHECK(invalid(camera, whole, roi1) == 0);
            if (isCentred)
                for (const Mat& K : { all, whole })
                {
                    CHECK(K.at<double>(0, 2) == (NEW.width - 1)/2.);
                    CHECK(K.at<double>(1, 2) == (NEW.height - 1)/2.);
                    CHECK(K.at<double>(0, 0)/K.at<double>(1, 1) == Approx(1));
                }
        }
}

TEST_CASE("The new camera matrix: overloads, planes, and cv::getOptimalNewCameraMatrix without window", "[new_camera_matrix]")
{
    const std::vector<double> D = { -0.28, 0.09, 7e-4, -4e-4 };
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(PLAIN_K, D, paper::pane());
    Rect a, b;
    const Mat K = getOptimalNewRefractiveCameraMatrix(camera, 600., SIZE, 0.3, Size(), &a);
    const std::vector<double> number(1, 600.);
    for (const Mat& same : { getOptimalNewRefractiveCameraMatrix(PLAIN_K, D, paper::pane(), 600., SIZE, 0.3, SIZE, &b),
                             getOptimalNewRefractiveCameraMatrix(camera, number, SIZE, 0.3),
                             getOptimalNewRefractiveCameraMatrix(camera, Vec4d(0, 0, 2, 1200), SIZE, 0.3),
                             getOptimalNewRefractiveCameraMatrix(PLAIN_K, D, paper::pane(), number, SIZE, 0.3) })
        CHECK(norm(K, same, NORM_INF) < 1e-9);
    CHECK(a == b);
    CHECK(norm(K, getOptimalNewRefractiveCameraMatrix(camera, 300., SIZE, 0.3), NORM_INF) > 1);     // the depth counts
    for (bool isCentred : { false, true })
    {
        // calib3d asks for 9x9 places: the same but for where each counts the borders.
        const Mat theirs = getOptimalNewCameraMatrix(PLAIN_K, D, SIZE, 0.3, NEW, nullptr, isCentred);
        const Mat ours = getOptimalNewRefractiveCameraMatrix(PLAIN_K, D, GlassWindow(), INF, SIZE, 0.3, NEW, &a, isCentred);
        CHECK(norm(ours, theirs, NORM_INF) < 0.005*norm(theirs, NORM_INF));
        // A pane of no thickness is no window.
        const GlassWindow nothing(Vec3d(0, 0, 1), 0, 1.5);
        const Mat same = getOptimalNewRefractiveCameraMatrix(PLAIN_K, D, nothing, 600., SIZE, 0.3, NEW, &b, isCentred);
        CHECK(norm(ours, same, NORM_INF) < 1e-9*norm(ours, NORM_INF));
        CHECK(a == b);
    }
}

namespace {

//! How many pixels of a rectangle of the new image have no raw one, strictly, and by how many pixels the farthest is outside.
std::pair<int, double> broken(const Ptr<RefractiveCamera>& camera, const Mat& K, const Rect& where, InputArray depth = Scalar(600))
{
    Mat map, none;
    const Matx33d shift(1, 0, -where.x, 0, 1, -where.y, 0, 0, 1);
    initRefractiveUndistortRectifyMap(camera, depth, noArray(), shift*Matx33d(K.ptr<double>()), where.size(), CV_32FC2, map, none);
    std::pair<int, double> result;
    for (const Vec2f& p : Mat_<Vec2f>(map))
    {
        const double outside = std::max({ -p[0], -p[1], p[0] - (SIZE.width - 1), p[1] - (SIZE.height - 1) });
        result.first += outside > 1e-3;
        result.second = std::max(result.second, outside);
    }
    return result;
}

//! How many raw pixels that see the plane are not in the new image.
int lost(const Ptr<RefractiveCamera>& camera, const Mat& K)
{
    std::vector<Vec2d> raw, shown;
    std::vector<uchar> status;
    for (int y = 0; y < SIZE.height; y++)
        for (int x = 0; x < SIZE.width; x += y % 8 == 0 || y == SIZE.height - 1 ? 1 : 5)
            raw.push_back(Vec2d(x, y));
    refractiveUndistortPoints(raw, shown, camera, 600., noArray(), K, status);
    int count = 0;
    for (size_t i = 0; i < shown.size(); i++)
        count += status[i] == 0 && !(shown[i][0] > -1e-6 && shown[i][1] > -1e-6 && shown[i][0] < SIZE.width - 1 + 1e-6 &&
                                     shown[i][1] < SIZE.height - 1 + 1e-6);
    return count;
}

struct Wide
{
    const char* name;
    Ptr<RefractiveCamera> camera;
    bool isBackward;        //!< some pixels are 89 degrees or more from the axis
};

//! Lenses that fold within the image, and windows that pixels do not see through.
std::vector<Wide> wideCameras()
{
    std::vector<Wide> cameras;
    const auto K = [](double f) { return Matx33d(f, 0, 640, 0, f, 480, 0, 0, 1); };
    const std::vector<double> fish = { 0.01, 0, 0, 0 };
    const GlassWindow none, pane(Vec3d(0.1, 0.1, 1), 15, 1.5, 20), port(Vec3d(-0.2, -0.1, 1), 10, 1.5, 20, 1.33);
    const GlassWindow dome = GlassWindow::dome(Vec3d(6, -4, 9), 50, 5, 1.49, 1.33);
    const GlassWindow tube = GlassWindow::tube(Vec3d(5, 0, 0), Vec3d(0.05, 0, 1), 40, 5, 1.49, 1.33);
    GlassWindow prism = port;
    prism.wedge.push_back(Vec2d(0.048, -0.032));
    for (const GlassWindow& window : { none, pane })
    {
        const auto add = [&](const char* name, double f, const std::vector<double>& D)
        { cameras.push_back({ name, RefractiveCamera::create(K(f), D, window), false }); };
        add("folds in the corners", 640, { -0.33, 0.12, 4e-4, -3e-4, -0.019 });
        add("folds at two borders", 640, { -0.2, 0, 0, 0 });
        add("folds within the image", 640, { -0.4, 0.05, 0, 0 });
        add("ordinary", 1200, { -0.2, 0.1, 0, 0 });
    }
    for (double f : { 500., 600. })
    {
        cameras.push_back({ "wide behind a port", RefractiveCamera::createFisheye(K(f), fish, port), false });
        cameras.push_back({ "wide in a dome", RefractiveCamera::createFisheye(K(f), fish, dome), f < 600 });
    }
    cameras.push_back({ "wide behind a prism", RefractiveCamera::createFisheye(K(500), fish, prism), false });
    // Along the axis of its tube a camera sees nothing: a hole in the image.
    cameras.push_back({ "along its tube", RefractiveCamera::create(K(500), noArray(), tube), false });
    return cameras;
}

} // namespace

TEST_CASE("What is promised of the new image holds where lenses fold or light is totally reflected", "[new_camera_matrix]")
{
    for (const Wide& wide : wideCameras())
        for (double alpha : { 0., 0.5, 1. })
            for (bool isCentred : { false, true })
            {
                if (isCentred && !wide.camera->window().wedge.empty())      // slow where there is no answer
                    continue;
                CAPTURE(wide.name, wide.camera->window().thickness, wide.camera->cameraMatrix(), alpha, isCentred);
                Rect roi;
                Mat K;
                if (wide.isBackward && alpha > 0)
                {
                    CHECK_THAT(thrown([&] { getOptimalNewRefractiveCameraMatrix(wide.camera, 600., SIZE, alpha); }),
                               Contains("alpha is") && Contains("89 degrees"));
                    continue;
                }
                const std::string why = thrown([&] { K = getOptimalNewRefractiveCameraMatrix(wide.camera, 600., SIZE, alpha, Size(), &roi,
                                                                                             isCentred); });
                // The principal point is in the hole, which is in the middle of what is shown.
                if (isCentred && alpha < 1 && wide.name == std::string("along its tube"))
                {
                    CHECK_THAT(why, Contains("does not contain the principal point"));
                    continue;
                }
                REQUIRE(why == "");
                CHECK(broken(wide.camera, K, roi).first == 0);
                CHECK(roi.area() > (alpha < 1 ? 100 : 0));
                if (alpha == 0)
                    CHECK(roi == Rect(Point(), SIZE));
                if (alpha == 1)
                    CHECK(lost(wide.camera, K) == 0);
                // No larger than need be.
                if (alpha == 0 && !isCentred)
                {
                    Mat wider = K.clone();
                    wider.at<double>(0, 0) *= 0.98;
                    wider.at<double>(0, 2) += 0.02*(SIZE.width - 1)/2;
                    wider.at<double>(1, 1) *= 0.98;
                    wider.at<double>(1, 2) += 0.02*(SIZE.height - 1)/2;
                    CHECK(broken(wide.camera, wider, Rect(Point(), SIZE)).first > 0);
                }
            }
}

TEST_CASE("A wall beside the camera, half of which it sees", "[new_camera_matrix]")
{
    const Ptr<RefractiveCamera> camera = someCameras()[0];
    const Vec4d wall(1, 0, 0.1, 150);
    for (double alpha : { 0., 1. })
    {
        Rect roi;
        const Mat K = getOptimalNewRefractiveCameraMatrix(camera, wall, SIZE, alpha, Size(), &roi);
        CHECK(roi.area() > 1000);
        CHECK(broken(camera, K, roi, wall).first == 0);
    }
}

TEST_CASE("Where the new camera matrix differs from calib3d's", "[new_camera_matrix]")
{
    const std::vector<double> ordinary = { -0.2, 0.1, 0, 0, 0 }, folds = { -0.4, 0.05, 0, 0, 0 };
    const Matx33d K(1200, 0, 640, 0, 1200, 480, 0, 0, 1), wide(640, 0, 640, 0, 641, 481, 0, 0, 1);
    Rect roi;
    const Mat theirs = getOptimalNewCameraMatrix(K, ordinary, SIZE, 1, SIZE, &roi);
    const std::pair<int, double> outside = broken(RefractiveCamera::create(K, ordinary), theirs, roi);
    const Mat ours = getOptimalNewRefractiveCameraMatrix(K, ordinary, GlassWindow(), INF, SIZE, 1, SIZE, &roi);
    CHECK(broken(RefractiveCamera::create(K, ordinary), ours, roi).first == 0);
    std::cout << "[numbers] validPixROI of cv::getOptimalNewCameraMatrix, k1 -0.2, k2 0.1, alpha 1: " << outside.first
              << " pixels outside of the raw image, by up to " << outside.second << " px; here none. fx of a lens that folds within the "
              << "image (k1 -0.4), alpha 0: " << getOptimalNewCameraMatrix(wide, folds, SIZE, 0, SIZE).at<double>(0, 0) << ", here "
              << getOptimalNewRefractiveCameraMatrix(wide, folds, GlassWindow(), INF, SIZE, 0, SIZE).at<double>(0, 0) << std::endl;
}

TEST_CASE("Bad arguments of the new camera matrix are named", "[new_camera_matrix]")
{
    const Ptr<RefractiveCamera> camera = someCameras()[0];
    const auto why = [&](double depth, Size size, double alpha, Size newSize)
    { return thrown([&] { getOptimalNewRefractiveCameraMatrix(camera, depth, size, alpha, newSize); }); };
    CHECK(why(600, SIZE, 0, NEW) == "");
    CHECK_THAT(why(-1, SIZE, 0, NEW), Contains("depth is -1"));
    CHECK_THAT(why(600, Size(0, 5), 0, NEW), Contains("imageSize is 0x5"));
    CHECK_THAT(why(600, SIZE, 0, Size(5, -1)), Contains("newImageSize is 5x-1"));
    CHECK_THAT(why(600, SIZE, 1.5, NEW), Contains("alpha is 1.5"));
    CHECK_THAT(why(600, SIZE, NaN, NEW), Contains("alpha is nan"));
    CHECK_THAT(why(30, SIZE, 0, NEW), Contains("a border of the image"));       // within the window
    CHECK_THAT(thrown([&] { getOptimalNewRefractiveCameraMatrix(camera, noArray(), SIZE, 0); }), Contains("depth is empty"));
}
