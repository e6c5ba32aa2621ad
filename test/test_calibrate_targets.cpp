// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Errors that the targets of all views share: their scale, and a motion between the direct and the refracted images.
#include "problem_scenes.hpp"
#include "target_scenes.hpp"
#include <opencv2/core/eigen.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

Mat run(RigCall& call, const Mat& covariance, int flags)
{
    call.run(flags, {}, covariance);
    return call.targetErrors;
}

//! Squared, of a camera's two degrees of freedom, by the covariance.
double normalErrorOverStated(const RigCall& call, const RigTruth& truth, int camera, int row)
{
    const Vec3d error = call.cameras[camera]->window().normal - truth.cameras[camera]->window().normal;
    return squaredMahalanobis({ error[0], error[1], error[2] }, call.covariance, { row, row + 1, row + 2 })/2;
}

const int NORMAL = 8, CAMERA = 16;      // the first row of the normal; parameters of a camera

} // namespace

TEST_CASE("The derivatives by the targets' shared errors are those of differences", "[adjust][targets]")
{
    Random random(71);
    CAPTURE(seed());
    const RigTruth truth = makeRig(2, { 0, 0 }, 1.333);
    const RigScene scene = makeRigScene(truth, 3, random, 0.5);
    Eigen::MatrixXd covariance;
    cv2eigen(targetCovariance(1e-3, 1e-3, 0.1), covariance);
    const std::unique_ptr<Problem> problem = problemAt(truth, scene, true, GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE, covariance);
    ParameterBlock& targets = problem->blocks()[problem->targetBlock()];
    targets.values << 2e-3, 1e-3, -2e-3, 3e-3, 0.1, -0.2, 0.3;
    problem->updateCameras();
    for (const Image& image : problem->images())
    {
        Problem::Derivatives exact, above, below;
        REQUIRE(problem->evaluate(image, image.rootWeights, Problem::ALL, exact));
        REQUIRE(problem->blocksOf(image)[0] == problem->targetBlock());
        for (int i = 0; i < 7; i++)
        {
            CAPTURE(image.camera, image.refracted, i);
            const double kept = targets.values[i], step = i < 4 ? 1e-6 : 1e-3;
            const auto at = [&](double value, Problem::Derivatives& result)
            {
                targets.values[i] = value;
                problem->updateCameras();
                return problem->evaluate(image, image.rootWeights, Problem::RESIDUALS, result);
            };
            REQUIRE(at(kept + step, above));
            REQUIRE(at(kept - step, below));
            const Eigen::VectorXd difference = (above.residuals - below.residuals)/(2*step);
            REQUIRE(at(kept, above));
            CHECK((difference - exact.byBlock[0].col(i)).norm() <= 1e-6*difference.norm() + 1e-9);
            if (!image.refracted && i > 0)
                CHECK(difference.norm() == 0);
        }
    }
}

TEST_CASE("Errors of the targets that are 0 change nothing", "[targets]")
{
    Random random(72);
    CAPTURE(seed());
    const RigTruth truth = makeRig(2, { 0, 1 }, 1.333);
    const RigScene scene = makeRigScene(truth, 4, random, 0.2);
    RigCall without(truth, scene, true), with(truth, scene, true);
    without.run(GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE);
    const Mat errors = run(with, Mat::zeros(7, 7, CV_64F), GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE);
    CHECK(norm(errors, NORM_INF) == 0);
    const Rect common(0, 0, without.covariance.cols, without.covariance.rows);
    CHECK(with.covariance.rows == without.covariance.rows + 7);
    CHECK(norm(with.covariance(common), without.covariance, NORM_INF) <= 1e-12*norm(without.covariance, NORM_INF));
    CHECK(with.cameras[1]->window().normal == without.cameras[1]->window().normal);
    const Mat none = run(with, Mat(), GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE);
    CHECK(countNonZero(none == none) == 0);
    CHECK(none.size() == Size(1, 7));
    CHECK(with.covariance.size() == without.covariance.size());
}

TEST_CASE("Boards that moved between direct and glass images: ignored, the normal is wrong; as a nuisance, its +- holds", "[targets]")
{
    CAPTURE(seed());
    const int TRIALS = trials(24);
    const double rotation = 2e-3, translation = 0.1;
    for (double outerIndex : { 1., 1.333 })
    {
        const RigTruth truth = makeRig(2, { 0, 1 }, outerIndex);
        double ignored = 0, considered = 0, ofMotion = 0;
        for (int trial = 0; trial < TRIALS; trial++)
        {
            Random random(900 + trial);
            RigScene scene = makeRigScene(truth, ObjectViews(6, board()), random, 0.1);
            const TargetTruth targets = drawTargets(random, 0, rotation, translation);
            imageTargets(truth, targets, random, 0.1, scene);
            RigCall without(truth, scene, true), with(truth, scene, true);
            const int flags = outerIndex > 1 ? GLASS_FREE_DISTANCE : 0;
            without.run(flags);
            const Mat errors = run(with, targetCovariance(0, rotation, translation), flags);
            for (int c = 0; c < 2; c++)
            {
                ignored += normalErrorOverStated(without, truth, c, NORMAL + c*CAMERA)/(2*TRIALS);
                considered += normalErrorOverStated(with, truth, c, NORMAL + c*CAMERA)/(2*TRIALS);
            }
            for (int i = 0; i < 3; i++)
                ofMotion += std::pow((errors.at<double>(1 + i) - targets.rvec[i])/
                                     with.stdDeviations.at<double>(with.stdDeviations.rows - 6 + i), 2)/(3*TRIALS);
        }
        std::cout << "[numbers] boards 0.1 mm and 2 mrad aside in all of 6 pairs, outer index " << outerIndex
                  << ": error of the normal over stated, ignored " << std::sqrt(ignored) << ", as a nuisance "
                  << std::sqrt(considered) << "; rotation " << std::sqrt(ofMotion) << std::endl;
        CHECK(ignored > 5*5);
        // Two normals of one rig share what they do not know: two degrees of freedom a trial at least.
        CHECK(std::abs(considered - 1) < 4/std::sqrt((double)TRIALS));
        CHECK(std::abs(ofMotion - 1) < 4/std::sqrt(1.5*TRIALS));
    }
}

TEST_CASE("The square of a board, known to a part in a thousand, is in the +- of the base line", "[targets]")
{
    CAPTURE(seed());
    const int TRIALS = trials(24);
    const double sigma = 1e-3;
    const RigTruth truth = makeRig(2, { 0, 1 }, 1.333);
    double ignored = 0, considered = 0;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        Random random(1900 + trial);
        RigScene scene = makeRigScene(truth, ObjectViews(8, board()), random, 0.1);
        imageTargets(truth, drawTargets(random, sigma, 0, 0), random, 0.1, scene);
        const auto overStated = [&](RigCall& call)
        {
            const double length = norm(call.Ts[1]);
            const Mat unit = call.Ts[1]/length, covariance = call.covariance(Rect(2*CAMERA + 3, 2*CAMERA + 3, 3, 3));
            return std::pow(length - norm(truth.Ts[1]), 2)/Mat(unit.t()*covariance*unit).at<double>(0);
        };
        RigCall without(truth, scene, true), with(truth, scene, true);
        without.run(GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE);
        const Mat errors = run(with, targetCovariance(sigma, 0, 0), GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE);
        CHECK(with.stdDeviations.at<double>(with.stdDeviations.rows - 7) < sigma*1.0001);
        CHECK(with.stdDeviations.at<double>(with.stdDeviations.rows - 6) == 0);
        CHECK(std::abs(errors.at<double>(0)) < 4*sigma);
        ignored += overStated(without)/TRIALS;
        considered += overStated(with)/TRIALS;
    }
    std::cout << "[numbers] square known to 0.1 %: error of the base line over stated, ignored " << std::sqrt(ignored)
              << ", as a nuisance " << std::sqrt(considered) << std::endl;
    CHECK(ignored > 2*2);
    CHECK(std::abs(considered - 1) < 4*std::sqrt(2./TRIALS));
}

TEST_CASE("Moved targets and GLASS_ROBUST: no image is taken for a moved one", "[targets]")
{
    Random random(75);
    CAPTURE(seed());
    const RigTruth truth = makeRig(1, { 0 }, 1);
    RigScene scene = makeRigScene(truth, ObjectViews(8, board()), random, 0.1);
    TargetTruth targets;
    targets.translation = Vec3d(0.3, -0.2, 0);
    imageTargets(truth, targets, random, 0.1, scene);
    RigCall call(truth, scene, true);
    const Mat errors = run(call, targetCovariance(0, 1e-3, 0.3), GLASS_ROBUST);
    CHECK(countNonZero(call.imageStatus != GLASS_IMAGE_USED) == 0);
    CHECK(normalErrorOverStated(call, truth, 0, NORMAL) < 10);
    // Where the boards are: M c + d - c, whose derivatives by M's rotation vector are -[c]x.
    Matx33d M;
    Rodrigues(Vec3d(errors.at<double>(1), errors.at<double>(2), errors.at<double>(3)), M);
    const Vec3d moved = M*TARGETS + Vec3d(errors.at<double>(4), errors.at<double>(5), errors.at<double>(6)) - TARGETS;
    const Mat J = (Mat_<double>(1, 6) << 0, TARGETS[2], -TARGETS[1], 1, 0, 0);
    const int last = call.covariance.rows - 6;
    const double sigma = std::sqrt(Mat(J*call.covariance(Rect(last, last, 6, 6))*J.t()).at<double>(0));
    CHECK(sigma < 0.31);
    CHECK(std::abs(moved[0] - 0.3) < 4*sigma);
}

TEST_CASE("Targets that moved by many times the pixel noise are not outliers where they may have moved", "[targets]")
{
    CAPTURE(seed());
    const double rotation = 1.6e-4, translation = 0.02;
    int lost = 0, images = 0;
    double normals = 0;
    const int TRIALS = 8;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        Random random(770 + trial);
        const RigTruth truth = makeRig(2, { 0, 1 }, 1);
        RigScene scene = makeRigScene(truth, ObjectViews(6, board()), random, 0.01);
        imageTargets(truth, drawTargets(random, 0, rotation, translation), random, 0.01, scene);
        RigCall call(truth, scene, true);
        run(call, targetCovariance(0, rotation, translation), GLASS_ROBUST);
        lost += countNonZero(call.imageStatus != GLASS_IMAGE_USED);
        images += (int)call.imageStatus.total();
        for (int c = 0; c < 2; c++)
            normals += normalErrorOverStated(call, truth, c, NORMAL + c*CAMERA)/(2*TRIALS);
    }
    std::cout << "[numbers] boards 0.02 mm aside, 0.01 px, robust: " << lost << " of " << images << " images lost, error of the normal "
              << std::sqrt(normals) << " of what is stated" << std::endl;
    CHECK(lost == 0);
    CHECK(std::abs(normals - 1) < 4/std::sqrt((double)TRIALS));
}

TEST_CASE("A covariance of the targets that is none is named", "[targets]")
{
    Random random(76);
    const RigTruth truth = makeRig(1, { 0 }, 1);
    const RigScene scene = makeRigScene(truth, ObjectViews(3, board()), random, 0.1);
    RigCall call(truth, scene, true);
    const auto sentence = [&](const Mat& covariance)
    {
        try { run(call, covariance, 0); }
        catch (const cv::Exception& e) { return e.err; }
        return String();
    };
    CHECK(sentence(Mat::eye(6, 6, CV_64F)).find("targetCovariance is 6x6") == 0);
    CHECK(sentence(-Mat::eye(7, 7, CV_64F)).find("targetCovariance has the variance -1 in row 0") == 0);
    Mat impossible = targetCovariance(1e-3, 1e-3, 1);
    impossible.at<double>(4, 5) = impossible.at<double>(5, 4) = 1e6;
    CHECK(sentence(impossible).find("targetCovariance is not positive semidefinite: its correlations have the eigenvalue -") == 0);
    Mat half = targetCovariance(1e-3, 1e-3, 1);
    half.at<double>(4, 5) = 0.5*std::sqrt(half.at<double>(4, 4)*half.at<double>(5, 5));
    CHECK(sentence(half).find("targetCovariance is not symmetric") == 0);
    CHECK(sentence(Mat_<float>(targetCovariance(1e-3, 1e-3, 0.1))).empty());
}
