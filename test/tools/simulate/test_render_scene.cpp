// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Depth of scenes against other ways to compute it, through every window and every lens; what two cameras see of one point.
#include "scenes.hpp"
#include "simulate/render.hpp"

#include <numeric>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

const double SMALLER = 16.;         // images of the lenses in scenes.hpp are larger than this test has time for

Ptr<RefractiveCamera> smallCamera(const scenes::LensKind& lens, const GlassWindow& window)
{
    scenes::LensKind small = lens;
    small.K = Matx33d::diag(Vec3d(1/SMALLER, 1/SMALLER, 1))*lens.K;
    const Ptr<RefractiveCamera> camera = scenes::makeCamera(small, window);
    camera->setImageSize(Size(cvRound(2*small.K(0, 2)), cvRound(2*small.K(1, 2))));
    return camera;
}

//! Something that has depth: a tilted plane, and a ball before it.
struct PlaneAndBall
{
    Vec3d normal, center;
    double distance, radius;        // of the plane: normal.X = distance

    explicit PlaneAndBall(scenes::Random& random)
        : normal(scenes::randomNormal(random, 40)), center(random.vector(150) + Vec3d(0, 0, 700)), distance(0), radius(150)
    {
        distance = normal.dot(Vec3d(0, 0, 1100));
    }

    TexturedScene scene() const
    {
        TexturedScene result;
        result.texture.size = 60;
        result.surfaces = {std::make_shared<Plane>(distance*normal, -3*normal, Vec3d(1, 1, 1)),
                           std::make_shared<Sphere>(center, radius, Vec3d(1, 1, 1))};
        return result;
    }

    //! How far a point is from the nearer surface.
    double miss(const Vec3d& X) const
    {
        return std::min(std::abs(normal.dot(X) - distance), std::abs(norm(X - center) - radius));
    }
};

std::vector<Point2d> allPixels(Size size)
{
    std::vector<Point2d> pixels;
    for (int y = 0; y < size.height; y++)
        for (int x = 0; x < size.width; x++)
            pixels.emplace_back(x, y);
    return pixels;
}

//! Points that pixels see at given depths, NaN where there are none: by a call that the renderer does not use.
std::vector<Vec3d> pointsAt(const std::vector<Point2d>& pixels, const std::vector<double>& depths,
                            const Ptr<RefractiveCamera>& camera)
{
    std::vector<Point2d> normalized;
    refractiveUndistortPoints(pixels, normalized, camera, depths);
    std::vector<Vec3d> points;
    for (size_t i = 0; i < pixels.size(); i++)
        points.emplace_back(depths[i]*normalized[i].x, depths[i]*normalized[i].y, depths[i]);
    return points;
}

//! A pane that bulges towards the camera is a sphere, which closes again: what a grazing ray sees beyond it has no answer.
bool isBehindPane(const GlassWindow& window, const Vec3d& point)
{
    if (!(window.curvature < 0))
        return true;
    const double radius = -1/window.curvature, glass = std::accumulate(window.thickness.begin(), window.thickness.end(), 0.);
    return norm(point - (window.distance + radius)*window.normal) < radius - glass;
}

std::vector<double> asList(const Mat& depth)
{
    std::vector<double> list;
    Mat(depth.reshape(1, (int)depth.total())).convertTo(list, CV_64F);
    return list;
}

//! Depth of the ball on the line through two points: the textbook's quadratic equation. NaN: past it, or too close to say.
double depthOfBall(const Vec3d& a, const Vec3d& b, const PlaneAndBall& what, bool& grazes)
{
    const Vec3d d = b - a, o = a - what.center;
    const double A = d.dot(d), B = 2*d.dot(o), C = o.dot(o) - what.radius*what.radius, root = B*B - 4*A*C;
    grazes = std::abs(root) < 1e-4*A*what.radius*what.radius;
    return root < 0 ? scenes::NaN : (a + (-B - std::sqrt(root))/(2*A)*d)[2];
}

GlassWindow pane() { return GlassWindow(normalize(Vec3d(-0.2, 0.1, 1)), 25, 1.517, 60); }

Ptr<RefractiveCamera> plainCamera(const GlassWindow& window, Size size = Size(160, 120), double f = 200)
{
    const Ptr<RefractiveCamera> camera =
        RefractiveCamera::create(Matx33d(f, 0, size.width/2, 0, f, size.height/2, 0, 0, 1), noArray(), window);
    camera->setImageSize(size);
    return camera;
}

Viewpoint at(const Ptr<RefractiveCamera>& camera) { return {camera, Matx33d::eye(), Vec3d()}; }

TexturedScene sceneOf(const std::shared_ptr<const Surface>& surface)
{
    TexturedScene scene;
    scene.surfaces = {surface};
    scene.texture.size = 60;
    return scene;
}

//! Away from outlines.
bool isSmooth(const Mat& depth, const Point& pixel)
{
    double least, most;
    minMaxLoc(depth(Rect(pixel - Point(4, 4), Size(9, 9))), &least, &most);
    return most - least < 25;
}

} // namespace

TEST_CASE("a pixel's depth is on the first surface, and its point is seen in that pixel", "[simulate][scene]")
{
    CAPTURE(scenes::seed());
    scenes::Random random(901);
    double worstPixel = 0;
    size_t count = 0;
    for (const scenes::WindowKind kind : scenes::allWindows())
        for (const scenes::LensKind& lens : scenes::allLenses())
        {
            CAPTURE(scenes::name(kind), lens.name);
            const Ptr<RefractiveCamera> camera = smallCamera(lens, scenes::makeWindow(kind, random));
            const PlaneAndBall what(random);
            const Mat depth = depthOfScene(what.scene(), at(camera));
            REQUIRE(depth.size() == camera->imageSize());
            REQUIRE(depth.type() == CV_32F);
            std::vector<Point2d> pixels, seenAt;
            std::vector<double> depths;
            std::vector<Vec3d> origins, directions;
            const std::vector<Point2d> all = allPixels(depth.size());
            refractiveUnprojectPoints(all, origins, directions, camera);
            for (size_t i = 0; i < all.size(); i++)
            {
                const double z = depth.at<float>(all[i]);
                // At the edge of a fisheye's image z is next to nothing: no way to a point.
                if (z > 50 && isBehindPane(camera->window(), origins[i] + (z - origins[i][2])/directions[i][2]*directions[i]))
                {
                    pixels.push_back(all[i]);
                    depths.push_back(z);
                }
            }
            REQUIRE(pixels.size() > depth.total()/10);       // total reflection leaves a cone
            const std::vector<Vec3d> points = pointsAt(pixels, depths, camera);
            std::vector<double> next;
            for (const double z : depths)
                next.push_back(z + 1e-4);
            const std::vector<Vec3d> along = pointsAt(pixels, next, camera);
            refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, seenAt);
            for (size_t i = 0; i < pixels.size(); i++)
            {
                const double range = norm(points[i]), beside = norm(seenAt[i] - pixels[i]);
                // A ray along which z hardly grows is one on which a float32 z does not tell the point.
                const double rounding = depths[i]*std::numeric_limits<float>::epsilon()*norm(along[i] - points[i])/1e-4;
                const double miss = std::max(what.miss(points[i]) - rounding, 0.)/range;
                worstPixel = std::max(worstPixel, beside);
                if (!(beside < 1e-6 && miss < 1e-6))
                    FAIL_CHECK(pixels[i] << " sees " << points[i] << " seen at " << seenAt[i]);
            }
            count += pixels.size();
        }
    scenes::printNumber("depth of a rendered scene, " + std::to_string(count) + " pixels: point seen beside its pixel",
                        worstPixel, "px");
}

TEST_CASE("the depth is that of the closed forms, and NaN where they have none", "[simulate][scene]")
{
    CAPTURE(scenes::seed());
    scenes::Random random(902);
    for (const scenes::WindowKind kind : scenes::allWindows())
        for (const scenes::LensKind& lens : scenes::allLenses())
        {
            if (lens.model == "fisheye")       // lines through two depths go where z grows only
                continue;
            CAPTURE(scenes::name(kind), lens.name);
            const Ptr<RefractiveCamera> camera = smallCamera(lens, scenes::makeWindow(kind, random));
            const PlaneAndBall what(random);
            const std::vector<double> depth = asList(depthOfScene(what.scene(), at(camera)));
            const std::vector<Point2d> pixels = allPixels(camera->imageSize());
            const std::vector<double> near(pixels.size(), 400.), far(pixels.size(), 900.);
            const std::vector<Vec3d> a = pointsAt(pixels, near, camera), b = pointsAt(pixels, far, camera);
            std::vector<Vec3d> onPlane;
            refractivePointsOnPlane(pixels, onPlane, camera,
                                    Vec4d(what.normal[0], what.normal[1], what.normal[2], what.distance));
            int ofBall = 0, wrong = 0;
            for (size_t i = 0; i < pixels.size(); i++)
            {
                bool grazes = false;
                const double ball = depthOfBall(a[i], b[i], what, grazes), plane = onPlane[i][2];
                const double expected = ball < plane || std::isnan(plane) ? ball : plane;
                ofBall += expected == ball;
                const bool same = std::isnan(expected) ? std::isnan(depth[i])
                                                       : std::abs(depth[i] - expected) < 1e-6*std::abs(expected) + 1e-9;
                wrong += !grazes && !same;
            }
            CHECK(ofBall > 20);
            CHECK(wrong == 0);
        }
}

TEST_CASE("nothing before the window's last surface is seen", "[simulate][scene]")
{
    const Ptr<RefractiveCamera> behind = plainCamera(pane()), open = plainCamera(GlassWindow());
    for (const double z : {20., 70.})       // between camera and glass, in the glass
    {
        const TexturedScene scene = sceneOf(std::make_shared<Plane>(Vec3d(0, 0, z), Vec3d(0, 0, 1), Vec3d(1, 1, 1)));
        const Mat seen = depthOfScene(scene, at(open)), hidden = depthOfScene(scene, at(behind));
        CHECK(countNonZero(seen == (float)z) == (int)seen.total());
        const int beyond = countNonZero(hidden == hidden);
        CHECK((z == 20 ? beyond == 0 : beyond < (int)hidden.total()/2));
        // What is seen of it lies beyond.
        const std::vector<Point2d> pixels = allPixels(hidden.size());
        const std::vector<double> depths = asList(hidden);
        std::vector<Vec3d> points;
        refractivePointsOnPlane(pixels, points, behind, Vec4d(0, 0, 1, z));
        for (size_t i = 0; i < pixels.size(); i++)
            if (std::isnan(depths[i]) != std::isnan(points[i][2]))
                FAIL_CHECK(pixels[i]);
    }
    // A ball round the camera: its far side.
    const Mat inside = depthOfScene(sceneOf(std::make_shared<Sphere>(Vec3d(), 500., Vec3d(1, 1, 1))), at(behind));
    CHECK(countNonZero(inside == inside) == (int)inside.total());
    CHECK(std::abs(inside.at<float>(60, 80) - 500) < 0.1);
}

TEST_CASE("a rectangle ends where it says", "[simulate][scene]")
{
    const Ptr<RefractiveCamera> camera = plainCamera(GlassWindow());        // 80, 60: the axis; 1 px is 5 mm at 1000 mm
    const Vec3d slanted(1, 0, 0.5);         // of which what is along the normal does not count
    const Mat depth = depthOfScene(sceneOf(std::make_shared<Plane>(Vec3d(50, 0, 1000), Vec3d(0, 0, -1), slanted,
                                                                   Size2d(103, 52), Vec3d(1, 1, 1))), at(camera));
    for (int y = 0; y < depth.rows; y++)
        for (int x = 0; x < depth.cols; x++)
        {
            const bool inside = std::abs((x - 80)*5 - 50) <= 103 && std::abs((y - 60)*5) <= 52;
            if (std::isnan(depth.at<float>(y, x)) == inside)
                FAIL_CHECK(x << " " << y);
        }
}

TEST_CASE("two cameras see a point in the same grey, with windows and without", "[simulate][scene]")
{
    CAPTURE(scenes::seed());
    scenes::Random random(903);
    Exposure exposure;
    exposure.noise = 0;
    const PlaneAndBall what(random);
    TexturedScene scene = what.scene();
    scene.texture = {200, 0.9, 3};          // coarse, so that reading between pixels is exact enough
    Matx33d R;
    Rodrigues(Vec3d(0.01, 0.18, -0.02), R);
    const Vec3d T(-150, 2, 15);
    for (const bool window : {true, false})
    {
        const GlassWindow second(normalize(Vec3d(0.15, -0.15, 1)), 25, 1.517, 40);
        const Viewpoint one = at(plainCamera(window ? pane() : GlassWindow(), Size(320, 240), 400));
        const Viewpoint two{plainCamera(window ? second : GlassWindow(), Size(320, 240), 400), R, T};
        const Mat image1 = renderScene(scene, one, exposure, 1), image2 = renderScene(scene, two, exposure, 2);
        const Mat depth1 = depthOfScene(scene, one), depth2 = depthOfScene(scene, two);
        const std::vector<Point2d> pixels = allPixels(image1.size());
        const std::vector<Vec3d> points = pointsAt(pixels, asList(depth1), one.camera);
        std::vector<Point2d> partners;
        Vec3d rvec;
        Rodrigues(R, rvec);
        refractiveProjectPoints(points, rvec, T, two.camera, partners);
        int count = 0;
        double squares = 0;
        Mat there, fine;
        for (Point2d& p : partners)
            p = std::isnan(p.x) ? Point2d(-1, -1) : p;
        Mat(partners).reshape(2, image1.rows).convertTo(there, CV_32F);
        image2.convertTo(fine, CV_32F);
        remap(fine, there, there, noArray(), INTER_LANCZOS4);
        for (size_t i = 0; i < pixels.size(); i++)
        {
            if (!Rect(10, 10, 300, 220).contains(Point(pixels[i])) || !Rect2d(10, 10, 300, 220).contains(partners[i]))
                continue;
            const Point nearest(cvRound(partners[i].x), cvRound(partners[i].y));
            if (!isSmooth(depth1, Point(pixels[i])) || !isSmooth(depth2, nearest)
                || std::abs(depth2.at<float>(nearest) - two.depthOf(points[i])) > 5)      // hidden
                continue;
            squares += std::pow(image1.at<Vec3b>(Point(pixels[i]))[1] - there.at<Vec3f>(Point(pixels[i]))[1], 2);
            count++;
        }
        CHECK(count > 20000);
        const double rms = std::sqrt(squares/count);
        scenes::printNumber(std::string("grey of a point in two cameras, ") + (window ? "with" : "without") + " windows, RMS",
                            rms, "of 255");
        CHECK(rms < 0.7);       // 8 bits of two images alone: 0.4
        if (window)
            continue;
        Scalar mean, deviation;
        meanStdDev(image1, mean, deviation);
        CHECK(deviation[1] > 15);
    }
}

TEST_CASE("the texture has contrast within a few pixels, near and far", "[simulate][scene]")
{
    Exposure exposure;
    exposure.noise = 0;
    for (const double z : {450., 1150., 3000.})
    {
        const TexturedScene scene = sceneOf(std::make_shared<Plane>(Vec3d(0, 0, z), Vec3d(0, 0, 1), Vec3d(1, 1, 1)));
        Mat image, grey, mean, square;
        image = renderScene(scene, at(plainCamera(pane(), Size(320, 240), 780)), exposure, 1);
        REQUIRE(image.type() == CV_8UC3);
        cvtColor(image, grey, COLOR_BGR2GRAY);
        grey.convertTo(grey, CV_32F);
        blur(grey, mean, Size(5, 5));
        blur(grey.mul(grey), square, Size(5, 5));
        Mat variance = square - mean.mul(mean);
        double least;
        minMaxLoc(variance, &least);
        const double rms = std::sqrt(cv::mean(variance)[0]);
        std::nth_element(variance.begin<float>(), variance.begin<float>() + variance.total()/100, variance.end<float>());
        const double weak = std::sqrt((double)*(variance.begin<float>() + variance.total()/100));
        CAPTURE(z);
        scenes::printNumber("contrast in 5x5 pixels at " + std::to_string((int)z) + " mm, RMS and that of the weakest hundredth",
                            std::to_string(rms) + " " + std::to_string(weak), "of 255");
        CHECK(rms > 8);
        CHECK(weak > 2.5);
    }
}

TEST_CASE("light, dark, background and colour are what they are called", "[simulate][scene]")
{
    Exposure exposure;
    exposure.noise = 0;
    exposure.background = 99;
    TexturedScene scene = sceneOf(std::make_shared<Plane>(Vec3d(0, 0, 1000), Vec3d(0.5, 0.6, 0.8), Vec3d(1, 0.5, 0)));
    scene.texture.contrast = 0;
    const Mat lit = renderScene(scene, at(plainCamera(pane())), exposure, 1);
    CHECK(lit.at<Vec3b>(60, 80) == Vec3b(35, 120, 205));       // blue, green, red
    scene.surfaces = {std::make_shared<Sphere>(Vec3d(0, 0, -1000), 10, Vec3d(1, 1, 1))};
    const Mat empty = renderScene(scene, at(plainCamera(pane())), exposure, 1);
    CHECK(empty.at<Vec3b>(60, 80) == Vec3b(99, 99, 99));
}

TEST_CASE("noise is of the given size, in each colour its own", "[simulate][scene]")
{
    Exposure exposure;
    exposure.noise = 3;
    TexturedScene scene = sceneOf(std::make_shared<Plane>(Vec3d(0, 0, 1000), Vec3d(0, 0, 1), Vec3d(1, 1, 1)));
    scene.texture.contrast = 0;
    const Viewpoint view = at(plainCamera(pane()));
    const Mat image = renderScene(scene, view, exposure, 1);
    CHECK(norm(image, renderScene(scene, view, exposure, 1), NORM_INF) == 0);
    CHECK(norm(image, renderScene(scene, view, exposure, 2), NORM_INF) > 3);
    Mat channels[3];
    split(image, channels);
    for (int i = 0; i < 3; i++)
    {
        Mat difference;
        channels[i].convertTo(channels[i], CV_32F);
        channels[(i + 1)%3].convertTo(difference, CV_32F);
        difference -= channels[i];
        Scalar mean, one, both;
        meanStdDev(channels[i], mean, one);
        meanStdDev(difference, mean, both);
        CHECK(std::abs(one[0] - 3) < 0.1);
        CHECK(std::abs(both[0] - 3*std::sqrt(2.)) < 0.15);
    }
}
