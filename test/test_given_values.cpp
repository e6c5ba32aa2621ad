// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What is given is not exact: thickness, indices, distance, wedge, the square of the board, where the boards stood. With the
// uncertainty of each, every +- of a calibration holds, whatever the flow.
#include "problem_scenes.hpp"
#include "target_scenes.hpp"
#include "window/wedge.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

//! Standard deviations of what a user may know; 0: exact.
struct Given
{
    double thickness = 0.05, index = 0.003, outerIndex = 0.001, distance = 1, wedge = CV_PI/180/60;   //!< mm, mm, radians
    double scale = 2e-4, rotation = 3e-4, translation = 0.03;
};

GlassWindow drawnWindow(GlassWindow window, const Given& given, Random& random)
{
    const bool isAir = window.outerIndex == window.innerIndex;
    window.thickness[0] += random.normal(given.thickness);
    window.index[0] += random.normal(given.index);
    window.distance += isAir ? 0 : random.normal(given.distance);
    window.outerIndex += isAir ? 0 : random.normal(given.outerIndex);
    window.wedge = { Vec2d(random.normal(given.wedge), random.normal(given.wedge)) };
    return window;
}

//! Lens: unknown to the prior; window: what is given.
Mat covarianceOf(const Ptr<RefractiveCamera>& camera, const Given& given)
{
    const Camera& inner = static_cast<const Camera&>(*camera);
    const WindowLayout& at = inner.layers().at();
    const bool isAir = camera->window().outerIndex == camera->window().innerIndex;
    const int lens = inner.lensCount();
    Mat covariance(inner.parameterCount(), inner.parameterCount(), CV_64F, Scalar(0));
    for (int i = 0; i < covariance.rows; i++)
        covariance.at<double>(i, i) = NaN;
    const auto set = [&](int i, double sigma) { covariance.at<double>(lens + i, lens + i) = sigma*sigma; };
    set(at.thickness, given.thickness);
    set(at.index, given.index);
    set(at.wedge, given.wedge);
    set(at.wedge + 1, given.wedge);
    if (!isAir)
    {
        set(at.distance, given.distance);
        set(at.outerIndex, given.outerIndex);
    }
    return covariance;
}

/** Error of what is estimated, squared, over what is stated of it, per degree of freedom.
@param rows of the covariance, with the errors of these parameters */
double errorOverStated(const std::vector<double>& errors, const Mat& covariance, const std::vector<int>& rows, int freedom)
{
    return squaredMahalanobis(errors, covariance, rows)/freedom;
}

//! One trial of a flow: of the first window, its normal and all parameters; of the second camera's place, if it is free.
struct Trial
{
    double ofNormal, ofWindow, ofPlace;
};

Trial runTrial(const Flow& flow, const Given& given, int seedOfTrial)
{
    Random random(seedOfTrial);
    std::vector<int> windows(flow.cameras, 0);
    for (int c = 0; c < flow.cameras && !flow.shared; c++)
        windows[c] = c;
    const RigTruth nominal = makeRig(flow.cameras, windows, flow.outerIndex);
    RigTruth truth = makeRig(flow.cameras, windows, flow.outerIndex);
    for (int c = 0; c < flow.cameras; c++)
        truth.cameras[c]->setWindow(c > 0 && flow.shared ? windowInFrame(truth.cameras[0]->window(), truth.Rs[c], truth.Ts[c])
                                                         : drawnWindow(nominal.cameras[c]->window(), given, random));
    RigScene scene = makeRigScene(truth, ObjectViews(flow.views, board()), random, 0.1);
    imageTargets(truth, drawTargets(random, given.scale, given.rotation, given.translation), random, 0.1, scene);

    RigCall call(nominal, scene, flow.paired);
    std::vector<Mat> covariances;
    for (const Ptr<RefractiveCamera>& camera : call.cameras)
    {
        GlassWindow window = camera->window();
        window.distance = nominal.cameras[covariances.size()]->window().distance;
        window.wedge = { Vec2d() };
        camera->setWindow(window);
        covariances.push_back(covarianceOf(camera, given));
    }
    call.run(flow.flags, covariances, targetCovariance(given.scale, given.rotation, given.translation));

    const Camera& inner = static_cast<const Camera&>(*call.cameras[0]);
    const WindowLayout& at = inner.layers().at();
    const int lens = inner.lensCount();
    const std::vector<double> found = inner.parameters(), exact = static_cast<const Camera&>(*truth.cameras[0]).parameters();
    std::vector<double> ofWindow, ofNormal;
    std::vector<int> rows, normalRows;
    for (int i = 0; i < at.count; i++)
    {
        if (!(call.stdDeviations.at<double>(lens + i) > 0))
            continue;
        rows.push_back(lens + i);
        ofWindow.push_back(found[lens + i] - exact[lens + i]);
        if (i < 3)
        {
            normalRows.push_back(rows.back());
            ofNormal.push_back(ofWindow.back());
        }
    }
    Trial trial = { errorOverStated(ofNormal, call.covariance, normalRows, 2),
                    errorOverStated(ofWindow, call.covariance, rows, (int)rows.size() - 1), 1 };
    if (flow.cameras > 1 && (flow.flags & GLASS_FREE_EXTRINSICS))
    {
        const int row = flow.cameras*inner.parameterCount();
        Vec3d r, r0;
        Rodrigues(call.Rs[1], r);
        Rodrigues(truth.Rs[1], r0);
        const Vec3d T = Vec3d(call.Ts[1]) - truth.Ts[1];
        trial.ofPlace = errorOverStated({ r[0] - r0[0], r[1] - r0[1], r[2] - r0[2], T[0], T[1], T[2] }, call.covariance,
                                        { row, row + 1, row + 2, row + 3, row + 4, row + 5 }, 6);
    }
    return trial;
}

} // namespace

TEST_CASE("Given values drawn from their priors: in every flow errors are what is stated", "[given][slow]")
{
    CAPTURE(seed());
    const int TRIALS = trials(20);
    const Flow flows[] = {
        { "pairs in air", 1, false, true, 1, 6, 0 },
        { "pairs in water", 1, false, true, 1.333, 6, 0 },
        { "through the window alone, in air", 1, false, false, 1, 12, 0 },
        { "through the window alone, in water", 1, false, false, 1.333, 12, 0 },
        { "two cameras, pairs in air, R and T free", 2, false, true, 1, 6, GLASS_FREE_EXTRINSICS },
        { "two cameras, pairs in water, R and T free", 2, false, true, 1.333, 6, GLASS_FREE_EXTRINSICS },
        { "two cameras behind one pane, pairs in air", 2, true, true, 1, 6, GLASS_FREE_EXTRINSICS },
        { "two cameras behind one pane, water, no pairs", 2, true, false, 1.333, 10, 0 },
        { "pairs in air, lens free", 1, false, true, 1, 10, GLASS_FREE_INTRINSICS },
        { "pairs in water, robust", 1, false, true, 1.333, 8, GLASS_ROBUST },
    };
    for (const Flow& flow : flows)
    {
        double ofNormal = 0, ofWindow = 0, ofPlace = 0;
        for (int trial = 0; trial < TRIALS; trial++)
        {
            const Trial made = runTrial(flow, Given(), 3000 + trial);
            ofNormal += made.ofNormal/TRIALS;
            ofWindow += made.ofWindow/TRIALS;
            ofPlace += made.ofPlace/TRIALS;
        }
        std::cout << "[numbers] given values drawn from their priors, " << flow.name << ": error over stated, normal "
                  << std::sqrt(ofNormal) << ", window " << std::sqrt(ofWindow) << ", R and T " << std::sqrt(ofPlace) << std::endl;
        CAPTURE(flow.name);
        CHECK(std::abs(ofNormal - 1) < 4/std::sqrt((double)TRIALS));
        CHECK(std::abs(ofWindow - 1) < 4*std::sqrt(2./(6*TRIALS)));
        CHECK(std::abs(ofPlace - 1) < 4*std::sqrt(2./(6*TRIALS)));
    }
}
