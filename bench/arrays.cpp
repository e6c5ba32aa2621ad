// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A ring of cameras above a tank, looking straight down: of boards under water each sees some, in part. Lenses are known; where the
// cameras are and where the surface is, is not.
#include "arrays.hpp"
#include "measure.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/refract.hpp>

#include <cstdio>
#include <random>

using namespace cv;
using namespace cv::refract;

namespace bench {

namespace {

const double HEIGHT = 1031, RADIUS = 650, SQUARE = 60, WATER = 1.333;       // mm
const int COLUMNS = 11, ROWS = 8, FEWEST = 8;
const double SIGMA = 0.5;               // px
const Size IMAGE(1600, 1200);

struct Ring
{
    std::vector<Ptr<RefractiveCamera> > cameras;
    std::vector<Mat> Rs, Ts;
    std::vector<std::vector<Point3d> > object;
    std::vector<std::vector<Mat> > images;
};

GlassWindow surface(double distance)
{
    GlassWindow window;
    window.distance = distance;
    window.outerIndex = WATER;
    return window;
}

std::vector<Point3d> board()
{
    std::vector<Point3d> points;
    for (int i = 0; i < COLUMNS*ROWS; i++)
        points.push_back(SQUARE*Point3d(i % COLUMNS - 0.5*(COLUMNS - 1), i/COLUMNS - 0.5*(ROWS - 1), 0));
    return points;
}

//! Pixels of one board; none where fewer than some are in the image.
Mat look(const Ptr<RefractiveCamera>& camera, const std::vector<Point3d>& object, const Matx33d& R, const Vec3d& t,
         std::mt19937_64& engine)
{
    std::normal_distribution<double> noise(0, SIGMA);
    std::vector<Point2d> pixels;
    std::vector<uchar> status;
    refractiveProjectPoints(object, R, t, camera, pixels, status);
    int count = 0;
    for (size_t i = 0; i < pixels.size(); i++)
    {
        const bool isSeen = status[i] == REFRACT_OK && Rect2d(0, 0, IMAGE.width, IMAGE.height).contains(pixels[i]);
        pixels[i] = isSeen ? pixels[i] + Point2d(noise(engine), noise(engine)) : Point2d(NAN, NAN);
        count += isSeen;
    }
    return count < FEWEST ? Mat() : Mat(pixels, true);
}

Ring makeRing(int cameras, int boards)
{
    std::mt19937_64 engine(42);
    const auto uniform = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine); };
    Ring ring;
    const Matx33d K(1588, 0, 780, 0, 1588, 602, 0, 0, 1);
    const std::vector<double> D = { -0.2, 0.05, 0.0006, 0.0025, 0 };
    for (int c = 0; c < cameras; c++)
    {
        const double angle = 2*CV_PI*c/cameras;
        ring.cameras.push_back(RefractiveCamera::create(K, D, surface(HEIGHT)));
        ring.Rs.push_back(Mat::eye(3, 3, CV_64F));
        ring.Ts.push_back(Mat(-RADIUS*Vec3d(std::cos(angle) - 1, std::sin(angle), 0), true));
    }
    ring.images.resize(cameras);
    for (int view = 0; view < boards; view++)
    {
        ring.object.push_back(board());
        const Vec3d rvec(uniform(-0.35, 0.35), uniform(-0.35, 0.35), uniform(-CV_PI, CV_PI));
        const Vec3d tvec(uniform(-700, 700) - RADIUS, uniform(-700, 700), uniform(1250, 2000));
        Matx33d R;
        Rodrigues(rvec, R);
        for (int c = 0; c < cameras; c++)
            ring.images[c].push_back(look(ring.cameras[c], ring.object.back(), R, tvec + Vec3d(ring.Ts[c]), engine));
    }
    return ring;
}

//! Root of the mean square of errors over what is stated: of R and T of the cameras, and of the surface's distance.
double overStated(const Ring& truth, const Ring& found, const Mat& deviations)
{
    double squares = 0;
    int count = 0, row = 0;
    for (const Ptr<RefractiveCamera>& camera : found.cameras)
    {
        const int distance = row + (int)camera->lensParameters().total() + 3;
        if (row == 0)
        {
            squares += std::pow((camera->window().distance - HEIGHT)/deviations.at<double>(distance), 2);
            count++;
        }
        row += (int)camera->parameterNames().size();
    }
    for (size_t c = 1; c < found.cameras.size(); c++, row += 6)
    {
        Vec3d rvec;
        Rodrigues(found.Rs[c], rvec);
        for (int i = 0; i < 3; i++, count += 2)
            squares += std::pow(rvec[i]/deviations.at<double>(row + i), 2) +
                       std::pow((found.Ts[c].at<double>(i) - truth.Ts[c].at<double>(i))/deviations.at<double>(row + 3 + i), 2);
    }
    return std::sqrt(squares/count);
}

void run(int cameras, int boards)
{
    const Ring truth = makeRing(cameras, boards);
    Ring start = truth;
    for (int c = 0; c < cameras; c++)
    {
        start.cameras[c] = truth.cameras[c]->clone();
        start.cameras[c]->setWindow(surface(0));
        start.Rs[c] = Mat::eye(3, 3, CV_64F);
        start.Ts[c] = Mat::zeros(3, 1, CV_64F);
    }
    std::vector<Mat> rvecs, tvecs;
    const double begin = processorSeconds(), clock = (double)getTickCount();
    const GlassRigResult found = calibrateGlassRig(start.object, {}, start.images, start.cameras, std::vector<int>(cameras, 0), start.Rs,
                                                   start.Ts, rvecs, tvecs, GlassRigOptions(GLASS_FREE_DISTANCE | GLASS_FREE_EXTRINSICS));
    const double seconds = processorSeconds() - begin, elapsed = ((double)getTickCount() - clock)/getTickFrequency();
    std::printf("%10d%10d%10.1f%10.1f%12.4f%12.2f\n", cameras, boards, seconds, elapsed, found.rms,
                overStated(truth, start, found.stdDeviations));
    std::fflush(stdout);
}

} // namespace

void printArrays(int most)
{
    std::printf("%10s%10s%10s%10s%12s%12s\n", "cameras", "boards", "CPU, s", "clock, s", "RMS, px", "error/sigma");
    for (int cameras = 3; cameras <= most; cameras *= 2)
        run(cameras, 5*cameras/2);
}

} // namespace bench
