// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Two cameras under water, each in a dome that it is not in the centre of. The lenses and the places of the cameras are known from
// images in air; a hand-held board under water tells where the centres are. What the drawing says of the domes is a prior: it goes
// into every +-. Then fresh points are measured.
//
//   calibrate_dome [--seed=1]

#include <opencv2/calib3d.hpp>
#include <opencv2/refract.hpp>
#include <iostream>
#include <limits>

using namespace cv;
using namespace cv::refract;

static const double WATER = 1.333, SIGMA = 0.1;        // pixels

static std::vector<Point3d> board()
{
    std::vector<Point3d> points;
    for (int i = 0; i < 63; i++)
        points.push_back(Point3d(30*(i % 9 - 4), 30*(i/9 - 3), 0));
    return points;
}

//! Pixels of points in the frame of camera 1 moved by rvec, tvec; with noise.
static std::vector<Point2d> look(const std::vector<Point3d>& points, const Ptr<RefractiveCamera>& camera, const Vec3d& rvec,
                                 const Vec3d& tvec, RNG& rng)
{
    std::vector<Point2d> pixels;
    refractiveProjectPoints(points, rvec, tvec, camera, pixels);
    for (size_t i = 0; i < pixels.size(); i++)
        pixels[i] += Point2d(rng.gaussian(SIGMA), rng.gaussian(SIGMA));
    return pixels;
}

//! Radius, thickness and index as the drawing has them; of all else nothing is known, the centre included.
static Mat priorOf(const Ptr<RefractiveCamera>& camera)
{
    const std::vector<String> names = camera->parameterNames();
    Mat covariance = Mat::diag(Mat((int)names.size(), 1, CV_64F, Scalar(std::numeric_limits<double>::quiet_NaN())));
    for (int i = 0; i < (int)names.size(); i++)
    {
        const double sigma = names[i] == "radius" ? 0.3 : names[i] == "thickness[0]" ? 0.1 : names[i] == "index[0]" ? 0.002 : 0;
        if (sigma > 0)
            covariance.at<double>(i, i) = sigma*sigma;
    }
    return covariance;
}

int main(int argc, char** argv)
{
    const CommandLineParser args(argc, argv, "{seed | 1 | of the noise}");
    RNG rng(7654321*(uint64)args.get<int>("seed"));     // small numbers start the generator alike
    const Matx33d K(1400, 0, 640, 0, 1400, 512, 0, 0, 1);
    const std::vector<double> distortion{ -0.1, 0.05, 0, 0 };
    const Vec3d turn(0, -0.2, 0), T(-150, 0, 15);       // camera 1 -> camera 2
    Matx33d R;
    Rodrigues(turn, R);
    const std::vector<Mat> Rs{ Mat::eye(3, 3, CV_64F), Mat(R) }, Ts{ Mat::zeros(3, 1, CV_64F), Mat(T) };
    const Vec3d centers[] = { Vec3d(3, -2, 8), Vec3d(-2, 4, 12) };

    std::vector<Ptr<RefractiveCamera> > truth, found, bare;
    std::vector<Mat> priors;
    for (int c = 0; c < 2; c++)
    {
        truth.push_back(RefractiveCamera::create(K, distortion, GlassWindow::dome(centers[c], 70.2, 7.1, 1.491, WATER)));
        found.push_back(RefractiveCamera::create(K, distortion, GlassWindow::dome(Vec3d(), 70, 7, 1.49, WATER)));
        bare.push_back(RefractiveCamera::create(K, distortion));
        priors.push_back(priorOf(found[c]));
    }

    const std::vector<std::vector<Point3d> > object(15, board());
    std::vector<std::vector<Mat> > seen(2);
    for (size_t view = 0; view < object.size(); view++)
    {
        const Vec3d rvec(rng.uniform(-0.4, 0.4), rng.uniform(-0.4, 0.4), rng.uniform(-0.2, 0.2));
        const Vec3d tvec(rng.uniform(-60., 60.), rng.uniform(-50., 50.), rng.uniform(450., 900.));
        Matx33d toCamera1;
        Vec3d rvec2;
        Rodrigues(rvec, toCamera1);
        Rodrigues(R*toCamera1, rvec2);
        seen[0].push_back(Mat(look(object[view], truth[0], rvec, tvec, rng), true));
        seen[1].push_back(Mat(look(object[view], truth[1], rvec2, R*tvec + T, rng), true));
    }
    std::vector<Mat> rvecs, tvecs;
    GlassRigOptions options;
    options.cameraCovariances = priors;
    const GlassRigResult result = calibrateGlassRig(object, std::vector<std::vector<Mat> >(), seen, found, std::vector<int>(), Rs, Ts,
                                                    rvecs, tvecs, options);
    std::cout << format("15 boards under water: RMS %.3f px", result.rms) << std::endl;
    const int first = (int)found[0]->lensParameters().total(), count = (int)found[0]->parameterNames().size();
    for (int c = 0; c < 2; c++)
    {
        const Vec3d center = found[c]->window().center;
        std::cout << format("centre of dome %d: (%.3f, %.3f, %.3f) mm, off by %.3f, stated +- %.3f", c + 1, center[0], center[1], center[2],
                            norm(center - centers[c]),
                            norm(result.stdDeviations.rowRange(c*count + first, c*count + first + 3))) << std::endl;
    }

    std::vector<Point3d> points;
    for (int i = 0; i < 500; i++)
        points.push_back(Point3d(rng.uniform(-100., 100.), rng.uniform(-80., 80.), rng.uniform(450., 900.)));
    const std::vector<Point2d> left = look(points, truth[0], Vec3d(), Vec3d(), rng), right = look(points, truth[1], turn, T, rng);
    const std::vector<Ptr<RefractiveCamera> >* const ways[] = { &bare, &found, &truth };
    const char* const names[] = { "domes ignored", "domes as calibrated", "domes as they are" };
    for (int way = 0; way < 3; way++)
    {
        std::vector<Point3d> measured;
        triangulateRefractive((*ways[way])[0], (*ways[way])[1], R, T, left, right, measured);
        std::cout << format("%-20s points off by %.3f mm RMS", names[way], norm(measured, points)/std::sqrt((double)points.size()))
                  << std::endl;
    }
    return 0;
}
