// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Bundles with other minima than the right one: a length and a ray meet twice, and so do a ray and the bent sheet that half a pixel sees;
// rays of a camera that only turns meet anywhere.
#include "bundle_scenes.hpp"
#include "round_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const double SIGMA = 0.2;

//! Three cameras that look at the wand from the left, the middle and the right, behind panes or in domes.
RigTruth makeTrio(bool inDomes, Random& random)
{
    RigTruth rig = makeRig(3, { 0, 1, 2 }, 1.33, 0.25);
    for (const Ptr<RefractiveCamera>& camera : rig.cameras)
        if (inDomes)
            camera->setWindow(domeAt(Vec3d(12, -15, 18) + random.vector(5), 1.33));
    return rig;
}

//! The last camera sees u of one end of the wand, v of the other.
void forgetHalves(PixelViews& views)
{
    for (std::vector<Point2d>& view : views)
        for (size_t i = 0; i < view.size(); i++)
            (i % 2 == 0 ? view[i].y : view[i].x) = NaN;
}

//! From a rig that is a little off.
struct TrioCall : BundleCall
{
    TrioCall(const RigTruth& rig, const BundleScene& scene, Random& random, double off) : BundleCall(rig, scene, random, off)
    {
        for (size_t c = 0; c < cameras.size(); c++)
        {
            GlassWindow window = rig.cameras[c]->window();
            if (window.shape == WINDOW_FLAT)
                window.normal = normalize(window.normal + random.vector(0.03*off));
            else
                window.center += random.vector(3*off);
            cameras[c]->setWindow(window);
        }
    }

    //! e^T C^-1 e of R and T of the other cameras over its twelve degrees of freedom.
    double overStated(const RigTruth& rig) const
    {
        int row = 0;
        for (const Ptr<RefractiveCamera>& camera : cameras)
            row += (int)camera->parameterNames().size();
        std::vector<double> errors;
        std::vector<int> rows;
        for (size_t c = 1; c < cameras.size(); c++)
        {
            Vec3d found, right;
            Rodrigues(Rs[c], found);
            Rodrigues(rig.Rs[c], right);
            const Vec3d turn = found - right, T = Vec3d(Ts[c].at<double>(0), Ts[c].at<double>(1), Ts[c].at<double>(2)) - rig.Ts[c];
            for (int k = 0; k < 6; k++)
            {
                errors.push_back(k < 3 ? turn[k] : T[k - 3]);
                rows.push_back(row++);
            }
        }
        return squaredMahalanobis(errors, covariance, rows)/(double)rows.size();
    }

    //! The same of x and y of the normals, of which z follows.
    double overStatedOfNormals(const RigTruth& rig) const
    {
        std::vector<double> errors;
        std::vector<int> rows;
        int first = 0;
        for (size_t c = 0; c < cameras.size(); c++)
        {
            const std::vector<String> names = cameras[c]->parameterNames();
            for (int k = 0; k < 2; k++)
            {
                errors.push_back(cameras[c]->window().normal[k] - rig.cameras[c]->window().normal[k]);
                rows.push_back(first + (int)(std::find(names.begin(), names.end(), cv::format("normal[%d]", k)) - names.begin()));
            }
            first += (int)names.size();
        }
        return squaredMahalanobis(errors, covariance, rows)/(double)rows.size();
    }

    //! How far the worst point is off, in its standard deviations. @param told how many points have a place
    double worstPoint(const BundleScene& scene, int& told) const
    {
        double worst = 0;
        told = 0;
        for (size_t i = 0; i < points.size(); i++)
        {
            if (std::isnan(points[i].x))
                continue;
            told++;
            const Vec3d off = points[i] - scene.points[i];
            for (int k = 0; k < 3; k++)
                worst = std::max(worst, std::abs(off[k])/pointDeviations.at<double>((int)i, k));
        }
        return worst;
    }
};

const double OFF = 0.15;        // degrees, and a millimetre

//! @return the RMS that the module's own start leads to, and what the true points do
Vec2d fitFromBoth(bool inDomes, int number, double& overStated)
{
    Random random(5000 + number);
    const RigTruth rig = makeTrio(inDomes, random);
    BundleScene scene = makeWandScene(rig, 80, random, SIGMA, 0.35);
    forgetHalves(scene.pixels[2]);
    Vec2d rms;
    for (bool fromTruth : { true, false })
    {
        Random same(7000 + number);
        TrioCall call(rig, scene, same, fromTruth ? 0 : OFF);
        if (fromTruth)
            call.points = scene.points;
        rms[fromTruth] = call.run(GLASS_FREE_EXTRINSICS);
        overStated = call.overStated(rig);
    }
    return rms;
}

} // namespace

TEST_CASE("A wand before half a camera is found where the true points have it", "[bundle][half]")
{
    for (bool inDomes : { false, true })
        for (int number = 1; number <= trials(4); number++)
        {
            double overStated;
            const Vec2d rms = fitFromBoth(inDomes, number, overStated);
            INFO((inDomes ? "domes" : "panes") << ", number " << number);
            CHECK(std::abs(rms[0] - rms[1]) < 1e-3*rms[1]);
        }
}

// Run with [.half-pixel-minima].
TEST_CASE("Wands before half a camera: how many are right, and the errors over what is stated", "[.half-pixel-minima]")
{
    const int TRIALS = trials(40);
    for (bool inDomes : { false, true })
    {
        int right = 0;
        double sum = 0;
        for (int number = 1; number <= TRIALS; number++)
        {
            double overStated;
            const Vec2d rms = fitFromBoth(inDomes, number, overStated);
            right += std::abs(rms[0] - rms[1]) < 1e-3*rms[1];
            sum += overStated;
        }
        std::cout << "[numbers] wand, half a camera, " << (inDomes ? "domes" : "panes") << ": where true points lead " << right << " of "
                  << TRIALS << ", squared error of R and T over stated " << sum/TRIALS << " (seed " << seed() << ")\n";
        CHECK(right == TRIALS);
        CHECK(std::abs(sum/TRIALS - 1) < 4*std::sqrt(2./(12*TRIALS)));      // of twelve degrees of freedom
    }
}

namespace {

//! So many observations lose u or v.
void forgetSome(BundleScene& scene, Random& random, double part)
{
    for (PixelViews& views : scene.pixels)
        for (std::vector<Point2d>& view : views)
            for (Point2d& pixel : view)
                if (random.uniform(0, 1) < part)
                    (random.uniform(0, 1) < 0.5 ? pixel.x : pixel.y) = NaN;
}

//! How a kind of bundles ends, of so many trials.
struct Ends
{
    int count = 0, failed = 0, wrongCameras = 0, wrongPoints = 0, told = 0;
    double sum = 0;

    void add(double overStated, double worstPoint, int points)
    {
        const double CAMERAS = 10, POINT = 8;       // of two degrees of freedom or more; standard deviations of one of hundreds
        count++;
        wrongCameras += !(overStated < CAMERAS);
        wrongPoints += !(worstPoint < POINT);
        told += points;
        sum += overStated;
    }
    void print(const char* what) const
    {
        std::cout << "[numbers] " << what << ": of " << count << " " << failed << " fail, " << wrongCameras << " wrong cameras, "
                  << wrongPoints << " with wrong points, " << told/std::max(count, 1) << " points told, squared error over stated "
                  << sum/std::max(count, 1) << " (seed " << seed() << ")\n";
    }
};

//! A bundle of two cameras or more, and how it ends.
void fitRig(const RigTruth& rig, const BundleScene& scene, Random& random, double crude, Ends& ends)
{
    TrioCall call(rig, scene, random, crude);
    int told;
    call.run(GLASS_FREE_EXTRINSICS);
    const double worst = call.worstPoint(scene, told);
    ends.add(call.overStated(rig), worst, told);
}

//! Two cameras, a wand, every second pixel half.
void fitHalfWand(int number, Ends& ends)
{
    Random random(9000 + number);
    const RigTruth rig = makeRig(2, { 0, 1 }, 1.33, 0.25);
    BundleScene scene = makeWandScene(rig, 40, random, 0.1);
    forgetSome(scene, random, 0.5);
    fitRig(rig, scene, random, 1, ends);
}

//! Three cameras of which a few see each point, many of them half.
void fitHalfScene(int number, Ends& ends)
{
    Random random(11000 + number);
    const RigTruth rig = makeRig(3, { 0, 1, 2 }, 1.33, 0.25);
    BundleScene scene = makeMovingScene(rig, 4, 60, random, 0.1, 0.6);
    for (int i = 2; i < 12; i += 2)
        scene.lengths.push_back({ (double)i, i + 1., norm(scene.points[i] - scene.points[i + 1]) + random.normal(WAND_SIGMA), WAND_SIGMA });
    forgetSome(scene, random, 0.7);
    fitRig(rig, scene, random, 0.3, ends);
}

//! One camera that turns about its centre, near a pane.
void fitTurningCamera(int number, Ends& ends)
{
    Random random(13000 + number);
    RigTruth rig = makeRig(1, { 0 }, 1.33);
    rig.cameras[0]->setWindow(GlassWindow(Vec3d(0.08, -0.05, 1), 12, 1.5, 30, 1.33));
    BundleScene scene = makeMovingScene(rig, 8, 60, random, 0);
    for (size_t view = 0; view < scene.rvecs.size(); view++)
    {
        Matx33d R;
        scene.rvecs[view] = Vec3d(0.04*((int)view % 3 - 1), 0.05*((int)view % 4 - 1.5), 0.1*(double)view);
        Rodrigues(scene.rvecs[view], R);
        scene.tvecs[view] = R*Vec3d(0, 0, 620);
    }
    look(rig, random, 0.01, 0, scene);
    TrioCall call(rig, scene, random, 0.6);
    int told;
    call.run(0);
    const double worst = call.worstPoint(scene, told);
    ends.add(call.overStatedOfNormals(rig), worst, told);
}

template<class Fit>
Ends endsOf(const char* what, int count, Fit fit)
{
    Ends ends;
    for (int number = 1; number <= count; number++)
        try
        {
            fit(number, ends);
        }
        catch (const cv::Exception& e)
        {
            ends.count++;
            ends.failed++;
            UNSCOPED_INFO(what << ", number " << number << ": " << e.what());
        }
    ends.print(what);
    return ends;
}

} // namespace

TEST_CASE("What halves and turns leave undecided is told as that, and nothing else", "[bundle][half]")
{
    const Ends all[] = { endsOf("wand, two cameras, every second pixel half", trials(50), fitHalfWand),
                         endsOf("scene, three cameras, most pixels half", trials(30), fitHalfScene),
                         endsOf("a camera that turns, 0.01 px", trials(8), fitTurningCamera) };
    for (const Ends& ends : all)
    {
        CHECK(ends.failed <= 0.02*ends.count);          // said, not wrong
        CHECK(ends.wrongCameras == 0);
        CHECK(ends.wrongPoints == 0);
    }
    CHECK(all[0].told > 50*all[0].count);             // of 80, of which 60 have three coordinates or more
}

// Run with [.half-pixel-minima].
TEST_CASE("Halves and turns: how many end in other minima, and the errors over what is stated", "[.half-pixel-minima]")
{
    const Ends all[] = { endsOf("wand, two cameras, every second pixel half", trials(200), fitHalfWand),
                         endsOf("scene, three cameras, most pixels half", trials(200), fitHalfScene),
                         endsOf("a camera that turns, 0.01 px", trials(200), fitTurningCamera) };
    for (const Ends& ends : all)
    {
        CHECK(ends.failed <= 0.02*ends.count);
        CHECK(ends.wrongCameras <= 0.01*ends.count);
        CHECK(ends.wrongPoints <= 0.01*ends.count);
    }
}
