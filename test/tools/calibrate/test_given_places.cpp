// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What is known of where windows are, from the command line into the fit.
#include "calibrate/fit.hpp"
#include "calibrate/starting_model.hpp"
#include "console/failure.hpp"
#include "rig_scenes.hpp"
#include "temporary_folder.hpp"
#include <fstream>
#include <functional>
#include <iostream>

using namespace tools;
using cv::Mat;
using cv::Point3d;
using cv::Vec3d;
using namespace cv::refract;

namespace {

const double DEGREE = CV_PI/180;

//! A board in water in three places, and the options that tell of one camera's normal.
struct Scene
{
    Scene() : truth(scenes::makeRig(1, {0}, 1.333))
    {
        scenes::Random random(4520);
        const scenes::RigScene seen = scenes::makeRigScene(truth, scenes::ObjectViews(3, scenes::board()), random, 0.3);
        data.cameraCount = 1;
        data.imageSize[0] = cv::Size(1280, 1024);
        for (size_t view = 0; view < seen.object.size(); view++)
        {
            View own;
            own.stem = std::to_string(view);
            own.objectPoints = seen.object[view];
            own.glass[0] = seen.refracted[0][view];
            data.views.push_back(own);
        }
        options.window = truth.cameras[0]->window();
        options.flags = GLASS_FREE_DISTANCE;
        options.known[0] = RefractiveCamera::create(truth.cameras[0]->cameraMatrix(), truth.cameras[0]->distCoeffs());
        options.known[0]->setImageSize(data.imageSize[0]);
        options.knownCovariance[0] = Mat();
    }

    //! @param degrees 0: nothing is known
    Fit fit(const Vec3d& normal, double degrees)
    {
        options.places.resize(1);
        options.places[0].normal = normalize(normal);
        options.std.normal = degrees*DEGREE;
        std::vector<LensSource> sources;
        const RigModel start = startModel(data, options, sources);
        return fitImages(data, start, {0, 1, 2}, options.flags, 300);
    }

    scenes::RigTruth truth;
    RigData data;
    RigOptions options;
};

} // namespace

TEST_CASE("A normal that is given with a deviation is estimated within it", "[given]")
{
    Scene s;
    const Vec3d true_ = s.truth.cameras[0]->window().normal;
    const Vec3d off = normalize(true_ + 0.5*DEGREE*normalize(true_.cross(Vec3d(0, 1, 0))));
    const Fit free = s.fit(off, 0), known = s.fit(off, 1e-3);
    const Vec3d n = known.rig.cameras[0]->window().normal;
    CHECK(std::acos(n.dot(off))/DEGREE < 0.02);
    CHECK(std::acos(std::min(1., free.rig.cameras[0]->window().normal.dot(true_)))/DEGREE < 0.3);
    // Two numbers more are known.
    CHECK(known.dof == free.dof + 2);
}

TEST_CASE("One normal is that of all cameras; of each camera its own", "[given]")
{
    RigOptions options;
    CHECK(options.windowOf(3).normal == GlassWindow().normal);
    options.places.resize(1);
    options.places[0].normal = Vec3d(0, 0, 1);
    CHECK(options.windowOf(3).normal == Vec3d(0, 0, 1));
    options.places.resize(2);
    options.places[1].normal = Vec3d(0.6, 0, 0.8);
    CHECK(options.windowOf(1).normal == Vec3d(0.6, 0, 0.8));
}

namespace {

//! Markers on a window that is somewhere before the camera, each measured with an error of its own along each axis.
struct Pane
{
    explicit Pane(scenes::Random& random)
    {
        normal = normalize(Vec3d(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 1));
        distance = random.uniform(50, 800);
        const Vec3d x = normalize(normal.cross(Vec3d(0, 1, 0))), y = normal.cross(x);
        const double aside = random.uniform(-300, 300), spread = random.uniform(50, 300);
        for (int i = 0, count = 4 + (int)random.uniform(0, 8); i < count; i++)
        {
            const Vec3d std(random.uniform(0.05, 0.3), random.uniform(0.05, 0.3), random.uniform(0.05, 0.3));
            const Vec3d at = distance*normal + (aside + random.uniform(-spread, spread))*x + random.uniform(-spread, spread)*y;
            const Vec3d error(random.normal(std[0]), random.normal(std[1]), random.normal(std[2]));
            markers.push_back({std::to_string(i), at + error, std});
        }
    }
    Vec3d normal;
    double distance;
    std::vector<PaneMarker> markers;
};

void write(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

std::string failureOf(const std::function<void()>& what)
{
    try
    {
        what();
    }
    catch (const Failure& failure)
    {
        return failure.what();
    }
    return "";
}

} // namespace

TEST_CASE("What markers on a pane tell of it is as good as stated, of normal and distance together", "[given]")
{
    const int TRIALS = 200;
    CAPTURE(scenes::seed());
    scenes::Random random(4530);
    double mahalanobis = 0, turns = 0, distances = 0;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        const Pane pane(random);
        const GivenPlace place = placeOfMarkers(pane.markers, "pane.csv");
        GlassWindow truth, found;
        truth.normal = pane.normal;
        truth.distance = pane.distance;
        place.putInto(found);
        // An error of the one against the other that is exact.
        mahalanobis += std::pow(deviationsBetween(found, place.covariance, truth, cv::Matx44d::zeros()), 2)/3;
        const Vec3d error = truth.normal - found.normal, axis(tangents(found.normal).col(0).val);
        const cv::Matx33d ofNormal = place.covariance.get_minor<3, 3>(0, 0);
        turns += std::pow(error.dot(axis), 2)/axis.dot(ofNormal*axis);
        distances += std::pow(truth.distance - found.distance, 2)/place.covariance(3, 3);
    }
    std::cout << "[numbers] seed " << scenes::seed() << ", " << TRIALS << " panes with markers, error over stated: turns "
              << std::sqrt(turns/TRIALS) << ", distance " << std::sqrt(distances/TRIALS) << ", all three together "
              << std::sqrt(mahalanobis/TRIALS) << std::endl;
    CHECK(std::sqrt(turns/TRIALS) == Approx(1).margin(0.15));
    CHECK(std::sqrt(distances/TRIALS) == Approx(1).margin(0.15));
    CHECK(std::sqrt(mahalanobis/TRIALS) == Approx(1).margin(0.1));
}

TEST_CASE("Markers that tell no plane are refused with what is wrong", "[given]")
{
    scenes::Random random(4540);
    const Pane pane(random);
    const auto without = [&](const std::function<void(std::vector<PaneMarker>&)>& spoil) {
        std::vector<PaneMarker> markers = pane.markers;
        spoil(markers);
        return failureOf([&] { placeOfMarkers(markers, "pane.csv"); });
    };
    CHECK(without([](std::vector<PaneMarker>&) {}) == "");
    CHECK(without([](std::vector<PaneMarker>& m) { m.resize(2); }).find("2 markers: a plane takes three") != std::string::npos);
    CHECK(without([](std::vector<PaneMarker>& m) {
        for (PaneMarker& marker : m)
            marker.at = m[0].at + (marker.at[0] - m[0].at[0])*Vec3d(1, 1, 0); }).find("nearly on one line") != std::string::npos);
    CHECK(without([](std::vector<PaneMarker>& m) { m = {m[0], m[1], m[1]}; }).find("nearly on one line") != std::string::npos);
    CHECK(without([](std::vector<PaneMarker>& m) { m[1].at[2] += 20; }).find("the marker '1' is") != std::string::npos);
    CHECK(without([](std::vector<PaneMarker>& m) {
        for (PaneMarker& marker : m)
            marker.at = -marker.at; }).find("not before the camera") != std::string::npos);
}

TEST_CASE("Tables of markers say how well they are known, once", "[given]")
{
    const TemporaryFolder f;
    const std::string path = f / "pane.csv";
    write(path, "image,id,x,y,z,sx,sy,sz,status\nm,a,0,0,300,0.1,0.1,0.2,0\nm,b,nan,nan,nan,nan,nan,nan,1\n");
    const std::vector<PaneMarker> markers = readPaneMarkers(path, 0);
    REQUIRE(markers.size() == 1);
    CHECK(markers[0].std == Vec3d(0.1, 0.1, 0.2));
    CHECK(failureOf([&] { readPaneMarkers(path, 0.1); }).find("leave one out") != std::string::npos);
    write(path, "id,x,y,z\na,0,0,300\n");
    CHECK(readPaneMarkers(path, 0.2)[0].std == Vec3d::all(0.2));
    CHECK(failureOf([&] { readPaneMarkers(path, 0); }).find("say how well") != std::string::npos);
    write(path, "id,x,y,z,sx,sy,sz\na,0,0,300,0.1,0,0.1\n");
    CHECK(failureOf([&] { readPaneMarkers(path, 0); }).find("more than 0") != std::string::npos);
}
