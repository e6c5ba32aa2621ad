// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Walls of tanks: far from long lenses, near what is seen behind them, at distances that nothing tells. Fits that begin with the
// window on the camera end in mirrored tilts there, if the search does not try distances.
#include "rig_scenes.hpp"
#include <sstream>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const double SIGMA = 0.1;
const double SURE = 4.5;        // standard deviations

//! A plate of dots at three depths.
std::vector<Point3d> steppedPlate(double size)
{
    std::vector<Point3d> points;
    for (int column = 0; column < 5; column++)
        for (int row = 0; row < 13; row++)
            points.push_back(Point3d(12.5*(column - 2), 5*(row - 6), -8*(column % 3))*size);
    return points;
}

//! Lengths in mm.
struct Tank
{
    double focal, distance;
    bool boards;                //!< eight flat boards, or one plate
    double leastTilt = 0, mostTilt = 0.3;       //!< of the wall, radians
};

const Tank STEEP = { 2500, 350, true, 0.52, 0.87 };

//! Cameras side by side that look at one place through one wall of acrylic.
RigTruth makeTank(const Tank& tank, int cameras, Random& random)
{
    const double tilt = random.uniform(tank.leastTilt, tank.mostTilt), azimuth = random.uniform(0, 2*CV_PI), APART = 0.2, RANGE = 700;
    const Vec3d normal(std::sin(tilt)*std::cos(azimuth), std::sin(tilt)*std::sin(azimuth), std::cos(tilt));
    const Matx33d K(tank.focal, 0, 1151.5, 0, tank.focal, 859.5, 0, 0, 1);
    RigTruth rig;
    for (int c = 0; c < cameras; c++)
    {
        Matx33d R;
        Rodrigues(Vec3d(0, APART*c, 0), R);
        const Vec3d T = Vec3d(0, 0, RANGE) - R*Vec3d(0, 0, RANGE);
        GlassWindow window(R*normal, 4, 1.49, 0, 1.33);
        window.distance = tank.distance + window.normal.dot(T);
        rig.windows.push_back(0);
        rig.Rs.push_back(R);
        rig.Ts.push_back(T);
        rig.cameras.push_back(RefractiveCamera::create(K, noArray(), window));
    }
    return rig;
}

RigScene makeTankScene(const Tank& tank, const RigTruth& rig, Random& random, int views = 8)
{
    const double size = 8571.43/tank.focal;
    const ObjectViews targets = tank.boards ? ObjectViews(views, board(9, 6, 5*size)) : ObjectViews(1, steppedPlate(size));
    return makeRigScene(rig, targets, random, SIGMA, 620, 790);
}

//! Nothing is known of the wall but its material.
struct TankCall : RigCall
{
    TankCall(const RigTruth& rig, const RigScene& scene, bool paired = false, double start = 0) : RigCall(rig, scene, paired)
    {
        for (const Ptr<RefractiveCamera>& camera : cameras)
            camera->setWindow(GlassWindow(Vec3d(0, 0, 1), 4, 1.49, start, 1.33));
    }

    int rowOfWindow(int c) const
    {
        int row = cameras[c]->lensParameters().rows;
        for (int before = 0; before < c; before++)
            row += (int)cameras[before]->parameterNames().size();
        return row;
    }

    double distanceSigma() const { return stdDeviations.at<double>(rowOfWindow(0) + 3); }

    //! Errors over what is stated, as camera c sees the wall: of the normal (two of a kind, root of the sum) and the distance.
    Vec2d overStated(const RigTruth& rig, int c) const
    {
        const GlassWindow found = cameras[c]->window(), truth = rig.cameras[c]->window();
        const int row = rowOfWindow(c);
        const Vec3d error = found.normal - truth.normal;
        return Vec2d(std::sqrt(squaredMahalanobis({ error[0], error[1] }, covariance, { row, row + 1 })),
                     std::abs(found.distance - truth.distance)/stdDeviations.at<double>(row + 3));
    }

    double wrongBy(const RigTruth& rig, int c = 0) const
    {
        const Vec2d errors = overStated(rig, c);
        return std::max(errors[0], errors[1]);
    }
};

//! The least sum of squares at another distance of the wall; NaN where no fit has it there.
double squaresAt(double distance, const RigTruth& rig, const RigScene& scene, const GlassWindow& best)
{
    if (distance < 0)
        return NaN;
    TankCall call(rig, scene);
    GlassWindow window = best;
    window.distance = distance;
    call.cameras[0]->setWindow(window);
    try
    {
        const double rms = call.run(0);
        return rms*rms*scene.object[0].size();
    }
    catch (const cv::Exception&)
    {
        return NaN;
    }
}

} // namespace

TEST_CASE("A far wall before a long lens is found from a window on the camera", "[calibrate][far_wall]")
{
    int refused = 0;
    for (const Tank& tank : { Tank{ 8571, 550, true }, Tank{ 8571, 550, false }, Tank{ 3500, 200, true }, Tank{ 3500, 200, false },
                              Tank{ 20000, 580, false } })
        for (int seed = 1; seed <= (tank.boards ? 1 : 4); seed++)
        {
            Random random(100*seed);
            const RigTruth rig = makeTank(tank, 1, random);
            const RigScene scene = makeTankScene(tank, rig, random);
            for (double start : tank.boards ? std::vector<double>{ 0 } : std::vector<double>{ 0, 700 })     // which is behind the plate
            {
                TankCall call(rig, scene, false, start);
                double rms = 0;
                try
                {
                    rms = call.run(GLASS_FREE_DISTANCE);
                }
                catch (const CalibrationError& e)
                {
                    // The longest lens hardly tells the distance: one plate in a hundred does not, and that is said.
                    CHECK(tank.focal > 10000);
                    CHECK_THAT(e.err, Catch::Contains("the views do not determine distance"));
                    refused++;
                    continue;
                }
                INFO("focal length " << tank.focal << (tank.boards ? ", boards" : ", plate") << ", seed " << seed << ", start " << start
                     << ": normal " << call.cameras[0]->window().normal << ", distance " << call.cameras[0]->window().distance);
                CHECK(rms < 1.3*std::sqrt(2.)*SIGMA);
                CHECK(call.wrongBy(rig) < SURE);
            }
        }
    CHECK(refused <= 2);        // one plate, from both starts
}

TEST_CASE("A far wall that is tilted by 30 to 50 degrees is found from one that is not", "[calibrate][far_wall]")
{
    // Of the last two of the first tank targets reach to 7 mm from the wall.
    const struct { Tank tank; std::vector<int> seeds; } cases[] = { { STEEP, { 1, 2, 3, 4, 5, 6, 37, 49 } },
                                                                    { { 5000, 400, true, 0.3, 0.8 }, { 10, 11 } },
                                                                    { { 12000, 500, true, 0, 0.6 }, { 15 } } };
    for (const auto& c : cases)
        for (int seed : c.seeds)
        {
            Random random(7300 + seed);
            const RigTruth rig = makeTank(c.tank, 1, random);
            TankCall call(rig, makeTankScene(c.tank, rig, random));
            INFO("focal length " << c.tank.focal << ", seed " << seed << ", normal " << rig.cameras[0]->window().normal);
            CHECK(call.run(GLASS_FREE_DISTANCE) < 2*SIGMA);
            CHECK(call.wrongBy(rig) < SURE);
        }
}

TEST_CASE("A far wall that is tilted is found from pairs, however far it is", "[calibrate][far_wall]")
{
    // Pairs tell the normal and where the boards are; a fit that begins with the window on the camera leaves both.
    int count = 0, right = 0;
    std::ostringstream wrong;
    for (const Tank& tank : { Tank{ 2500, 300, true, 0.4, 0.75 }, Tank{ 5000, 380, true, 0.3, 0.7 }, Tank{ 8000, 420, true, 0.3, 0.65 },
                              Tank{ 12000, 480, true, 0, 0.45 } })
        for (int seed = 1; seed <= trials(8); seed++)
        {
            Random random(7700 + seed);
            const RigTruth rig = makeTank(tank, 1, random);
            TankCall call(rig, makeTankScene(tank, rig, random, 5), true);
            count++;
            try
            {
                call.run(GLASS_FREE_DISTANCE);
            }
            catch (const CalibrationError& e)
            {
                wrong << "focal length " << tank.focal << ", seed " << seed << ": " << e.err << '\n';
                continue;
            }
            right += call.wrongBy(rig) < SURE;
            if (!(call.wrongBy(rig) < SURE))
                wrong << "focal length " << tank.focal << ", seed " << seed << ": off by " << call.wrongBy(rig) << '\n';
        }
    INFO(wrong.str());
    CHECK(right == count);
}

TEST_CASE("Three standard deviations of a far wall's distance are where the squares are larger by nine variances", "[calibrate][far_wall]")
{
    // Where derivatives at the best distance have three standard deviations, they are larger by as little as 2.6.
    const Tank tank = { 12000, 450, false };
    int count = 0;
    for (int seed = 1; seed <= trials(6); seed++)
    {
        Random random(100*seed);
        const RigTruth rig = makeTank(tank, 1, random);
        const RigScene scene = makeTankScene(tank, rig, random);
        TankCall call(rig, scene);
        const double rms = call.run(GLASS_FREE_DISTANCE);
        const GlassWindow found = call.cameras[0]->window();
        const int points = (int)scene.object[0].size();
        const double least = rms*rms*points, variance = least/(2*points - 9);
        double rises[2];
        for (int side : { 0, 1 })
            rises[side] = (squaresAt(found.distance + (2*side - 1)*3*call.distanceSigma(), rig, scene, found) - least)/variance;
        INFO("seed " << seed << ", distance " << found.distance << " +- " << call.distanceSigma() << ", larger by " << rises[0]
             << " nearer, " << rises[1] << " farther");
        for (const double rise : rises)
        {
            CHECK(!(rise < 8));         // NaN: there is no wall
            count += rise < 12;
        }
    }
    CHECK(count > 0);
}

// Run with [.far-wall], TRIALS rigs of each kind.
TEST_CASE("Far walls before long lenses: how many are right, and the errors over what is stated", "[.far-wall]")
{
    const int TRIALS = trials(10);
    std::cout << "[numbers] far walls: right of " << TRIALS << ", refused, RMS error over stated of normal and distance (seed " << seed()
              << ")\n";
    const double STEEPEST = 0.87;       // 50 degrees
    for (const Tank& tank : { Tank{ 8571.43, 550, true }, Tank{ 8571.43, 550, false }, Tank{ 3500, 200, true }, Tank{ 3500, 200, false },
                              Tank{ 2500, 250, true, 0.52, STEEPEST }, Tank{ 5000, 330, true, 0.3, STEEPEST } })
    {
        int right = 0, refused = 0;
        Vec2d squares;
        for (int trial = 0; trial < TRIALS; trial++)
        {
            Random random(1000 + trial);
            const RigTruth rig = makeTank(tank, 1, random);
            const RigScene scene = makeTankScene(tank, rig, random);
            TankCall call(rig, scene);
            try
            {
                call.run(GLASS_FREE_DISTANCE);
            }
            catch (const CalibrationError&)
            {
                refused++;
                continue;
            }
            const Vec2d errors = call.overStated(rig, 0);
            squares += errors.mul(errors);
            right += std::max(errors[0], errors[1]) < SURE;
        }
        const int told = std::max(TRIALS - refused, 1);
        std::cout << "  f " << tank.focal << " px, wall at " << tank.distance << " mm, " << (tank.boards ? "eight boards" : "one plate   ")
                  << (tank.leastTilt > 0 ? ", steep" : "") << ": " << right << ", " << refused << ", "
                  << std::sqrt(squares[0]/(2*told)) << ", " << std::sqrt(squares[1]/told) << std::endl;
        CHECK(right == TRIALS);
    }
}

TEST_CASE("A wall that the best fit would put beyond a target ends just before it, within its error", "[calibrate][far_wall]")
{
    // The wall's distance is hardly known, and hardly less than that of the nearest point.
    const Tank tank = { 8571, 600, true };
    int touching = 0;
    for (int seed : { 3, 4 })
    {
        Random random(100*seed + 7);
        RigTruth rig = makeTank(tank, 1, random);
        const RigScene scene = makeRigScene(rig, ObjectViews(8, board(9, 6, 5)), random, 3*SIGMA, 660, 790);
        TankCall call(rig, scene);
        call.run(GLASS_FREE_DISTANCE);
        const GlassWindow window = call.cameras[0]->window();
        double gap = 1e9;
        for (size_t view = 0; view < scene.object.size(); view++)
        {
            Matx33d R;
            Rodrigues(call.rvecs[view], R);
            for (const Point3d& p : scene.object[view])
                gap = std::min(gap, window.normal.dot(R*Vec3d(p) + Vec3d(call.tvecs[view])) - window.distance - 4);
        }
        INFO("seed " << seed << ", distance " << window.distance << ", gap " << gap);
        CHECK(call.wrongBy(rig) < SURE);
        CHECK(gap > 0);
        touching += gap < 0.015*window.distance;
    }
    CHECK(touching > 0);
}

TEST_CASE("A far wall is found with the lens unknown, too, if other images tell that", "[calibrate][far_wall]")
{
    const Tank tank = { 8571, 550, true };
    for (unsigned seed = 1; seed <= 2; seed++)
    {
        Random random(100*seed + 31);
        const RigTruth rig = makeTank(tank, 1, random);
        RigScene scene = makeTankScene(tank, rig, random, 18);
        for (int view = 0; view < 18; view++)       // hand-held: none is a pair
            (view < 8 ? scene.direct : scene.refracted)[0][view].clear();
        TankCall call(rig, scene, true);
        call.run(GLASS_FREE_DISTANCE | GLASS_FREE_INTRINSICS);
        INFO("seed " << seed << ", distance " << call.cameras[0]->window().distance);
        CHECK(call.wrongBy(rig) < SURE);
    }
}

TEST_CASE("A far wall that cameras share is found from crude places of the cameras, whatever their order", "[calibrate][far_wall]")
{
    const Tank tank = { 8571, 550, true };
    for (int seed = 1; seed <= trials(1); seed++)
    {
        Random random(100*seed + 53);
        const RigTruth rig = makeTank(tank, 3, random);
        RigScene scene = makeTankScene(tank, rig, random, 6);
        for (int view = 0; view < 3; view++)        // the first camera saw least
            scene.refracted[0][view].clear();
        double distances[2];
        for (bool isTurned : { false, true })
        {
            TankCall call(rig, scene);
            if (isTurned)
            {
                std::reverse(call.cameras.begin(), call.cameras.end());
                std::reverse(call.refracted.begin(), call.refracted.end());
            }
            call.Rs[1] = call.Rs[2] = Mat::eye(3, 3, CV_64F);       // nothing is known of R and T
            call.Ts[1] = call.Ts[2] = Mat(Vec3d(-100, 0, 0));
            call.run(GLASS_FREE_DISTANCE | GLASS_FREE_EXTRINSICS);
            const double distance = call.cameras[isTurned ? 2 : 0]->window().distance;
            INFO("seed " << seed << (isTurned ? ", turned" : "") << ", distance " << distance);
            distances[isTurned] = distance;
            if (!isTurned)
                CHECK(call.wrongBy(rig) < SURE);
        }
        CHECK(distances[1] == Approx(distances[0]).epsilon(1e-4));
    }
}
