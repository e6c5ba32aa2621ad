// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A calibration made in one water, used in another: points within their +-; and what is told if nobody says so.
#include "assess/check_scenes.hpp"
#include "calibrate/conditions.hpp"
#include "console/failure.hpp"
#include "measure/consistency.hpp"

using namespace check_scenes;

namespace {

const double COLDER_AND_SALTIER = 0.0075;       // fresh water at 20 degrees -> sea water at 8
const double KNOWN_TO = 0.0002;

//! One water before all windows; the scene's rigs are drawn with one for each.
RigModel inWater(const RigModel& rig, double change)
{
    RigModel result = rig.clone();
    const double index = rig.cameras[0]->window().outerIndex + change;
    for (const Ptr<RefractiveCamera>& camera : result.cameras)
    {
        GlassWindow window = camera->window();
        window.outerIndex = index;
        camera->setWindow(window);
    }
    return result;
}

Calibration calibrationOf(const CheckInput& input)
{
    Calibration calibration = tools::calibrationOf(input.rig);
    calibration.covariance = input.covariance;
    calibration.sigma = input.sigma;
    calibration.dof = input.dof;
    return calibration;
}

Medium mediumOf(double index, double std)
{
    Medium medium;
    medium.index.value = index;
    medium.std = Std(std);
    return medium;
}

std::vector<Point3d> someBoard(scenes::Random& random)
{
    const BoardPose pose = poseOfBoard(random);
    std::vector<Point3d> points;
    for (const Point3d& X : checkBoard())
        points.push_back(Point3d(rotationMatrix(pose.rvec)*Vec3d(X) + pose.tvec));
    return points;
}

RigPixels seenBy(const RigModel& rig, const std::vector<Point3d>& points, scenes::Random& random)
{
    RigPixels pixels;
    for (size_t c = 0; c < rig.cameras.size(); c++)
    {
        std::vector<Point2d> image;
        refractiveProjectPoints(points, rotationVector(rig.extrinsics[c].R), rig.extrinsics[c].t, rig.cameras[c], image);
        for (Point2d& p : image)
            p += Point2d(random.normal(SIGMA), random.normal(SIGMA));
        pixels.push_back(image);
    }
    return pixels;
}

struct Errors
{
    double squares = 0., contradicted = 0.;
    int count = 0;
};

//! Of points measured in another water. @param isSaid the calibration is told of it
Errors measuredElsewhere(bool isSaid, int rigs, unsigned salt)
{
    const Scene scene = allScenes()[2];
    Errors errors;
    for (int i = 0; i < rigs; i++)
    {
        scenes::Random random(salt + (unsigned)i);
        const Calibrated c = calibrated(scene, random);
        const RigModel now = inWater(c.truth, COLDER_AND_SALTIER);
        const double index = now.cameras[0]->window().outerIndex + random.normal(KNOWN_TO);
        const Calibration asCalibrated = calibrationOf(c.input);
        const Calibration calibration = isSaid ? inMedium(asCalibrated, mediumOf(index, KNOWN_TO), "calib.yml") : asCalibrated;
        const std::vector<Point3d> points = someBoard(random);
        Measurement m = measureRig(calibration, seenBy(now, points, random), SIGMA);
        checkConsistency(calibration, SIGMA, m);
        errors.contradicted += (double)m.inconsistent()/(double)points.size()/rigs;
        for (size_t k = 0; k < points.size(); k++)
            for (int axis = 0; axis < 3; axis++)
                if (m.points[k].x == m.points[k].x)
                {
                    errors.squares += std::pow((Vec3d(m.points[k]) - Vec3d(points[k]))[axis]/m.sigma[k][axis], 2);
                    errors.count++;
                }
    }
    return errors;
}

} // namespace

TEST_CASE("A rig calibrated in fresh water measures in the sea within its +-, and contradicts itself if nobody says so", "[conditions]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const int rigs = scenes::trials(24);
    const Errors said = measuredElsewhere(true, rigs, 7000), silent = measuredElsewhere(false, rigs, 7000);
    const double ratio = std::sqrt(said.squares/said.count);
    std::cout << format("[numbers] calibrated at 1.333, measured at 1.3405 +- 0.0002, said: error over stated %.2f, %.1f %% of points "
                        "contradict themselves; without saying so %.1f %%\n", ratio, 100.*said.contradicted, 100.*silent.contradicted);
    // Errors of one calibration are common to its points: about as many independent ones as it has some parameters.
    CHECK(ratio == Approx(1.).margin(4./std::sqrt(2.*3.*rigs)));
    CHECK(said.contradicted < 0.02);
    CHECK(silent.contradicted > 0.9);
}

TEST_CASE("Of the old medium stays what it did to other parameters", "[conditions]")
{
    scenes::Random random(7100);
    std::cout << "seed " << scenes::seed() << '\n';
    const Calibrated c = calibrated(allScenes()[2], random);
    const Calibration before = calibrationOf(c.input), after = inMedium(before, mediumOf(1.341, KNOWN_TO), "calib.yml");
    const RigModel rig = modelOf(after);
    std::vector<int> media = {columnsOf(rig, 0).outerIndex, columnsOf(rig, 1).outerIndex};
    for (int i = 0; i < after.covariance.rows; i++)
        for (int j = 0; j < after.covariance.cols; j++)
        {
            const int ofMedium = (int)std::count(media.begin(), media.end(), i) + (int)std::count(media.begin(), media.end(), j);
            const double expected = ofMedium == 0 ? before.covariance.at<double>(i, j) : ofMedium == 2 ? KNOWN_TO*KNOWN_TO : 0.;
            CHECK(after.covariance.at<double>(i, j) == expected);
        }
    CHECK(before.cameras[0].camera->window().outerIndex != 1.341);      // what was read is as it was
    for (const CameraCalibration& camera : after.cameras)
        CHECK(camera.camera->window().outerIndex == 1.341);
    CHECK(after.covariance.data != before.covariance.data);

    // And so of what the covariance is made of, row by row of a budget.
    const std::vector<int> before0 = {columnsOf(rig, 0).outerIndex, columnsOf(rig, 0).distance};
    Calibration sourced = calibrationOf(c.input);
    Mat factor(sourced.covariance.rows, 1, CV_64F, Scalar(0));
    factor.at<double>(before0[0]) = 0.002;
    factor.at<double>(before0[1]) = -0.3;
    sourced.provenance.sources = {{std::string(INDEX_OF_MEDIUM) + ", camera 1", "0.002", 0.002, factor}};
    const std::vector<UncertaintySource> sources = inMedium(sourced, mediumOf(1.341, KNOWN_TO), "calib.yml").provenance.sources;
    REQUIRE(sources.size() == 2);
    CHECK(sources[0].factor.at<double>(before0[0]) == 0.);
    CHECK(sources[0].factor.at<double>(before0[1]) == -0.3);
    CHECK(factor.at<double>(before0[0]) == 0.002);
    CHECK(sources[1].name == INDEX_OF_MEDIUM);
    CHECK(sources[1].factor.at<double>(media[0]) == KNOWN_TO);
    CHECK(sources[1].factor.at<double>(media[1]) == KNOWN_TO);
    CHECK(norm(sources[1].factor) == Approx(std::sqrt(2.)*KNOWN_TO));

    // In one medium on both sides the distance is not known.
    const Calibrated air = calibrated(allScenes()[1], random);
    CHECK_THROWS_AS(inMedium(calibrationOf(air.input), mediumOf(1.333, 0.), "calib.yml"), Failure);
    CHECK_NOTHROW(inMedium(calibrationOf(air.input), mediumOf(1., 0.), "calib.yml"));
}
