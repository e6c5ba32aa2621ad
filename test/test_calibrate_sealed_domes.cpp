// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Two cameras sealed in domes under water. Focal length and centre of a dome are hardly told apart by such images: the likelihood is
// flat along a bent valley, on which derivatives at one point tell nothing of the others.
#include "round_scenes.hpp"
#include "refit_call.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const double SIGMA = 0.2;

RigTruth sealedDomes()
{
    RigTruth rig;
    for (int c = 0; c < 2; c++)
    {
        const GlassWindow dome = GlassWindow::dome(Vec3d(c == 0 ? 7 : -7, -5, 9), 50, 5, 1.49, 1.33);
        rig.cameras.push_back(RefractiveCamera::create(Matx33d(1000, 0, 640, 0, 1000, 480, 0, 0, 1),
                                                       std::vector<double>{ -0.1, 0.02, 0, 0 }, dome));
        rig.windows.push_back(c);
        Matx33d R;
        Rodrigues(c*Vec3d(0.02, -0.25, 0.02), R);
        rig.Rs.push_back(R);
        rig.Ts.push_back(c*Vec3d(-150, 0, 5));
    }
    return rig;
}

//! Errors of all parameters of the cameras over what is stated; none where it is refused by name.
std::vector<double> overStated(unsigned seed)
{
    Random random(seed);
    const RigTruth truth = sealedDomes();
    const RigScene scene = makeRigScene(truth, ObjectViews(8, board(8, 6, 25)), random, SIGMA, 380, 700);
    RigCall call(truth, scene, false);
    for (int c = 0; c < 2; c++)
        call.cameras[c]->setWindow(truth.cameras[c]->window());
    std::vector<double> ratios;
    try
    {
        refit(call, GLASS_FREE_INTRINSICS | GLASS_FREE_EXTRINSICS);
    }
    catch (const CalibrationError& e)
    {
        CHECK(e.cause == CalibrationError::UNDETERMINED);
        CHECK_THAT(e.err, Catch::Contains("center"));
        return ratios;
    }
    int row = 0;
    for (int c = 0; c < 2; c++)
    {
        const Mat found = call.cameras[c]->lensParameters(), right = truth.cameras[c]->lensParameters();
        for (int i = 0; i < found.rows; i++)
            ratios.push_back((found.at<double>(i) - right.at<double>(i))/call.stdDeviations.at<double>(row + i));
        for (int i = 0; i < 3; i++)
            ratios.push_back((call.cameras[c]->window().center[i] - truth.cameras[c]->window().center[i])/
                             call.stdDeviations.at<double>(row + LENS_PARAMETERS + i));
        row += (int)call.cameras[c]->parameterNames().size();
    }
    return ratios;
}

double largest(const std::vector<double>& ratios)
{
    double most = 0;
    for (double ratio : ratios)
        most = std::max(most, std::abs(ratio));
    return most;
}

} // namespace

TEST_CASE("What a rig sealed in domes states of its lenses and centres holds, or is refused by name", "[dome][calibrate][slow]")
{
    CAPTURE(seed());
    for (unsigned rig : { 7301, 7302, 7303 })
    {
        CAPTURE(rig);
        CHECK(largest(overStated(rig)) < 4.5);
    }
}

// Run with [.sealed-domes], TRIALS rigs.
TEST_CASE("Rigs sealed in domes: how many are refused, and the errors over what is stated", "[.sealed-domes]")
{
    const int TRIALS = trials(20);
    int refused = 0, wrong = 0, count = 0;
    double squares = 0;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        const std::vector<double> ratios = overStated(7400 + trial);
        refused += ratios.empty();
        wrong += largest(ratios) > 4.5;
        count += (int)ratios.size();
        for (double ratio : ratios)
            squares += ratio*ratio;
    }
    std::cout << "[numbers] rigs sealed in domes: of " << TRIALS << ", refused by name " << refused << ", beyond 4.5 standard deviations "
              << wrong << ", RMS error over stated " << std::sqrt(squares/std::max(count, 1)) << " (seed " << seed() << ")\n";
    CHECK(wrong == 0);
}
