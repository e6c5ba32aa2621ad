// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Panes that are bent by a millimetre or two a metre, as tempered plate is: the curvature is estimated, within what is known of it.
#include "problem_scenes.hpp"
#include "window/parameters.hpp"
#include "window/wedge.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const int NORMAL = 8, COUNT = 17;       // rows of a camera: 8 of the lens; normal, distance, thickness, index, inner, outer, curvature
const int DISTANCE = 11, CURVATURE = 16;
const double SIGMA = 0.1;

//! Curvature, 1/mm, of a pane that is bent by so many millimetres over a metre.
double curvatureOf(double bow) { return 8*bow/1e6; }

RigTruth bentRig(double bow, double outerIndex)
{
    RigTruth truth = makeRig(2, { 0, 1 }, outerIndex);
    for (int c = 0; c < 2; c++)
    {
        GlassWindow window = truth.cameras[c]->window();
        window.shape = WINDOW_BENT;
        window.curvature = curvatureOf(c == 0 ? bow : -0.5*bow);
        truth.cameras[c]->setWindow(window);
    }
    return truth;
}

//! The panes begin flat, or bent by nothing.
RigCall callOfPanes(const RigTruth& truth, const RigScene& scene, bool paired, int shape)
{
    RigCall call(truth, scene, paired);
    for (const Ptr<RefractiveCamera>& camera : call.cameras)
    {
        GlassWindow window = camera->window();
        window.shape = shape;
        window.curvature = 0;
        camera->setWindow(window);
    }
    return call;
}

//! What is known of a pane's bow, mm a metre; of the distance in water, mm.
Mat priorOf(double bow, double distance)
{
    Mat covariance = Mat::diag(Mat(COUNT, 1, CV_64F, Scalar(NaN)));
    covariance.at<double>(CURVATURE, CURVATURE) = std::pow(curvatureOf(bow), 2);
    if (distance > 0)
        covariance.at<double>(DISTANCE, DISTANCE) = distance*distance;
    return covariance;
}

std::vector<double> parametersOf(const RigCall& call)
{
    std::vector<double> all;
    for (const Ptr<RefractiveCamera>& camera : call.cameras)
    {
        const std::vector<double> own = static_cast<const Camera&>(*camera).parameters();
        all.insert(all.end(), own.begin(), own.end());
    }
    return all;
}

//! Points that both cameras see at these pixels, one after the other.
Mat pointsOf(const RigCall& call, const std::vector<double>& parameters, const std::vector<Point2d> (&pixels)[2])
{
    std::vector<Ptr<RefractiveCamera> > cameras;
    for (int c = 0; c < 2; c++)
    {
        cameras.push_back(call.cameras[c]->clone());
        cameras[c]->setWindow(withParameters(call.cameras[c]->window(), &parameters[c*COUNT + NORMAL]));
    }
    Mat points;
    triangulateRefractive(cameras[0], cameras[1], call.Rs[1], call.Ts[1], pixels[0], pixels[1], points);
    return points.reshape(1, 3*(int)pixels[0].size());
}

//! Mean of e^T C^-1 e / 3 over points that are measured without noise: only the calibration's error counts.
double pointsOverStated(const RigCall& call, const RigTruth& truth, Random& random)
{
    std::vector<Point3d> exact;
    for (int i = 0; i < 20; i++)
        exact.push_back(Point3d(random.uniform(-80, 80), random.uniform(-60, 60), random.uniform(450, 900)));
    std::vector<Point2d> pixels[2];
    Vec3d rvec;
    Rodrigues(truth.Rs[1], rvec);
    pixels[0] = seen(exact, Vec3d(), Vec3d(), truth.cameras[0], random, 0);
    pixels[1] = seen(exact, rvec, truth.Ts[1], truth.cameras[1], random, 0);
    const std::vector<double> found = parametersOf(call);
    const Mat points = pointsOf(call, found, pixels);
    Mat J = Mat::zeros(points.rows, (int)found.size(), CV_64F);
    for (int i = 0; i < J.cols; i++)
    {
        const double step = 1e-2*call.stdDeviations.at<double>(i);
        if (step == 0)
            continue;
        std::vector<double> above = found, below = found;
        above[i] += step;
        below[i] -= step;
        J.col(i) = (pointsOf(call, above, pixels) - pointsOf(call, below, pixels))/(2*step);
    }
    double sum = 0;
    const Mat C = J*call.covariance(Rect(0, 0, J.cols, J.cols))*J.t();
    for (int i = 0; i < (int)exact.size(); i++)
    {
        const Vec3d error = Vec3d(points.rowRange(3*i, 3*i + 3)) - Vec3d(exact[i]);
        sum += error.dot(Matx33d(Mat(C(Rect(3*i, 3*i, 3, 3)))).inv()*error)/(3*(double)exact.size());
    }
    return sum;
}

} // namespace

TEST_CASE("Pairs give normal and bow back, either way round, in air and water", "[bent][calibrate]")
{
    Random random(6500);
    CAPTURE(seed());
    for (double outerIndex : { 1., 1.333 })
        for (double bow : { 0., 2., -20. })
        {
            CAPTURE(outerIndex, bow);
            const RigTruth truth = bentRig(bow, outerIndex);
            const RigScene scene = makeRigScene(truth, ObjectViews(10, board()), random, 0, 400, 900);
            RigCall call = callOfPanes(truth, scene, true, WINDOW_FLAT);
            CHECK(call.run(GLASS_FREE_CURVATURE | (outerIndex > 1 ? GLASS_FREE_DISTANCE : 0)) < 1e-6);
            for (int c = 0; c < 2; c++)
            {
                const GlassWindow found = call.cameras[c]->window(), exact = truth.cameras[c]->window();
                REQUIRE(found.shape == WINDOW_BENT);
                CHECK(angleBetween(found.normal, exact.normal) < 1e-3);
                CHECK(std::abs(found.curvature - exact.curvature) < curvatureOf(0.01));
                CHECK(call.stdDeviations.at<double>(c*COUNT + CURVATURE) > 0);
            }
        }
}

TEST_CASE("Panes bent by 2 mm a metre: with a prior, normals and points are as good as stated", "[bent][given][slow]")
{
    CAPTURE(seed());
    const int TRIALS = trials(20);
    struct Flow { const char* name; bool paired; double outerIndex; int views; };
    for (const Flow& flow : { Flow{ "pairs in air", true, 1, 6 }, Flow{ "pairs in water", true, 1.333, 6 },
                              Flow{ "hand-held in water", false, 1.333, 15 } })
    {
        double ofNormal = 0, ofPoints = 0, ignoredNormal = 0, ignoredPoints = 0;
        for (int trial = 0; trial < TRIALS; trial++)
        {
            Random random(6600 + trial);
            RigTruth truth = bentRig(0, flow.outerIndex);
            for (const Ptr<RefractiveCamera>& camera : truth.cameras)
            {
                GlassWindow window = camera->window();
                window.curvature = curvatureOf(random.normal(2));
                camera->setWindow(window);
            }
            const RigScene scene = makeRigScene(truth, ObjectViews(flow.views, board()), random, SIGMA, 450, 800);
            for (bool isConsidered : { true, false })
            {
                RigCall call = callOfPanes(truth, scene, flow.paired, WINDOW_BENT);
                const int flags = flow.outerIndex > 1 ? GLASS_FREE_DISTANCE : 0;
                const std::vector<Mat> priors(2, priorOf(isConsidered ? 2 : 0, 0));
                call.run(flags, priors);
                const Vec3d error = call.cameras[0]->window().normal - truth.cameras[0]->window().normal;
                (isConsidered ? ofNormal : ignoredNormal) +=
                    squaredMahalanobis({ error[0], error[1], error[2] }, call.covariance, { NORMAL, NORMAL + 1, NORMAL + 2 })/(2*TRIALS);
                (isConsidered ? ofPoints : ignoredPoints) += pointsOverStated(call, truth, random)/TRIALS;
            }
        }
        std::cout << "[numbers] two panes bent by 2 mm a metre, " << flow.name << ": error over stated, normal " << std::sqrt(ofNormal)
                  << ", points " << std::sqrt(ofPoints) << "; bow ignored " << std::sqrt(ignoredNormal) << ", "
                  << std::sqrt(ignoredPoints) << std::endl;
        CAPTURE(flow.name);
        CHECK(std::abs(ofNormal - 1) < 4/std::sqrt((double)TRIALS));
        CHECK(std::abs(ofPoints - 1) < 4*std::sqrt(2./(3*TRIALS)));
    }
}
