// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Targets whose dots are on any levels: which dot of an image is which, and where it is.
#include "console/failure.hpp"
#include "drawn_dots.hpp"
#include "paths.hpp"
#include "target/dot_target.hpp"
#include "temporary_folder.hpp"
#include <opencv2/calib3d.hpp>
#include <fstream>

using namespace tools;
using cv::Matx33d;
using cv::Point2d;
using cv::Point3d;
using cv::Ptr;
using cv::Size;
using cv::Vec3d;
using cv::refract::GlassWindow;
using cv::refract::RefractiveCamera;

namespace {

const Size IMAGE(1280, 1024);

Ptr<RefractiveCamera> cameraOf(double focal)
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d(focal, 0, 640, 0, focal, 512, 0, 0, 1),
        std::vector<double>{-0.1, 0, 0, 0}, GlassWindow(Vec3d(0.1, -0.05, 1), 6, 1.5, 100, 1.333));
    camera->setImageSize(IMAGE);
    return camera;
}

//! The target's middle before the camera, so far that it takes about half of the image; from the front or from behind.
void place(scenes::Random& random, double focal, Vec3d& rvec, Vec3d& tvec)
{
    Matx33d turn, tilt;
    cv::Rodrigues(Vec3d(0, 0, random.uniform(-CV_PI, CV_PI)), turn);
    cv::Rodrigues(Vec3d(random.uniform(-0.5, 0.5) + (random.below(2) ? CV_PI : 0.), random.uniform(-0.5, 0.5), 0), tilt);
    cv::Rodrigues(turn*tilt, rvec);
    tvec = Vec3d(random.uniform(-5, 5), random.uniform(-5, 5), 70*focal/600*random.uniform(1., 1.3)*1.3);
}

std::string saved(const TemporaryFolder& f, const std::string& text)
{
    std::ofstream(f / "dots.csv") << text;
    return f / "dots.csv";
}

} // namespace

TEST_CASE("Which dot is which is told on several levels, from both sides, among others and with some missing", "[target][dots]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    scenes::Random random(4510);
    const std::vector<Point3d> target = drawn_dots::threeLevels();
    const int TRIALS = scenes::trials(12);
    int wrong = 0;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        const double focal = random.uniform(1500, 6000);
        Vec3d rvec, tvec;
        place(random, focal, rvec, tvec);
        std::vector<Point2d> pixels, seen;
        cv::refract::refractiveProjectPoints(target, rvec, tvec, cameraOf(focal), pixels);
        std::vector<int> expected(target.size(), -1);
        for (size_t i = 0; i < pixels.size(); i++)
        {
            const bool tellsTurn = target[i].x == 30 && std::abs(target[i].y) == 15;     // without them it is the same the other way round
            if (cv::Rect2d(0, 0, IMAGE.width, IMAGE.height).contains(pixels[i]) && (random.uniform(0, 1) > 0.15 || tellsTurn))
            {
                expected[i] = (int)seen.size();
                seen.push_back(pixels[i] + Point2d(random.normal(0.3), random.normal(0.3)));
            }
        }
        for (int i = 0; i < 60; i++)
            seen.emplace_back(random.uniform(0, IMAGE.width - 1), random.uniform(0, IMAGE.height - 1));
        const std::vector<int> found = matchDots(target, seen, IMAGE);
        int right = 0, other = 0, all = 0;
        for (size_t i = 0; i < expected.size() && i < found.size(); i++)
        {
            right += expected[i] >= 0 && found[i] == expected[i];
            other += found[i] >= 0 && found[i] != expected[i];
            all += expected[i] >= 0;
        }
        CAPTURE(trial, focal, rvec, tvec, right, other, all, found.size());
        CHECK(other <= 2);
        CHECK(right >= 0.95*all);
        wrong += !(other <= 2 && right >= 0.95*all) || found.empty();
    }
    CHECK(wrong == 0);
}

TEST_CASE("The dots of a target on three levels are found in a picture, to parts of a pixel", "[target][dots]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    scenes::Random random(4511);
    const std::vector<Point3d> target = drawn_dots::threeLevels();
    for (double radius : {0.4, 1.2})
    {
        Vec3d rvec, tvec;
        place(random, 4000, rvec, tvec);
        std::vector<Point2d> pixels;
        cv::refract::refractiveProjectPoints(target, rvec, tvec, cameraOf(4000), pixels);
        const cv::Mat picture = drawn_dots::picture(target, radius, rvec, tvec, cameraOf(4000), random);
        const std::vector<Point2d> found = detectListedDots(picture, target);
        REQUIRE(found.size() == target.size());
        double sum = 0., worst = 0.;
        int count = 0;
        for (size_t i = 0; i < found.size(); i++)
            if (found[i].x == found[i].x)
            {
                const double off = cv::norm(found[i] - pixels[i]);
                sum += off*off;
                worst = std::max(worst, off);
                count++;
            }
        std::cout << "[numbers] dots of " << radius << " mm on three levels: " << count << " of " << found.size() << ", "
                  << std::sqrt(sum/count) << " px RMS, at most " << worst << '\n';
        CHECK(count >= 0.95*(double)target.size());
        CHECK(std::sqrt(sum/count) < 0.1);
    }
}

TEST_CASE("A picture without the dots of a target has none", "[target][dots]")
{
    scenes::Random random(4512);
    std::vector<Point3d> other;
    for (int i = 0; i < 60; i++)
        other.emplace_back(random.uniform(-40, 40), random.uniform(-30, 30), 0);
    CHECK(detectListedDots(drawn_dots::picture(other, 0.8, Vec3d(), Vec3d(0, 0, 400), cameraOf(4000), random),
                           drawn_dots::threeLevels()).empty());
    CHECK(matchDots(drawn_dots::threeLevels(), {}, IMAGE).empty());
}

TEST_CASE("A list of dots is read with a heading, or as OpenPTV has it, or refused in a sentence", "[target][dots]")
{
    const TemporaryFolder f;
    std::string rows, plain;
    for (int i = 0; i < 9; i++)
    {
        rows += cv::format("p%d,%d,%d,%d\n", i, i % 3, i/3, i % 2);
        plain += cv::format("%d\t%d %d  %d\n", i + 1, i % 3, i/3, i % 2);
    }
    const ListedDots named = readListedDots(saved(f, "id,x,y,z\n" + rows)), numbered = readListedDots(saved(f, plain));
    CHECK(named.ids[8] == "p8");
    CHECK(numbered.ids[8] == "9");
    CHECK(named.points == numbered.points);
    CHECK(named.points[5] == Point3d(2, 1, 1));
    const auto refused = [&](const std::string& text, const std::string& said) {
        CHECK_THROWS_WITH(readListedDots(saved(f, text)), Catch::Contains(said));
    };
    refused("id,x,y,z\np1,0,0,0\np2,1,0,0\n", "has 2 dots, and a target has 8 or more");
    refused("id,x,y,z\n" + rows + "p3,7,7,7\n", "line 11: the same id as in line 5");
    refused("id,x,y,z\n" + rows + "q,0,1,1\n", "line 11: the same place as in line 5");
    refused("id,x,y\n" + rows, "there is no column 'z'");
    refused(plain + "10 1 2\n", "line 10: number, x, y and z of a dot are expected");
    refused("", "has no rows");
}
