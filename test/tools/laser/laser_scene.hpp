// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A camera behind a tilted pane in water, and what it sees of flat surfaces that a sheet of light crosses.
#ifndef REFRACT_TEST_TOOLS_LASER_SCENE_HPP
#define REFRACT_TEST_TOOLS_LASER_SCENE_HPP

#include "calibrate/rig_model.hpp"
#include "measure/rig_vector.hpp"
#include "target/target.hpp"
#include "scenes.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace laser {

const cv::Size IMAGE(640, 480);
const double SQUARE = 20., NOISE = 0.005*255.;      // grey values

inline tools::Calibration camera()
{
    using namespace cv::refract;
    tools::RigModel rig;
    GlassWindow window(cv::Vec3d(0.1, -0.15, 1.), 10., 1.49, 40., 1.333);
    rig.add(RefractiveCamera::create(cv::Matx33d(800, 0, 320, 0, 800, 240, 0, 0, 1), std::vector<double>{-0.1, 0.05, 0., 0.}, window));
    rig.cameras[0]->setImageSize(IMAGE);
    tools::Calibration calibration = tools::calibrationOf(rig);
    calibration.unit = "mm";
    return calibration;
}

//! Crosses the view from below, at about 45 degrees.
inline cv::Vec4d sheet()
{
    const cv::Vec3d normal = cv::normalize(cv::Vec3d(0.06, 0.8, 0.6));
    return cv::Vec4d(normal[0], normal[1], normal[2], normal.dot(cv::Vec3d(0, 0, 450)));
}

inline tools::Target board()
{
    tools::TargetOptions options;
    options.size = "8x7";
    options.square = SQUARE;
    return tools::Target(options);
}

struct Pose
{
    cv::Vec3d rvec, tvec;       //!< surface -> camera
    cv::Vec4d plane() const
    {
        cv::Matx33d R;
        cv::Rodrigues(rvec, R);
        const cv::Vec3d n(R(0, 2), R(1, 2), R(2, 2));
        return cv::Vec4d(n[0], n[1], n[2], n.dot(tvec));
    }
};

inline Pose randomPose(scenes::Random& random)
{
    Pose pose;
    pose.rvec = cv::Vec3d(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.6, 0.6));
    cv::Matx33d R;
    cv::Rodrigues(pose.rvec, R);
    const cv::Vec3d middle(random.uniform(-15, 15), random.uniform(-15, 15), random.uniform(380, 520));
    pose.tvec = middle - R*cv::Vec3d(3.5*SQUARE, 3*SQUARE, 0);
    return pose;
}

//! How the line looks.
struct Light
{
    double width = 1.7;         //!< px, standard deviation of its profile
    double amplitude = 90.;     //!< grey values on white
    double reflection = 0.;     //!< share of it in a second line, 25 px beside
    double noise = NOISE;
    double most = 255.;
};

//! The image, in colours: of a chessboard (albedo 1 and 0.15), or of a plain surface.
inline cv::Mat render(const tools::Calibration& calibration, const Pose& pose, bool chessboard, const cv::Vec4d& sheet, const Light& light,
                      scenes::Random& random)
{
    using namespace cv;
    std::vector<Point2d> pixels;
    for (int y = 0; y < IMAGE.height; y++)
        for (int x = 0; x < IMAGE.width; x++)
            pixels.emplace_back(x, y);
    std::vector<Point3d> X;
    refract::refractivePointsOnPlane(pixels, X, calibration.cameras[0].camera, pose.plane());
    Matx33d R;
    Rodrigues(pose.rvec, R);
    const Vec3d n(sheet.val);
    Mat distance(IMAGE, CV_64F), albedo(IMAGE, CV_32F, Scalar(0.6));
    for (size_t i = 0; i < X.size(); i++)
    {
        distance.ptr<double>()[i] = n.dot(Vec3d(X[i])) - sheet[3];
        const Vec3d p = R.t()*(Vec3d(X[i]) - pose.tvec)/SQUARE;
        if (chessboard && p[0] > -1 && p[0] < 8 && p[1] > -1 && p[1] < 7)
            albedo.ptr<float>()[i] = (cvFloor(p[0]) + cvFloor(p[1])) % 2 ? 1.f : 0.15f;
    }
    GaussianBlur(albedo, albedo, Size(), 0.6);
    Mat image(IMAGE, CV_8UC3);
    for (int y = 0; y < IMAGE.height; y++)
        for (int x = 0; x < IMAGE.width; x++)
        {
            const int left = std::max(x - 1, 0), right = std::min(x + 1, IMAGE.width - 1);
            const int up = std::max(y - 1, 0), down = std::min(y + 1, IMAGE.height - 1);
            const Vec2d slope((distance.at<double>(y, right) - distance.at<double>(y, left))/(right - left),
                              (distance.at<double>(down, x) - distance.at<double>(up, x))/(down - up));
            const double off = distance.at<double>(y, x)/norm(slope), a = albedo.at<float>(y, x);
            const auto profile = [&](double px) { return std::exp(-0.5*px*px/(light.width*light.width)); };
            const double green = light.amplitude*a*(profile(off) + light.reflection*profile(off - 25.));
            for (int c = 0; c < 3; c++)
            {
                const double value = std::min(light.most, 10 + 120*a + (c == 1 ? green : 0.));
                image.at<Vec3b>(y, x)[c] = saturate_cast<uchar>(value + random.normal(light.noise));
            }
        }
    return image;
}

} // namespace laser

#endif // REFRACT_TEST_TOOLS_LASER_SCENE_HPP
