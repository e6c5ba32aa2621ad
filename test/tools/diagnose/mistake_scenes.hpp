// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

/* Four rigs as they are built, with panes, boards and placements drawn from what refract_calib takes to be usual of them; what they see
of boards, without rendering; and mistakes that are made with such images. */
#ifndef REFRACT_TEST_TOOLS_MISTAKE_SCENES_HPP
#define REFRACT_TEST_TOOLS_MISTAKE_SCENES_HPP

#include "assess/calibrate_images.hpp"
#include "calibrate/units.hpp"
#include "diagnose/hypothesis_tests.hpp"
#include "measure/rig_vector.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/failure.hpp"
#include "paper_rig.hpp"

namespace mistakes {

using namespace cv;
using namespace cv::refract;
using namespace tools;

enum RigKind { ONE_IN_AIR, STEREO_IN_AIR, STEREO_IN_WATER, SHARED_WINDOW, RIG_KINDS };
const char* const RIG_NAMES[] = {"one, air", "stereo, air", "stereo, water", "shared window"};

enum Mistake { NONE_AT_ALL, THICKNESS, INDEX, MEDIUM, SQUARE, MOTION, NUDGE, WEDGE, FOCUS, PLACE, TURNED, MIRRORED,
               SWAPPED_STATES, SWAPPED_CAMERAS, UNPAIRED, UNRELATED, BOARD_SIZE, ALL_TURNED, SHUFFLED, RENUMBERED, RENUMBERED_GLASS,
               SHAPE };
const char* const MISTAKE_NAMES[] = {"none", "thickness", "index", "medium", "square", "boards moved", "boards nudged", "wedge", "focus",
                                     "camera moved", "turned", "mirrored", "direct/glass", "cameras swapped", "unpaired", "unrelated",
                                     "board size", "all turned", "shuffled", "renumbered", "glass renumbered",
                                     "shape"};

const int COLUMNS = 9, ROWS = 6;
const double BOARD_SQUARE = 25., NOISE = 0.1;

inline const Target& boardTarget()
{
    static const Target target([] {
        TargetOptions o;
        o.size = format("%dx%d", COLUMNS, ROWS);
        o.square = BOARD_SQUARE;
        return o; }());
    return target;
}

//! What is given and what is so.
struct Scene
{
    RigKind kind;
    RigModel truth;             //!< of direct images
    RigModel throughWindow;     //!< of the others
    RigCalibration calibration; //!< the images and what is given
    bool isHandHeld = false;    //!< the boards: there are no pairs

    bool inWater() const { return kind == STEREO_IN_WATER; }
    bool hasPairs() const { return kind != STEREO_IN_WATER && !isHandHeld; }
    int cameras() const { return (int)truth.cameras.size(); }
};

//! What refract_calib takes where nothing is said.
inline GivenStd usualStd(bool inWater)
{
    GivenStd std;
    std.thickness = 0.1;
    std.index = {0.001};
    std.outerIndex = inWater ? 0.001 : 0.;
    std.wedge = ARC_MINUTE;
    std.scale = 5e-4;
    std.placement = 0.02;
    return std;
}

//! A motion of all boards, about where they are.
inline RigidTransform motionOfBoards(const Vec3d& rvec, const Vec3d& moved)
{
    const Vec3d middle(0, 0, 700);
    RigidTransform motion = transformOf(rvec, Vec3d());
    motion.t = middle - motion.R*middle + moved;
    return motion;
}

inline Vec3d normalVector(scenes::Random& random, double sigma)
{
    return Vec3d(random.normal(sigma), random.normal(sigma), random.normal(sigma));
}

inline GlassWindow drawnPane(GlassWindow window, const GivenStd& std, scenes::Random& random)
{
    window.thickness[0] += random.normal(std.thickness);
    window.index[0] += random.normal(std.index[0]);
    window.outerIndex += random.normal(std.outerIndex);
    window.wedge = {Vec2d(random.normal(std.wedge), random.normal(std.wedge))};
    return window;
}

inline void drawTarget(RigModel& truth, const GivenStd& std, scenes::Random& random)
{
    truth.targetScale = 1. + random.normal(std.scale);
    truth.targetMotion = motionOfBoards(normalVector(random, std.placement/130.), normalVector(random, std.placement));
}

//! Nominal values and how they are given.
inline Scene makeScene(RigKind kind, scenes::Random& random)
{
    Scene scene;
    scene.kind = kind;
    const int cameras = kind == ONE_IN_AIR ? 1 : kind == SHARED_WINDOW ? 2 + random.below(2) : 2;
    const GivenStd std = usualStd(scene.inWater());
    scene.truth = paperRig(cameras);
    if (cameras > 2)        // below the others, and looks up to where they look
        scene.truth.extrinsics[2] = transformOf(Vec3d(-0.25, -0.02, 0.02), Vec3d(10, -170, 40));
    RigOptions& options = scene.calibration.options;
    const Vec3d tilt(random.uniform(-0.25, 0.25), random.uniform(-0.15, 0.15), 1);
    GlassWindow nominal = scene.inWater() ? GlassWindow(tilt, 10., 1.49, 40., 1.333) : GlassWindow(tilt, 20., 1.5437, 120.);
    options.window = nominal;
    options.window.normal = Vec3d(0, 0, 1);
    options.window.wedge = {Vec2d()};
    options.window.distance = scene.inWater() ? BOARD_SQUARE : 0.;
    if (scene.inWater())
        options.flags |= GLASS_FREE_DISTANCE;
    options.std = std;
    options.lensCoefficients = 4;
    if (kind == SHARED_WINDOW)
    {
        options.windows.assign(cameras, 0);
        scene.truth.windows = options.windows;
    }
    const double outer = nominal.outerIndex + random.normal(std.outerIndex);
    for (Ptr<RefractiveCamera>& camera : scene.truth.cameras)
    {
        GlassWindow pane = drawnPane(nominal, std, random);
        pane.outerIndex = outer;
        if (kind != SHARED_WINDOW)
            pane.normal = normalize(Vec3d(random.uniform(-0.25, 0.25), random.uniform(-0.15, 0.15), 1));
        camera->setWindow(pane);
    }
    scene.truth = withVector(scene.truth, toVector(scene.truth));
    scene.truth.targetCovariance = Mat::eye(TARGET_ERRORS, TARGET_ERRORS, CV_64F);
    drawTarget(scene.truth, std, random);
    scene.throughWindow = scene.truth.clone();
    RigCalibration& c = scene.calibration;
    c.square = BOARD_SQUARE;
    c.data.cameraCount = cameras;
    for (int k = 0; k < cameras; k++)
        c.data.imageSize[k] = scene.truth.cameras[k]->imageSize();
    return scene;
}

//! Before the middle of the cameras, tilted to any side.
inline RigidTransform randomBoard(scenes::Random& random)
{
    const double z = random.uniform(520, 820);
    return transformOf(random.vector(0.45), Vec3d(random.uniform(-0.1, 0.1)*z, random.uniform(-0.08, 0.08)*z, z));
}

inline std::vector<Point3d> centredBoard(double square)
{
    return board(COLUMNS, ROWS, square);
}

inline void takeOut(std::vector<Point2d>& pixels, Size size)
{
    for (Point2d& p : pixels)
        if (!Rect2d(Point2d(), Size2d(size)).contains(p))
            p = Point2d(NAN, NAN);
    if (std::count_if(pixels.begin(), pixels.end(), seen) < 12)
        pixels.clear();
}

//! Both states of one board; where it is in the images through the windows may be another place.
inline View look(const Scene& scene, const RigidTransform& place, const RigidTransform& glassPlace, bool direct, bool glass,
                 scenes::Random& random)
{
    const std::vector<Point3d> object = centredBoard(BOARD_SQUARE);
    View view = observe(scene.truth, object, rotationVector(place.R), place.t, true, NOISE, random);
    const View through = observe(scene.throughWindow, object, rotationVector(glassPlace.R), glassPlace.t, false, NOISE, random);
    view.glass = through.glass;
    view.neighbours = boardTarget().neighbours();
    for (int c = 0; c < scene.cameras(); c++)
    {
        takeOut(view.direct[c], scene.calibration.data.imageSize[c]);
        takeOut(view.glass[c], scene.calibration.data.imageSize[c]);
        if (!direct)
            view.direct[c].clear();
        if (!glass)
            view.glass[c].clear();
    }
    return view;
}

//! @param handHeld no pair is one. @param places gets where the boards are
inline void takeImages(Scene& scene, bool handHeld, scenes::Random& random, std::vector<RigidTransform>* places = nullptr)
{
    std::vector<View>& views = scene.calibration.data.views;
    const int directs = 12, glasses = scene.hasPairs() ? 6 : 12;
    for (int i = 0; i < directs || (!scene.hasPairs() && i < directs + glasses);)
    {
        const RigidTransform place = randomBoard(random), other = handHeld ? randomBoard(random) : place;
        const bool direct = i < directs, glass = scene.hasPairs() ? i < glasses : i >= directs;
        View view = look(scene, place, other, direct, glass, random);
        if (!view.hasDirect(0) && !view.hasGlass(0))
            continue;
        view.stem = format("view%02d", i++);
        views.push_back(view);
        if (places)
            places->push_back(place);
    }
}

//! As a detector that begins anywhere, and the alignment of a view's images, name the corners of changed images.
inline void alignAgain(View& view, int cameras)
{
    std::vector<std::vector<Point2d>*> images;
    for (int c = 0; c < cameras; c++)
        for (std::vector<Point2d>* pixels : {&view.direct[c], &view.glass[c]})
            if (!pixels->empty())
                images.push_back(pixels);
    for (size_t i = 1; i < images.size(); i++)
        *images[i] = boardTarget().alignWith(*images[0], *images[i]);
}

inline void turnByHalf(std::vector<Point2d>& pixels, Size size)
{
    for (Point2d& p : pixels)
        p = Point2d(size.width - 1., size.height - 1.) - p;
}

//! A mirror image of a board looks like a board whose columns are counted from the other side.
inline void mirror(std::vector<Point2d>& pixels, Size size)
{
    for (Point2d& p : pixels)
        p.x = size.width - 1. - p.x;
    for (size_t row = 0; row + COLUMNS <= pixels.size(); row += COLUMNS)
        std::reverse(pixels.begin() + row, pixels.begin() + row + COLUMNS);
}

//! The points of a file, whose numbers no image tells: from the opposite corner, or each row from its other end.
inline void renumber(std::vector<Point2d>& pixels, bool isMirrored)
{
    const size_t run = isMirrored ? COLUMNS : pixels.size();
    for (size_t first = 0; run > 0 && first + run <= pixels.size(); first += run)
        std::reverse(pixels.begin() + first, pixels.begin() + first + run);
}

//! Whether a rig can have a mistake, and its images would show it.
inline bool applies(Mistake mistake, RigKind kind)
{
    const bool water = kind == STEREO_IN_WATER;
    switch (mistake)
    {
    case THICKNESS:
    case INDEX: return !water;          // there, the distance that is estimated takes their place
    case SQUARE: return !water;         // nothing else has a length
    case UNPAIRED:
    case BOARD_SIZE:
    case MOTION:
    case NUDGE: return !water;         // needs pairs
    case MIRRORED: return true;
    case SHAPE: return water;           // in air a dome about its camera does nothing
    case PLACE:
    case SWAPPED_CAMERAS:
    case ALL_TURNED:
    case SHUFFLED:
    case RENUMBERED:
    case UNRELATED: return kind != ONE_IN_AIR;
    case RENUMBERED_GLASS:
    case TURNED: return true;
    default: return true;
    }
}

//! Images with a mistake.
inline Scene mistaken(Mistake mistake, RigKind kind, unsigned salt)
{
    scenes::Random random(salt);
    Scene scene = makeScene(kind, random);
    RigCalibration& c = scene.calibration;
    const int last = scene.cameras() - 1;
    if (mistake == MOTION)
        scene.throughWindow.targetMotion = motionOfBoards(normalVector(random, 1e-3), 0.6*normalize(normalVector(random, 1.)));
    if (mistake == NUDGE)
        scene.throughWindow.targetMotion.t = random.uniform(0.1, 0.15)*normalize(normalVector(random, 1.));
    if (mistake == WEDGE)
    {
        VectorXd numbers = toVector(scene.throughWindow);
        const double angle = random.uniform(0, 2*CV_PI);
        const int at = columnsOf(scene.throughWindow, kind == SHARED_WINDOW ? 0 : last).wedge;
        numbers[at] += 12*ARC_MINUTE*std::cos(angle);
        numbers[at + 1] += 12*ARC_MINUTE*std::sin(angle);
        scene.throughWindow = withVector(scene.throughWindow, numbers);
    }
    if (mistake == FOCUS)
    {
        Mat lens = scene.throughWindow.cameras[last]->lensParameters().clone();
        lens.rowRange(0, 2) *= 1.004;
        scene.throughWindow.cameras[last]->setLensParameters(lens);
    }
    if (mistake == PLACE)
    {
        RigidTransform& place = scene.throughWindow.extrinsics[last];
        place = transformOf(normalize(normalVector(random, 1.))*0.15*CV_PI/180, normalVector(random, 0.3))*place;
        scene.throughWindow = withVector(scene.throughWindow, toVector(scene.throughWindow));
    }
    if (mistake == SHAPE)
        for (int k = 0; k <= last; k++)
        {
            const Vec3d center(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(0, 6));
            const double radius = random.uniform(45, 60);
            const GlassWindow dome = GlassWindow::dome(center, radius, 5., 1.49, scene.truth.cameras[k]->window().outerIndex);
            scene.truth.cameras[k]->setWindow(dome);
            scene.throughWindow.cameras[k]->setWindow(dome);
        }
    if (mistake == SQUARE)
        scene.truth.targetScale *= 1.04, scene.throughWindow.targetScale *= 1.04;
    takeImages(scene, mistake == UNPAIRED, random);
    if (mistake == THICKNESS)
        c.options.window.thickness[0] *= 1.12;
    if (mistake == INDEX)
        c.options.window.index[0] = 1.47;
    if (mistake == MEDIUM)
    {
        GlassWindow& window = c.options.window;
        window.outerIndex = scene.inWater() ? 1. : 1.333;
        window.distance = scene.inWater() ? 0. : BOARD_SQUARE;
        c.options.flags = scene.inWater() ? 0 : GLASS_FREE_DISTANCE;
        c.options.std.outerIndex = scene.inWater() ? 0. : 0.001;
    }
    std::vector<View>& views = c.data.views;
    const std::vector<View> right = views;
    for (size_t i = 0; i < views.size(); i++)
    {
        View& view = views[i];
        for (int k = 0; k <= last; k++)
            if (mistake == ALL_TURNED || (mistake == TURNED && k == last))
                turnByHalf(view.glass[k], c.data.imageSize[k]);
        if (mistake == MIRRORED)
        {
            mirror(view.glass[last], c.data.imageSize[last]);
            if (last > 0)
                mirror(view.direct[last], c.data.imageSize[last]);
        }
        if (mistake == SWAPPED_STATES)
            for (int k = 0; k <= last; k++)
                std::swap(view.direct[k], view.glass[k]);
        if (mistake == SWAPPED_CAMERAS)
            std::swap(view.glass[0], view.glass[last]);
        if (mistake == UNRELATED || mistake == SHUFFLED)
        {
            // The next one of the same states.
            size_t next = i;
            do
                next = (next + 1) % right.size();
            while (right[next].countGlass() == 0 && view.countGlass() > 0);
            if (mistake == UNRELATED)
                view.direct[last] = right[next].direct[last];
            if (view.countGlass() > 0)
                view.glass[last] = right[next].glass[last];
        }
        if (mistake == BOARD_SIZE && i % 2)     // the glass image shows a part of a larger board, which begins a row later
            for (int k = 0; k <= last; k++)
            {
                std::vector<Point2d>& pixels = view.glass[k];
                if (pixels.empty())
                    continue;
                std::rotate(pixels.begin(), pixels.begin() + COLUMNS, pixels.end());
                for (size_t p = pixels.size() - COLUMNS; p < pixels.size(); p++)
                    pixels[p] = 2.*pixels[p - COLUMNS] - pixels[p - 2*COLUMNS];      // about where it would be
            }
        alignAgain(view, scene.cameras());
    }
    const bool isMirrored = salt % 2;
    for (View& view : views)
        if (mistake == RENUMBERED || mistake == RENUMBERED_GLASS)
        {
            renumber(view.glass[last], isMirrored);
            if (mistake == RENUMBERED)
                renumber(view.direct[last], isMirrored);
        }
    return scene;
}

//! What refract_calib would say was wrong; empty: nothing. Seconds that it took.
inline std::string saidOf(Scene scene)
{
    RigCalibration& c = scene.calibration;
    std::string text;
    try
    {
        calibrateImages(c, true, [] {});
        for (const Contradiction& contradiction : testGivenValues(c.data, c.options, c.fit))
            text += contradiction.sentence + (contradiction.isSure ? "" : " (not sure)");
    }
    catch (const Failure& e)
    {
        text = e.what();
    }
    return text;
}

} // namespace mistakes

#endif // REFRACT_TEST_TOOLS_MISTAKE_SCENES_HPP
