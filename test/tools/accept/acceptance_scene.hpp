// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A calibrated rig, rigs that are as its covariance says they may be, and lengths that they measure.
#ifndef REFRACT_TEST_TOOLS_ACCEPTANCE_SCENE_HPP
#define REFRACT_TEST_TOOLS_ACCEPTANCE_SCENE_HPP

#include "../assess/fitted_rig.hpp"
#include "accept/acceptance.hpp"
#include "calibrate/given_std.hpp"
#include "measure/rig_vector.hpp"
#include "normal_draw.hpp"
#include "report/summary.hpp"
#include <catch2/catch.hpp>

namespace acceptance_scene {

using namespace cv;
using namespace tools;

const double SIGMA = 0.1, SQUARE = 39.;

//! Two cameras, eight pairs, thickness and square known to within what is given. @param square 0: exactly
inline Calibration calibrated(double square = 2e-4)
{
    GivenStd std;
    std.thickness = 0.1;
    std.scale = square;
    return toFile(calibratedPairs(std, 1230, SIGMA, SQUARE), "");
}

//! Draws what the rig may be in truth.
class TrueRigs
{
public:
    explicit TrueRigs(const Calibration& calibration)
        : rig_(modelOf(calibration)), start_(toVector(rig_)), root_(scenes::rootOf(toEigen(calibration.covariance))) {}
    RigModel draw(scenes::Random& random) const
    {
        VectorXd changed = start_;
        changed.head(root_.rows()) += scenes::drawn(root_, random);
        return withVector(rig_, changed);
    }

private:
    RigModel rig_;
    VectorXd start_;
    MatrixXd root_;
};

inline RigPixels pixelsOf(const RigModel& rig, const std::vector<Point3d>& points, double sigma, scenes::Random& random)
{
    RigPixels pixels;
    for (size_t c = 0; c < rig.cameras.size(); c++)
    {
        std::vector<Point2d> image;
        refract::refractiveProjectPoints(points, rotationVector(rig.extrinsics[c].R), rig.extrinsics[c].t, rig.cameras[c], image);
        for (Point2d& p : image)
            p += Point2d(random.normal(sigma), random.normal(sigma));
        pixels.push_back(image);
    }
    return pixels;
}

//! As refract_measure has them, of one image.
inline TestPoints testPoints(const Calibration& calibration, const RigPixels& pixels, double sigma, const std::string& image = "a")
{
    const Measurement m = measureRig(calibration, pixels, sigma);
    TestPoints points;
    points.source = "points.csv";
    points.havePixels = points.haveSigma = true;
    for (size_t i = 0; i < m.points.size(); i++)
    {
        TestPoint point{image, std::to_string(i), m.points[i], {}, m.sigma[i], m.status[i]};
        for (const auto& camera : m.pixels)
            point.pixels.push_back(camera[i]);
        points.points.push_back(point);
    }
    return points;
}

} // namespace acceptance_scene

#endif // REFRACT_TEST_TOOLS_ACCEPTANCE_SCENE_HPP
