// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

/* Is the true cause named? Mistakes x rigs, from simulated calibrations and new images. A mistake applies to a rig if the images
would show it: its contradiction, without noise, is far above what the rate of false alarms asks for. */
#include "assess/check_problem.hpp"
#include "check_scenes.hpp"
#include <functional>

using namespace check_scenes;

namespace {

const double FALSE_ALARM = 0.001;
const double SHOWS = 60.;           // noncentrality of the contradiction: found with more than 0.999, whichever hypothesis it is

struct MistakeMade
{
    std::string name;
    std::vector<std::string> causes;        //!< parts of the names that are right
    //! Names that physics does not tell from it, for some rigs and places: they may be first if a right one is beside them.
    std::vector<std::string> alike;
    std::function<bool(const RigModel&, bool hasPairs)> appliesTo;
    std::function<void(RigModel&, scenes::Random&)> change = [](RigModel&, scenes::Random&) {};
    std::function<void(std::vector<View>&)> swap = [](std::vector<View>&) {};
};

bool always(const RigModel&, bool) { return true; }
bool several(const RigModel& rig, bool) { return rig.cameras.size() > 1; }
bool ownWindows(const RigModel& rig, bool) { return rig.cameras.size() > 1 && rig.windows.empty(); }
bool inWater(const RigModel& rig, bool) { return rig.cameras[0]->window().outerIndex > 1.1; }
bool withPairs(const RigModel&, bool hasPairs) { return hasPairs; }

void tilt(RigModel& rig, int c, double degrees, double azimuth)
{
    GlassWindow window = rig.cameras[c]->window();
    const Vec3d across = normalize(window.normal.cross(Vec3d(0, 1, 0)));
    window.normal = normalize(window.normal + std::tan(degrees*CV_PI/180)
                              * (std::cos(azimuth)*across + std::sin(azimuth)*window.normal.cross(across)));
    rig.cameras[c]->setWindow(window);
    for (int k = 0; k < (int)rig.cameras.size(); k++)
        if (k != c && rig.sharesWindow(c, k))
        {
            GlassWindow shared = flatSeenFrom(window, fromTo(rig.extrinsics[c], rig.extrinsics[k]));
            rig.cameras[k]->setWindow(shared);
        }
}

void lengthen(RefractiveCamera& camera, double factor)
{
    Mat lens = camera.lensParameters().clone();
    lens(Rect(0, 0, 1, 2)) *= factor;
    camera.setLensParameters(lens);
}

Vec3d direction(scenes::Random& random)
{
    return normalize(Vec3d(random.normal(1.), random.normal(1.), random.normal(1.)));
}

void forEachImage(View& view, int camera, const std::function<void(Point2d&)>& change)
{
    for (std::vector<Point2d>* pixels : {&view.direct[camera], &view.glass[camera]})
        for (Point2d& p : *pixels)
            change(p);
}

const std::vector<std::string> PANE = {"tilted", "wedge", "thickness", "index of the window", "index of the medium", "distance",
                                       "all boards", "square", "one moment", "one place"};

std::vector<MistakeMade> mistakesMade()
{
    std::vector<MistakeMade> all;
    all.push_back({"window 1 tilted by 0.1 degrees",
                   {"window tilted", "window of camera 1 tilted", "window of cameras 1, 2, 3 tilted"}, PANE, always,
                   [](RigModel& rig, scenes::Random& random) { tilt(rig, 0, 0.1, random.uniform(0, 2*CV_PI)); }});
    all.push_back({"window 2 tilted by 0.1 degrees", {"window of camera 2 tilted"}, PANE, ownWindows,
                   [](RigModel& rig, scenes::Random& random) { tilt(rig, 1, 0.1, random.uniform(0, 2*CV_PI)); }});
    all.push_back({"R2 turned by 0.05 degrees", {"R of camera 2", "R and T of camera 2"},
                   {"T of camera 2", "principal point", "camera 1"}, several,
                   [](RigModel& rig, scenes::Random& random) {
                       const Matx33d R = rotationMatrix(0.05*CV_PI/180*direction(random));
                       rig.extrinsics[1] = RigidTransform{R, Vec3d()}*rig.extrinsics[1]; }});
    all.push_back({"base line 0.3 % longer", {"base line (length of T of camera 2", "T of camera 2"},
                   {"square", "R and T", "focal"}, several,
                   [](RigModel& rig, scenes::Random&) { rig.extrinsics[1].t *= 1.003; }});
    all.push_back({"focus of camera 1 by 0.2 %", {"focal length of camera 1", "focal length changed", "focal length and principal"},
                   {"camera 1", "T of camera", "base line", "square", "thickness", "distance"}, always,
                   [](RigModel& rig, scenes::Random&) { lengthen(*rig.cameras[0], 1.002); }});
    all.push_back({"focus of all cameras by 0.1 %", {"focal lengths of all cameras"},
                   {"T of camera", "base line", "square", "thickness", "distance", "index of the medium"}, several,
                   [](RigModel& rig, scenes::Random&) {
                       for (const Ptr<RefractiveCamera>& camera : rig.cameras)
                           lengthen(*camera, 1.001); }});
    all.push_back({"another pane, 0.5 mm thicker", {"thickness of the window", "another pane"}, PANE, always,
                   [](RigModel& rig, scenes::Random&) {
                       for (int k = 0; k < (int)rig.cameras.size(); k++)
                           if (rig.sharesWindow(0, k))
                           {
                               GlassWindow window = rig.cameras[k]->window();
                               window.thickness[0] += 0.5;
                               rig.cameras[k]->setWindow(window);
                           } }});
    all.push_back({"outer index 1.333 -> 1.341", {"index of the medium"}, PANE, inWater,
                   [](RigModel& rig, scenes::Random&) {
                       for (const Ptr<RefractiveCamera>& camera : rig.cameras)
                       {
                           GlassWindow window = camera->window();
                           window.outerIndex += 0.008;
                           camera->setWindow(window);
                       } }});
    all.push_back({"boards moved by 0.2 mm between direct and glass", {"all boards"}, PANE, withPairs,
                   [](RigModel& rig, scenes::Random& random) { rig.targetMotion.t = 0.2*direction(random); }});
    all.push_back({"square 1 % wrong", {"square"}, {"base line", "T of camera", "thickness", "index of the window", "focal"}, always,
                   [](RigModel& rig, scenes::Random&) { rig.targetScale = 1.01; }});
    all.push_back({"images of cameras 1 and 2 exchanged", {"images of cameras 1 and 2 exchanged"}, {}, several,
                   [](RigModel&, scenes::Random&) {},
                   [](std::vector<View>& views) {
                       for (View& view : views)
                       {
                           std::swap(view.direct[0], view.direct[1]);
                           std::swap(view.glass[0], view.glass[1]);
                       } }});
    all.push_back({"images of camera 1 turned by 180 degrees", {"images turned by 180", "images of camera 1 turned by 180"}, {}, always,
                   [](RigModel&, scenes::Random&) {},
                   [](std::vector<View>& views) {
                       for (View& view : views)
                           forEachImage(view, 0, [](Point2d& p) { p = Point2d(1279, 1023) - p; }); }});
    all.push_back({"images of the last camera mirrored", {"mirrored (left and right"}, {}, always,
                   [](RigModel&, scenes::Random&) {},
                   [](std::vector<View>& views) {
                       for (View& view : views)
                       {
                           int last = 0;
                           for (int c = 0; c < MAX_CAMERAS; c++)
                               last = view.hasGlass(c) ? c : last;
                           forEachImage(view, last, [](Point2d& p) { p.x = 1279 - p.x; });
                       } }});
    const auto withoutWindows = [](RigModel& rig, int first, int last) {
        for (int c = first; c <= last; c++)
            rig.cameras[c] = copyWithWindow(rig.cameras[c], GlassWindow()); };
    all.push_back({"no window before any camera", {"images taken without the window"}, {}, always,
                   [=](RigModel& rig, scenes::Random&) { withoutWindows(rig, 0, (int)rig.cameras.size() - 1); }});
    all.push_back({"no window before camera 2", {"images of camera 2 taken without the window"}, {}, several,
                   [=](RigModel& rig, scenes::Random&) { withoutWindows(rig, 1, 1); }});
    for (const double times : {25.4, 10., 3.})
        all.push_back({cv::format("square given %g times as large", times),
                       {"square of the board (--square)"}, {}, several, [](RigModel&, scenes::Random&) {}, [=](std::vector<View>& views) {
                           for (View& view : views)
                               for (Point3d& X : view.objectPoints)
                                   X *= times; }});
    return all;
}

bool isOneOf(const std::string& name, const std::vector<std::string>& parts)
{
    return std::any_of(parts.begin(), parts.end(), [&](const std::string& part) { return name.find(part) != std::string::npos; });
}

struct Score
{
    int applicable = 0, first = 0, beside = 0, missed = 0, wrong = 0, alone = 0;
    std::vector<std::string> why;

    int right() const { return first + beside; }
    void add(const Score& s)
    {
        applicable += s.applicable, first += s.first, beside += s.beside, missed += s.missed, wrong += s.wrong, alone += s.alone;
        why.insert(why.end(), s.why.begin(), s.why.end());
    }
};

void judge(const MistakeMade& mistake, const CheckResult& result, Score& score)
{
    score.applicable++;
    if (!result.changed)
    {
        score.missed++;
        return;
    }
    bool isNamed = false;
    for (const NamedChange& change : result.changes)
        isNamed |= isOneOf(change.name, mistake.causes);
    if (isNamed && isOneOf(result.changes[0].name, mistake.causes))
        score.first++;
    else if (isNamed && isOneOf(result.changes[0].name, mistake.alike))
        score.beside++;
    else
    {
        score.wrong++;
        score.alone += result.changes.size() == 1;
        std::string text;
        for (const NamedChange& change : result.changes)
            text += " | " + change.sentence + cv::format(" (p %.2g)", change.probability);
        score.why.push_back(text);
    }
}

//! How far the mistake shows, without noise.
double contradiction(const CheckInput& input, const std::vector<View>& views)
{
    try
    {
        return CheckProblem(input, views, input.sigma).fitUnchanged().chiSquare;
    }
    catch (const std::exception&)
    {
        return 1e9;
    }
}

//! Calibrations of one rig; all mistakes are tried on each.
std::vector<Calibrated> calibrations(const Scene& scene, int trials, unsigned salt)
{
    std::vector<Calibrated> all;
    for (int trial = 0; trial < trials; trial++)
    {
        scenes::Random random(salt + trial);
        all.push_back(calibrated(scene, random));
    }
    return all;
}

Score scoreOf(const Scene& scene, const MistakeMade& mistake, const std::vector<Calibrated>& all, unsigned salt)
{
    Score score;
    for (size_t trial = 0; trial < all.size(); trial++)
    {
        scenes::Random random(salt + 700 + (unsigned)trial);
        const Calibrated& c = all[trial];
        RigModel now = c.truth.clone();
        mistake.change(now, random);
        // The contradiction: the true calibration against images without noise, from the same places.
        scenes::Random same(salt + 5000 + (unsigned)trial), again(salt + 5000 + (unsigned)trial);
        std::vector<View> views = newViews(scene, now, same), clean = newViews(scene, now, again, 1e-9);
        mistake.swap(views);
        mistake.swap(clean);
        CheckInput exact = c.input;
        exact.rig = c.truth.clone();
        exact.rig.targetCovariance.release();
        if (contradiction(exact, clean) < SHOWS)
            continue;
        judge(mistake, checkRig(c.input, views, FALSE_ALARM), score);
    }
    return score;
}

Score matrix(int trials, unsigned salt)
{
    Score sum;
    for (const Scene& scene : allScenes())
    {
        const std::vector<Calibrated> all = calibrations(scene, trials, salt);
        for (const MistakeMade& mistake : mistakesMade())
        {
            if (!mistake.appliesTo(scene.nominal, scene.hasPairs))
                continue;
            const Score s = scoreOf(scene, mistake, all, salt);
            std::cout << cv::format("[numbers] %-40s %-48s shows in %3d of %3d: first %3d, beside by 'or' %3d, wrong %3d, not found %3d\n",
                                    scene.name.c_str(), mistake.name.c_str(), s.applicable, trials, s.first, s.beside, s.wrong, s.missed);
            for (const std::string& why : s.why)
                std::cout << "    " << why << '\n';
            std::cout << std::flush;
            CHECK(s.alone == 0);
            sum.add(s);
        }
    }
    std::cout << cv::format("[numbers] refract_check: the true cause first or, where physics does not tell, beside by 'or': %d of %d\n",
                            sum.right(), sum.applicable);
    return sum;
}

} // namespace

TEST_CASE("The true cause of a contradiction is named: a few of each", "[check_matrix][slow]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const Score sum = matrix(2, 4000);
    CHECK(sum.applicable > 30);
    CHECK(sum.right() >= 0.95*sum.applicable);
    CHECK(sum.alone == 0);
}

TEST_CASE("The true cause of a contradiction is named: many of each", "[.monte-carlo]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const Score sum = matrix(scenes::trials(40), 9000);
    CHECK(sum.right() >= 0.95*sum.applicable);
    CHECK(sum.alone == 0);
}

static void checkRightInputs(int trials, unsigned salt)
{
    std::cout << "seed " << scenes::seed() << '\n';
    const double falseAlarm = 0.01;
    for (const Scene& scene : allScenes())
    {
        const int CHECKS = 4;           // of one calibration
        int alarms = 0;
        Calibrated c;
        for (int trial = 0; trial < trials; trial++)
        {
            scenes::Random random(salt + trial);
            if (trial % CHECKS == 0)
                c = calibrated(scene, random);
            const CheckResult result = checkRig(c.input, newViews(scene, c.truth, random), falseAlarm);
            alarms += result.changed;
            if (result.changed)
                std::cout << "    " << causesIn(result) << '\n';
        }
        std::cout << cv::format("[numbers] refract_check, %s, nothing changed: %d of %d reported as changed at 1 %%\n", scene.name.c_str(),
                                alarms, trials);
        // More than that happens once in a thousand.
        const double mean = falseAlarm*trials;
        CHECK(alarms <= mean + 3.3*std::sqrt(mean) + 1.);
    }
}

TEST_CASE("Right inputs are not warned of: a few", "[check_matrix]") { checkRightInputs(12, 100); }

TEST_CASE("Right inputs are not warned of: many", "[.monte-carlo]") { checkRightInputs(scenes::trials(400), 200); }
