// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A camera and a fringe projector, each behind its own window: images of fringes -> phases -> points with their covariance. The
// projector is a camera that sees u of each point, and not v: (u, NaN). Any other code (Gray code, cv::structured_light) gives u just as
// well.
//
//   points_from_fringes [--rig=rig.yml --images=fringes/scene_%d.jpg]

#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/refract.hpp>
#include <iostream>
#include <limits>

using namespace cv;
using namespace cv::refract;

//! Fringes of one period: I_k = A + B cos(phase - 2 pi k/steps).
struct Fringes
{
    Mat phase, amplitude;
    double noise;               //!< grey levels, from what the four images contradict each other by
};

static Fringes decode(const String& pattern, int first, int steps)
{
    Mat s, c, alternating;
    for (int k = 0; k < steps; k++)
    {
        Mat grey = imread(format(pattern.c_str(), first + k), IMREAD_GRAYSCALE);
        if (grey.empty())
            CV_Error(Error::StsError, "cannot read " + format(pattern.c_str(), first + k));
        grey.convertTo(grey, CV_64F);
        s = k ? Mat(s + std::sin(2*CV_PI*k/steps)*grey) : Mat(std::sin(0.)*grey);
        c = k ? Mat(c + std::cos(2*CV_PI*k/steps)*grey) : grey.clone();
        alternating = k ? Mat(alternating + (k % 2 ? -1. : 1.)*grey) : grey.clone();
    }
    Fringes result;
    cartToPolar(c, s, result.amplitude, result.phase);
    result.amplitude *= 2./steps;
    Scalar mean, deviation;
    meanStdDev(alternating, mean, deviation);       // of four steps neither A nor B has a part in it
    result.noise = deviation[0]/std::sqrt((double)steps);
    return result;
}

//! Distance from the nearer of the scene's planes, RMS; with covariances over what they state.
static double distanceRms(const std::vector<Point3d>& points, const Mat& covariances, const FileNode& scene)
{
    double squares = 0;
    int count = 0;
    for (size_t i = 0; i < points.size(); i++)
    {
        if (points[i].x != points[i].x)
            continue;
        double nearest = 1e9, sigma = 1;
        for (const FileNode& plane : scene)
        {
            Vec3d point, normal;
            plane["point"] >> point;
            plane["normal"] >> normal;
            normal /= norm(normal);
            const double distance = normal.dot(Vec3d(points[i]) - point);
            if (std::abs(distance) < std::abs(nearest))
            {
                nearest = distance;
                if (!covariances.empty())
                    sigma = std::sqrt(normal.dot(Matx33d(covariances.ptr<double>((int)i))*normal));
            }
        }
        squares += nearest*nearest/(sigma*sigma);
        count++;
    }
    return std::sqrt(squares/count);
}

int main(int argc, char** argv)
{
    const CommandLineParser args(argc, argv,
        "{rig    | samples/data/projector/rig.yml | camera, projector (rvec, tvec: camera -> projector), and the scene}"
        "{images | samples/data/projector/fringes/scene_%d.jpg | four images of a fringe as wide as the image, then four of the fine ones}"
        "{contrast | 40 | amplitude in grey levels below which a pixel is in shadow}");
    const FileStorage file(args.get<String>("rig"), FileStorage::READ);
    const FileNode device = file["emitters"]["projector"];
    const Ptr<RefractiveCamera> camera = RefractiveCamera::read(args.get<String>("rig")), projector = RefractiveCamera::read(device);
    Vec3d rvec, T;
    device["rvec"] >> rvec;
    device["tvec"] >> T;
    std::vector<double> periods;
    device["fringes"]["periods"] >> periods;
    const int steps = 4;
    const Fringes coarse = decode(args.get<String>("images"), 1, steps), fine = decode(args.get<String>("images"), 1 + steps, steps);

    // u from the fine phase, its whole periods from the coarse one; its variance from the noise of the grey levels.
    const double NaN = std::numeric_limits<double>::quiet_NaN(), perPhase = periods[1]/(2*CV_PI), JUMP = 10;
    const double contrast = args.get<double>("contrast");
    const Mat part = fine.phase*perPhase, whole = coarse.phase*(periods[0]/(2*CV_PI));
    Mat u(part.size(), CV_64F), most, least;
    for (int y = 0; y < u.rows; y++)
        for (int x = 0; x < u.cols; x++)
        {
            const double p = part.at<double>(y, x);
            u.at<double>(y, x) = p + periods[1]*cvRound((whole.at<double>(y, x) - p)/periods[1]);
        }
    u.setTo(-1e3, fine.amplitude < contrast);       // in shadow
    dilate(u, most, Mat::ones(5, 5, CV_8U));
    erode(u, least, Mat::ones(5, 5, CV_8U));
    std::vector<std::vector<Point2d> > pixels(2);
    std::vector<Mat> covariances(2);
    std::vector<Vec3d> ofCamera, ofProjector;       // uu, uv, vv
    for (int y = 0; y < u.rows; y++)
        for (int x = 0; x < u.cols; x++)
        {
            const double amplitude = fine.amplitude.at<double>(y, x);
            if (amplitude < contrast || most.at<double>(y, x) - least.at<double>(y, x) >= JUMP)     // at an edge a pixel sees two surfaces
                continue;
            pixels[0].push_back(Point2d(x, y));
            pixels[1].push_back(Point2d(u.at<double>(y, x), NaN));
            ofCamera.push_back(Vec3d(1e-6, 0, 1e-6));       // where a pixel is, is known
            ofProjector.push_back(Vec3d(perPhase*perPhase*2*fine.noise*fine.noise/(steps*amplitude*amplitude), 0, 1));
        }
    covariances[0] = Mat(ofCamera).clone();
    covariances[1] = Mat(ofProjector).clone();

    Mat R;
    Rodrigues(rvec, R);
    const std::vector<Mat> Rs = {Mat::eye(3, 3, CV_64F), R};
    const std::vector<Vec3d> Ts = {Vec3d(), T};
    std::vector<Point3d> points, ignored, half;
    std::vector<uchar> status;
    Mat pointCovariances;
    triangulateRefractive({camera, projector}, Rs, Ts, pixels, points, status, 0, 1., noArray(), pointCovariances, noArray(), covariances);

    // Beside it: windows forgotten, all of them or that of the projector only, as if its sheets were planes.
    const Ptr<RefractiveCamera> bare = RefractiveCamera::create(camera->cameraMatrix(), camera->distCoeffs());
    const Ptr<RefractiveCamera> bareProjector = RefractiveCamera::create(projector->cameraMatrix(), projector->distCoeffs());
    triangulateRefractive({bare, bareProjector}, Rs, Ts, pixels, ignored, status);
    triangulateRefractive({camera, bareProjector}, Rs, Ts, pixels, half, status);

    const FileNode scene = file["scene"];
    std::cout << format("%d points; RMS distance from the surfaces: windows ignored %.2f, the projector's ignored %.2f, corrected %.3f mm, "
                        "%.2f times the stated uncertainty", (int)points.size(), distanceRms(ignored, Mat(), scene),
                        distanceRms(half, Mat(), scene), distanceRms(points, Mat(), scene), distanceRms(points, pointCovariances, scene))
              << std::endl;
    return 0;
}
