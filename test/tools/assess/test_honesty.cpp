// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

/* Is a stated +- true, in every flow of refract_calib? RMS error over RMS stated, over many trials, of points, normal,
distance, lens, R and T. The long form is hidden: run with [.honesty]. */
#include "measure/eigen_matrix.hpp"
#include "measure/joint_error.hpp"
#include "measure/point_error.hpp"
#include "measure/measurement.hpp"
#include "assess/cross_validation.hpp"
#include "calibrate/fit.hpp"
#include "calibrate/lens_choice.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/outliers.hpp"
#include "math/dense.hpp"
#include "paper_rig.hpp"
#include "simulate/render.hpp"
#include <map>

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

const double SIGMA = 0.1;       // px

enum class Flow { PAIRS, HAND_HELD, SEALED, SHARED_WALL, ROBUST, KNOWN_POSES };
enum class Medium { AIR, HOUSING, SURFACE, LAMINATE };

struct Setup
{
    Flow flow;
    Medium medium;
    int cameras;
    bool rendered = false;          // corners found in rendered images; else computed, with noise
    GivenStd std = {};              // of the given values, which are drawn from them; scale and placement too
    std::vector<double> lens = {};  // true coefficients, of a lens that is chosen (--lens=auto); empty: it is the paper's

    std::string name() const
    {
        static const char* const FLOWS[] = {"pairs", "hand-held", "sealed", "shared wall", "robust, 5 % wrong",
                                             "known poses"};
        static const char* const MEDIA[] = {"air", "housing in water", "bare surface", "laminate"};
        return format("%s, %s, %d camera(s)%s", FLOWS[(int)flow], MEDIA[(int)medium], cameras,
                      rendered ? ", rendered" : isDrawn() ? ", given values drawn" : "")
            + (choosesLens() ? format(", lens chosen of %d coefficients", (int)lens.size()) : std::string());
    }
    bool choosesLens() const { return !lens.empty(); }
    bool isDrawn() const { return std.ofWindow() || std.scale > 0. || std.placement > 0.; }
    bool inWater() const { return medium == Medium::HOUSING || medium == Medium::SURFACE; }
    bool paired() const { return flow == Flow::PAIRS || flow == Flow::ROBUST; }
    bool hasDirect() const { return flow != Flow::SEALED; }
    bool shared() const { return flow == Flow::SHARED_WALL; }
};

GlassWindow windowOf(const Setup& setup, const Vec3d& normal)
{
    GlassWindow window;
    window.normal = normalize(normal);
    switch (setup.medium)
    {
    case Medium::AIR:
        return paper::pane(50, normal);
    case Medium::HOUSING:
        return GlassWindow(normal, 10., 1.49, 40., 1.333);
    case Medium::SURFACE:
        window.distance = 80.;
        window.outerIndex = 1.333;
        return window;
    case Medium::LAMINATE:
        window.thickness = {6., 1.5, 6.};
        window.index = {1.52, 1.48, 1.52};
        window.distance = 50.;
        return window;
    }
    return window;
}

RigModel trueRig(const Setup& setup)
{
    RigModel rig = paperRig(setup.cameras);
    for (Ptr<RefractiveCamera>& camera : rig.cameras)
        if (setup.choosesLens())
        {
            camera = RefractiveCamera::create(camera->cameraMatrix(), setup.lens);
            camera->setImageSize(Size(1280, 1024));
        }
    rig.cameras[0]->setWindow(windowOf(setup, paper::NORMAL1));
    if (setup.cameras == 1)
        return rig;
    GlassWindow second = windowOf(setup, paper::NORMAL2);
    if (setup.shared())
    {
        second = rig.cameras[0]->window();
        second.normal = rig.extrinsics[1].R*second.normal;
        second.distance += second.normal.dot(rig.extrinsics[1].t);
        if (second.distance < 20.)
        {
            GlassWindow first = rig.cameras[0]->window();
            first.distance += 20. - second.distance;
            second.distance = 20.;
            rig.cameras[0]->setWindow(first);
        }
    }
    rig.cameras[1]->setWindow(second);
    return rig;
}

GlassWindow drawn(GlassWindow window, const Setup& setup, scenes::Random& random)
{
    for (double& thickness : window.thickness)
        thickness += random.normal(setup.std.thickness);
    for (double& index : window.index)
        index += random.normal(setup.std.indexOf(0));
    if (setup.inWater())
        window.outerIndex += random.normal(setup.std.outerIndex);
    for (size_t i = 0; i < window.thickness.size() && setup.std.wedge > 0.; i++)
        window.wedge.push_back(Vec2d(random.normal(setup.std.wedge), random.normal(setup.std.wedge)));
    return window;
}

//! A rig, and a target, of which only so much was known.
RigModel drawn(const RigModel& nominal, const Setup& setup, scenes::Random& random)
{
    RigModel rig = nominal.clone();
    if (!setup.isDrawn())
        return rig;
    for (size_t c = 0; c < rig.cameras.size(); c++)
    {
        GlassWindow window = drawn(nominal.cameras[c]->window(), setup, random);
        if (c > 0 && setup.shared())        // one pane: what does not depend on the frame
        {
            window = rig.cameras[0]->window();
            window.normal = nominal.cameras[c]->window().normal;
            window.distance = nominal.cameras[c]->window().distance;
        }
        rig.cameras[c]->setWindow(window);
    }
    rig.targetCovariance = Mat::eye(TARGET_ERRORS, TARGET_ERRORS, CV_64F);      // there are such errors
    rig.targetScale = 1. + random.normal(setup.std.scale);
    const Vec3d middle(0, 0, 700);
    const double radius = norm(Vec3d(100, 62.5, 0)), turn = setup.std.placement/radius;
    Rodrigues(Vec3d(random.normal(turn), random.normal(turn), random.normal(turn)), rig.targetMotion.R);
    const double shift = setup.std.placement;
    rig.targetMotion.t = middle - rig.targetMotion.R*middle + Vec3d(random.normal(shift), random.normal(shift), random.normal(shift));
    return rig;
}

void displaceSome(std::vector<Point2d>& pixels, double part, scenes::Random& random)
{
    for (Point2d& p : pixels)
        if (random.uniform(0, 1) < part)
            p += random.uniform(3, 20)*Point2d(std::cos(random.uniform(0, 7)), std::sin(random.uniform(0, 7)));
}

const Target& renderedBoard()
{
    static const Target board([] { TargetOptions o; o.size = "9x6"; o.square = 20.; return o; }());
    return board;
}

bool allInside(const std::vector<Point2d>& pixels)
{
    return !pixels.empty() &&
           std::all_of(pixels.begin(), pixels.end(), [](const Point2d& p) { return Rect2d(20, 20, 1240, 984).contains(p); });
}

//! The corners that are found in a rendered image; none if the board is not all in it.
std::vector<Point2d> findRendered(const RigModel& rig, int c, bool glass, Vec3d rvec, Vec3d tvec, scenes::Random& random)
{
    poseInCamera(rig, c, rvec, tvec);
    const Ptr<RefractiveCamera> camera = glass ? rig.cameras[c] : copyWithWindow(rig.cameras[c], GlassWindow());
    const Mat image = render(renderedBoard(), {rvec, tvec}, Viewpoint{camera}, Exposure(), (uint64_t)random.uniform(0, 1e9));
    return renderedBoard().detect(image);
}

//! A board before camera 1, tilted anyhow, its middle near the optical axis.
BoardPose randomPose(const std::vector<Point3d>& object, scenes::Random& random)
{
    BoardPose pose;
    pose.rvec = random.vector(0.45);
    const double z = random.uniform(500, 900);
    Matx33d R;
    Rodrigues(pose.rvec, R);
    const Vec3d middle = 0.5*(Vec3d(object.front()) + Vec3d(object.back()));
    pose.tvec = Vec3d(random.uniform(-0.12, 0.12)*z, random.uniform(-0.1, 0.1)*z, z) - R*middle;
    return pose;
}

//! What the cameras see, without what lies outside the images.
View look(const RigModel& rig, const std::vector<Point3d>& object, const BoardPose& pose, bool direct, bool glass,
          const Setup& setup, scenes::Random& random)
{
    const Vec3d rvec = pose.rvec, tvec = pose.tvec;
    View view = observe(rig, object, rvec, tvec, direct, SIGMA, random);
    for (int c = 0; c < (int)rig.cameras.size() && setup.rendered; c++)
        for (bool through : {false, true})
        {
            std::vector<Point2d>& pixels = (through ? view.glass : view.direct)[c];
            if (allInside(pixels) && (through ? glass : direct))
                pixels = findRendered(rig, c, through, rvec, tvec, random);
            else
                pixels.clear();
        }
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        for (std::vector<Point2d>* pixels : {&view.direct[c], &view.glass[c]})
        {
            for (Point2d& p : *pixels)
                if (!Rect2d(0, 0, 1280, 1024).contains(p))
                    p = Point2d(NAN, NAN);
            if (setup.flow == Flow::ROBUST)
                displaceSome(*pixels, 0.05, random);
            if (std::count_if(pixels->begin(), pixels->end(), seen) < 12)
                pixels->clear();
        }
    if (!glass)
        view.glass[0].clear(), view.glass[1].clear();
    return view;
}

//! The images of a calibration, and where the board truly was in each.
struct Images
{
    RigData data;
    std::vector<BoardPose> poses;
};

Images takeImages(const RigModel& rig, const Setup& setup, scenes::Random& random)
{
    Images images;
    RigData& data = images.data;
    data.cameraCount = setup.cameras;
    const std::vector<Point3d> object = setup.rendered ? renderedBoard().objectPoints() : board(9, 6, 25.);
    data.imageSize[0] = data.imageSize[1] = Size(1280, 1024);
    const int directs = 14, glasses = setup.paired() ? 6 : setup.hasDirect() ? 15 : 25;
    const auto take = [&](bool direct, bool glass)
    {
        View view;
        BoardPose pose;
        while (!view.hasDirect(0) && !view.hasGlass())          // a rendered board may not be all in the image
        {
            pose = randomPose(object, random);
            view = look(rig, object, pose, direct, glass, setup, random);
        }
        view.stem = "view" + std::to_string(data.views.size());
        images.poses.push_back(pose);
        data.views.push_back(view);
    };
    for (int i = 0; setup.hasDirect() && i < directs; i++)
        take(true, setup.paired() && i < glasses);
    for (int i = 0; !setup.paired() && i < glasses; i++)
        take(false, true);
    return images;
}

//! A robot tells where the board is, within its +-; the lens, from the direct images, is free.
Fit fitAtKnownPoses(const RigData& data, const std::vector<BoardPose>& poses, const RigModel& start, int flags,
                    scenes::Random& random)
{
    const double sigmaR = 2e-4, sigmaT = 0.05;      // rad, mm
    Mat poseCovariance = Mat::zeros(6, 6, CV_64F);
    for (int i = 0; i < 6; i++)
        poseCovariance.at<double>(i, i) = std::pow(i < 3 ? sigmaR : sigmaT, 2);
    const auto noise = [&](double s) { return Vec3d(random.normal(s), random.normal(s), random.normal(s)); };
    Fit fit;
    fit.rig = start.clone();
    const int cameras = data.cameraCount;
    std::vector<std::vector<Mat>> direct(cameras), glass(cameras);
    for (size_t i = 0; i < poses.size(); i++)
    {
        fit.rvecs.push_back(poses[i].rvec + noise(sigmaR));
        fit.tvecs.push_back(poses[i].tvec + noise(sigmaT));
        for (int c = 0; c < cameras; c++)
        {
            direct[c].push_back(Mat(data.views[i].direct[c], true));
            glass[c].push_back(Mat(data.views[i].glass[c], true));
        }
    }
    std::vector<Mat> Rs, Ts;
    for (int c = 0; c < cameras; c++)
    {
        Rs.push_back(Mat(start.extrinsics[c].R, true));
        Ts.push_back(Mat(start.extrinsics[c].t, true));
    }
    GlassRigOptions options(flags | GLASS_USE_POSES | GLASS_FREE_INTRINSICS | GLASS_FREE_EXTRINSICS);
    options.poseCovariances.assign(poses.size(), poseCovariance);
    const std::vector<std::vector<Point3d>> objectPoints(poses.size(), data.views[0].objectPoints);
    const GlassRigResult result = calibrateGlassRig(objectPoints, direct, glass, fit.rig.cameras, std::vector<int>(), Rs, Ts, fit.rvecs,
                                                    fit.tvecs, options);
    setEstimate(result, fit);
    fit.imageStatus = result.imageStatus;
    fit.inliers = result.inliers;
    if (cameras == 2)
    {
        fit.rig.extrinsics[1] = {Rs[1], Ts[1]};
    }
    return fit;
}

//! As refract_calib does it; poses, which it does not know, as a caller of the library.
Fit calibrate(const Images& images, const Setup& setup, const RigModel& nominal, scenes::Random& random)
{
    RigData data = images.data;
    RigOptions options;
    options.window = nominal.cameras[0]->window();
    options.std = setup.std;
    if (setup.inWater() == false)
        options.std.outerIndex = 0.;
    if (setup.std.wedge > 0.)
        options.window.wedge.assign(options.window.thickness.size(), Vec2d());
    options.window.normal = Vec3d(0, 0, 1);
    options.lensCoefficients = 4;
    if (setup.inWater())
    {
        options.window.distance = 25.;
        options.flags |= GLASS_FREE_DISTANCE;
    }
    if (setup.shared())
        options.windows = {0, 0};
    if (!setup.hasDirect())
        options.flags |= GLASS_FREE_INTRINSICS;
    if (setup.choosesLens())
        setLens(chooseLens(data, options, false), options);
    std::vector<LensSource> sources;
    RigModel start;
    if (setup.flow == Flow::ROBUST)
        startWithoutOutliers(data, options, start, sources);
    else
        start = startModel(data, options, sources);
    if (setup.flow == Flow::KNOWN_POSES)
        return fitAtKnownPoses(data, images.poses, start, options.flags, random);
    return fitAllImages(data, start, sources, options.flags);
}

//! Errors and stated deviations of one kind of number.
struct Ratio
{
    double errors = 0., stated = 0.;
    int count = 0;
    std::vector<double> each;
    std::vector<Point2d> upTo;              // errors and stated, up to the end of each trial
    void add(double error, double deviation)
    {
        if (!(deviation > 0.))
            return;
        errors += error*error;
        stated += deviation*deviation;
        each.push_back(std::abs(error)/deviation);
        count++;
    }
    double value() const { return std::sqrt(errors/stated); }
    void endTrial() { upTo.emplace_back(errors, stated); }

    //! Of value(): numbers of one rig err together, so that rigs are left out in turn (jackknife).
    double standardError() const
    {
        double squares = 0.;
        for (size_t t = 0; t < upTo.size(); t++)
        {
            const Point2d without = upTo.back() - upTo[t] + (t ? upTo[t - 1] : Point2d());
            squares += std::pow(std::sqrt(without.x/without.y) - value(), 2);
        }
        return upTo.size() > 1 ? std::sqrt(squares*(double)(upTo.size() - 1)/(double)upTo.size()) : NAN;
    }
    double within(double sigmas) const
    {
        return (double)std::count_if(each.begin(), each.end(), [=](double e) { return e < sigmas; })/(double)each.size();
    }
};

struct Honesty
{
    std::map<std::string, Ratio> ratios;
    int refused = 0, trials = 0;
    std::string why;
};

//! Errors of a part of the parameters, each in its principal directions.
void addParameters(Ratio& ratio, const Mat& covariance, int first, const std::vector<double>& errors)
{
    const int count = (int)errors.size();
    for (int i = 0; i < count; i++)
        ratio.add(errors[i], std::sqrt(covariance.at<double>(first + i, first + i)));
}

void compare(const Fit& fit, const RigModel& truth, Honesty& honesty)
{
    Mat C = fit.covariance;
    for (int c = 0; c < (int)truth.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(fit.rig, c);
        const Mat lens = fit.rig.cameras[c]->lensParameters(), trueLens = truth.cameras[c]->lensParameters();
        std::vector<double> errors;
        for (int i = 0; i < at.lensCount; i++)
            errors.push_back(lens.at<double>(i) - trueLens.at<double>(i));
        addParameters(honesty.ratios["f"], C, at.lens, {errors[0], errors[1]});
        addParameters(honesty.ratios["c"], C, at.lens + 2, {errors[2], errors[3]});
        addParameters(honesty.ratios["k"], C, at.lens + 4, {errors[4], errors[5]});
        const GlassWindow w = fit.rig.cameras[c]->window(), t = truth.cameras[c]->window();
        addParameters(honesty.ratios["normal"], C, at.normal, {w.normal[0] - t.normal[0], w.normal[1] - t.normal[1]});
        if (w.innerIndex != w.outerIndex)
            addParameters(honesty.ratios["distance"], C, at.distance, {w.distance - t.distance});
    }
    if (truth.cameras.size() == 2)
    {
        Vec3d r, rt;
        Rodrigues(fit.rig.extrinsics[1].R, r);
        Rodrigues(truth.extrinsics[1].R, rt);
        const int at = columnsOf(fit.rig, 1).end;
        addParameters(honesty.ratios["R"], C, at, {r[0] - rt[0], r[1] - rt[1], r[2] - rt[2]});
        const Vec3d d = fit.rig.extrinsics[1].t - truth.extrinsics[1].t;
        addParameters(honesty.ratios["T"], C, at + 3, {d[0], d[1], d[2]});
    }
}

//! Lengths between points of the working volume, each to all others.
void compareLengths(const Calibration& calibration, const std::vector<Point3d>& points, const RigPixels& pixels, const Measurement& m,
                    Honesty& honesty)
{
    const JointError joint = jointErrorOf(calibration, m.points, pixels, std::nullopt);
    const MatrixXd C = toEigen(calibration.covariance);
    for (size_t i = 0; i < points.size(); i++)
        for (size_t j = 0; j < i; j++)
        {
            const Vec3d along = normalize(Vec3d(points[i] - points[j]));
            const MatrixXd by = Eigen::Map<const Eigen::RowVector3d>(along.val)*(joint.byCalibration[i] - joint.byCalibration[j]);
            honesty.ratios["lengths"].add(norm(m.points[i] - m.points[j]) - norm(points[i] - points[j]),
                                          std::sqrt(propagated(C, by)(0, 0)));
        }
}

//! Points of the working volume, of pixels without noise: the calibration's part alone.
void comparePoints(const Fit& fit, const RigModel& truth, Honesty& honesty)
{
    Calibration calibration = calibrationOf(fit.rig);
    calibration.covariance = fit.covariance;
    std::vector<Point3d> points;
    for (double z : {550., 700., 850.})
        for (double x : {-0.1, 0., 0.1})
            for (double y : {-0.08, 0.08})
                points.emplace_back(x*z, y*z, z);
    std::vector<Point2d> pixels1, pixels2;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), truth.cameras[0], pixels1);
    const double none = 1e-9;
    if (truth.cameras.size() == 2)
    {
        refractiveProjectPoints(points, Mat(truth.extrinsics[1].R), truth.extrinsics[1].t, truth.cameras[1], pixels2);
        const Measurement m = measureRig(calibration, {pixels1, pixels2}, none);
        compareLengths(calibration, points, {pixels1, pixels2}, m, honesty);
        for (size_t i = 0; i < points.size(); i++)
            for (int k = 0; k < 3; k++)
                honesty.ratios["points"].add((Vec3d(m.points[i]) - Vec3d(points[i]))[k], m.sigma[i][k]);
        return;
    }
    for (size_t i = 0; i < points.size(); i++)
    {
        const Measurement m = measureOnPlane(calibration, {pixels1[i]}, Vec4d(0, 0, 1, points[i].z), none);
        for (int k = 0; k < 2; k++)
            honesty.ratios["points"].add((Vec3d(m.points[0]) - Vec3d(points[i]))[k], m.sigma[0][k]);
    }
}

Honesty honestyOf(const Setup& setup, int trials, unsigned salt)
{
    Honesty honesty;
    const RigModel nominal = trueRig(setup);
    for (int trial = 0; trial < trials; trial++)
    {
        scenes::Random random(salt + trial);
        const RigModel truth = drawn(nominal, setup, random);
        const Images images = takeImages(truth, setup, random);
        honesty.trials++;
        try
        {
            const Fit fit = calibrate(images, setup, nominal, random);
            if (fit.dof > 0 && !setup.rendered)         // known poses: the priors' residuals are no pixels
                honesty.ratios["noise"].add(fit.sigma - SIGMA, SIGMA/std::sqrt(2.*fit.dof));
            if (!setup.choosesLens())
                compare(fit, truth, honesty);
            comparePoints(fit, truth, honesty);
            for (auto& entry : honesty.ratios)
                entry.second.endTrial();
        }
        catch (const std::exception& e)
        {
            honesty.refused++;
            honesty.why = e.what();
        }
    }
    return honesty;
}

void print(const Setup& setup, const Honesty& honesty)
{
    std::cout << "[numbers] error over stated, " << setup.name() << " (" << honesty.trials << " trials, " << honesty.refused
              << " refused):";
    for (const auto& entry : honesty.ratios)
        std::cout << ' ' << entry.first << format(" %.2f +- %.2f (%.0f%%)", entry.second.value(), entry.second.standardError(),
                                                 100*entry.second.within(1.96));
    std::cout << std::endl;
    if (honesty.refused)
        std::cout << "    " << honesty.why << std::endl;
}

//! Prints, and fails where the ratios of many trials are not near 1, as far as so many trials tell.
void checkStated(const Setup& setup, const Honesty& honesty)
{
    const double NEAR = 1.1, STANDARD_ERRORS = 4., REFUSED = 0.05;
    print(setup, honesty);
    CAPTURE(setup.name());
    CHECK(honesty.refused <= REFUSED*honesty.trials);
    for (const auto& entry : honesty.ratios)
    {
        CAPTURE(entry.first);       // its standard error is in proportion to it
        const double ratio = entry.second.value();
        CHECK(std::abs(std::log(ratio)) < std::log(NEAR) + STANDARD_ERRORS*entry.second.standardError()/ratio);
    }
}

std::vector<Setup> allSetups()
{
    std::vector<Setup> setups;
    for (Flow flow : {Flow::PAIRS, Flow::HAND_HELD, Flow::SEALED, Flow::SHARED_WALL, Flow::ROBUST, Flow::KNOWN_POSES})
        for (Medium medium : {Medium::AIR, Medium::HOUSING, Medium::SURFACE, Medium::LAMINATE})
            for (int cameras : {1, 2})
                if (flow != Flow::SHARED_WALL || cameras == 2)
                    setups.push_back({flow, medium, cameras});
    return setups;
}

} // namespace

TEST_CASE("A stated +- of points is true in every flow: a few trials", "[honesty][slow]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const struct { Setup setup; int trials; } cases[] = {
        {{Flow::PAIRS, Medium::AIR, 2}, 8},
        {{Flow::HAND_HELD, Medium::AIR, 1}, 12},
        {{Flow::HAND_HELD, Medium::HOUSING, 1}, 12},
        {{Flow::SHARED_WALL, Medium::SURFACE, 2}, 6},
        {{Flow::SEALED, Medium::AIR, 1}, 4},
        {{Flow::SEALED, Medium::SURFACE, 1}, 3},
        {{Flow::ROBUST, Medium::LAMINATE, 1}, 6},
        {{Flow::KNOWN_POSES, Medium::HOUSING, 2}, 6}};
    for (const auto& c : cases)
    {
        CAPTURE(c.setup.name());
        const Honesty honesty = honestyOf(c.setup, c.trials, 8000);
        print(c.setup, honesty);
        CHECK(honesty.refused == 0);
        // So few trials leave that much room; the flaw that this is for was a factor of five.
        CHECK(honesty.ratios.at("points").value() < 2.);
        CHECK(honesty.ratios.at("points").value() > 0.4);
        CHECK((!honesty.ratios.count("noise") || honesty.ratios.at("noise").value() < 3.));
    }
}

//! What a data sheet and a careful user know.
static GivenStd dataSheet()
{
    GivenStd std;
    std.thickness = 0.05;
    std.index = {0.003};
    std.outerIndex = 0.001;
    std.wedge = CV_PI/180./60.;
    std.scale = 2e-4;
    std.placement = 0.03;
    return std;
}

TEST_CASE("Panes, media, squares and placements drawn from what is known of them: a few trials", "[honesty][slow]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const struct { Flow flow; Medium medium; int cameras, trials; } cases[] = {
        {Flow::PAIRS, Medium::AIR, 2, 8},
        {Flow::PAIRS, Medium::HOUSING, 1, 10},
        {Flow::HAND_HELD, Medium::LAMINATE, 1, 10},
        {Flow::SHARED_WALL, Medium::AIR, 2, 6},
        {Flow::ROBUST, Medium::HOUSING, 2, 6}};
    for (const auto& c : cases)
    {
        Setup setup{c.flow, c.medium, c.cameras, false, dataSheet()};
        if (setup.shared())
            setup.std.wedge = 0.;           // whose axes and thickness depend on the frame
        CAPTURE(setup.name());
        const Honesty honesty = honestyOf(setup, c.trials, 8000);
        print(setup, honesty);
        CHECK(honesty.refused == 0);
        for (const char* what : {"points", "normal"})
        {
            CHECK(honesty.ratios.at(what).value() < 1.8);       // ignored, a wedge of 1' makes the normal wrong a hundredfold
            CHECK(honesty.ratios.at(what).value() > 0.5);
        }
    }
}

TEST_CASE("Every flow, with given values drawn from what is known of them: two hundred trials", "[.honesty][flows]")
{
    const char* only = std::getenv("ONLY");     // some of the flows
    for (Setup setup : allSetups())
    {
        setup.std = dataSheet();
        if (setup.shared())
            setup.std.wedge = 0.;
        if (setup.flow != Flow::KNOWN_POSES && (!only || setup.name().find(only) != std::string::npos))
            checkStated(setup, honestyOf(setup, scenes::trials(200), 9000));
    }
}

TEST_CASE("Every flow states a true +-: two hundred trials", "[.honesty][flows]")
{
    const char* only = std::getenv("ONLY");     // some of the flows
    for (const Setup& setup : allSetups())
        if (!only || setup.name().find(only) != std::string::npos)
            checkStated(setup, honestyOf(setup, scenes::trials(200), 9000));
}

TEST_CASE("Sealed rigs of which the lens is chosen: points and lengths", "[.honesty][flows]")
{
    const char* only = std::getenv("ONLY");     // some of the rigs
    for (const std::vector<double>& lens : std::vector<std::vector<double>>{{-0.41, 0.44, 0, 0}, {-0.41, 0.44, 1e-4, -7e-5},
                                                                            {-0.41, 0.44, 1e-4, -7e-5, 0.3}})
        for (Medium medium : {Medium::AIR, Medium::SURFACE, Medium::HOUSING})
        {
            Setup setup{Flow::SEALED, medium, 2};
            setup.lens = lens;
            if (!only || setup.name().find(only) != std::string::npos)
                checkStated(setup, honestyOf(setup, scenes::trials(20), 9200));
        }
}

TEST_CASE("A sealed rig's windows are not tilted the other way, and the second best minimum is told", "[honesty]")
{
    const struct { int cameras; unsigned seed; } rigs[] = {
        {1, 9037},      // ten of its views have their least error with the window tilted the other way
        {2, 9060}};     // one window after the other does not lead to the best of four combinations
    for (const auto& r : rigs)
    {
        CAPTURE(r.cameras);
        const Setup setup{Flow::SEALED, Medium::AIR, r.cameras};
        const RigModel truth = trueRig(setup);
        scenes::Random random(r.seed);
        const Images images = takeImages(truth, setup, random);
        const Fit fit = calibrate(images, setup, truth, random);
        for (int c = 0; c < r.cameras; c++)
        {
            const int at = columnsOf(fit.rig, c).normal;
            const double sigma = std::sqrt(trace(fit.covariance(Rect(at, at, 3, 3)))[0]);
            CHECK(norm(fit.rig.cameras[c]->window().normal - truth.cameras[c]->window().normal) < 4.*sigma);
        }
        int told = 0;
        for (int c = 0; c < r.cameras; c++)     // of the window, or windows, that it has elsewhere
        {
            const double excess = fit.otherMinima.at<double>(c, 3);
            if (std::isnan(excess))
                continue;
            told++;
            CHECK(norm(Vec3d(fit.otherMinima.ptr<double>(c)) - fit.rig.cameras[c]->window().normal) > 0.01);
            CHECK(excess > 3.);                 // excluded, by all views
        }
        CHECK(told > 0);
    }
}

TEST_CASE("A moment whose images are all left out does not end a calibration", "[honesty]")
{
    const Setup setup{Flow::PAIRS, Medium::AIR, 2};
    const RigModel truth = trueRig(setup);
    scenes::Random random(9022);
    Images images = takeImages(truth, setup, random);
    images.data.views[7].direct[0].clear();         // both seemed to show a moved board
    images.data.views[7].direct[1].clear();
    REQUIRE_FALSE(images.data.views[7].hasGlass());
    const Fit fit = calibrate(images, setup, truth, random);
    CHECK(fit.views.size() == images.data.views.size() - 1);
    CHECK(fit.sigma == Approx(SIGMA).epsilon(0.1));
}

TEST_CASE("Boards that took no part are as far off as stated, and the check sees where they are not", "[honesty][slow]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const Setup setup{Flow::HAND_HELD, Medium::HOUSING, 1};
    const RigModel truth = trueRig(setup);
    HeldOutTest stated, tooSure;
    for (int trial = 0; trial < 10; trial++)
    {
        scenes::Random random(8100 + trial);
        const Images images = takeImages(truth, setup, random);
        const Fit fit = calibrate(images, setup, truth, random);
        const std::vector<Point3d>& object = images.data.views[0].objectPoints;
        std::vector<View> fresh;
        for (int i = 0; i < 5; i++)
            fresh.push_back(look(truth, object, randomPose(object, random), true, true, setup, random));     // pairs: they tell most
        stated.add(testHeldOut(fit.rig, fit.covariance, fit.sigma, fresh));
        tooSure.add(testHeldOut(fit.rig, Mat(0.04*fit.covariance), fit.sigma, fresh));
    }
    std::cout << "[numbers] held-out boards, error over stated: " << stated.calibrationRatio() << "; +- five times too small: "
              << tooSure.calibrationRatio() << std::endl;
    // Ten calibrations with a dozen parameters each; most of a fresh pair's misfit is the calibration's.
    CHECK(stated.ratio() == Approx(1.).margin(0.4));
    CHECK(stated.calibrationRatio() == Approx(1.).margin(0.4));
    CHECK(tooSure.calibrationRatio() > 2.);
}

namespace {

//! The variance that a calibration's covariance gives to the length between two points that both cameras see.
double lengthVariance(const Fit& fit, const Point3d& a, const Point3d& b)
{
    const std::vector<Point3d> points = {a, b};
    const Vec3d along = normalize(Vec3d(b - a));
    Eigen::RowVectorXd byParameters;
    for (int i = 0; i < 2; i++)
    {
        const ViewDerivatives view = differentiateView(fit.rig, points, Vec3d(), Vec3d(), {{0, true, {i}}, {1, true, {i}}});
        const Eigen::MatrixXd B = view.byPose.rightCols(3);        // the pose is the identity: by its T is by the point
        const Eigen::MatrixXd dX = product(pseudoInverse(B), view.byParameters);
        const Eigen::RowVectorXd part = Eigen::RowVector3d(along[0], along[1], along[2])*dX;
        byParameters = i == 0 ? Eigen::RowVectorXd(part) : Eigen::RowVectorXd(byParameters - part);
    }
    return byParameters*toEigen(fit.covariance)*byParameters.transpose();
}

//! Two cameras before a wall or each behind its port, in water; few views from afar, some corners wrong.
struct SealedRig
{
    RigModel truth;
    RigData data;
    bool shared;

    explicit SealedRig(scenes::Random& random) : shared(random.uniform(0, 1) < 0.5)
    {
        truth = paperRig(2);
        const double toe = random.uniform(0.05, 0.25);
        Rodrigues(Vec3d(random.normal(0.02), toe, random.normal(0.02)), truth.extrinsics[1].R);
        truth.extrinsics[1].t = Vec3d(-random.uniform(200, 500), random.normal(10), random.uniform(-100, 100));
        GlassWindow window(Vec3d(random.normal(0.1), random.normal(0.1), 1), 12, 1.49, random.uniform(120, 300), 1.333);
        truth.cameras[0]->setWindow(window);
        window.normal = truth.extrinsics[1].R*window.normal;
        window.distance += window.normal.dot(truth.extrinsics[1].t);
        if (!shared)
            window.normal = normalize(Vec3d(random.normal(0.1), random.normal(0.1), 1));
        window.distance = std::max(window.distance, 10.);
        if (shared)
        {
            GlassWindow first = truth.cameras[0]->window();
            first.distance = window.distance - window.normal.dot(truth.extrinsics[1].t);
            truth.cameras[0]->setWindow(first);
        }
        truth.cameras[1]->setWindow(window);
        data.cameraCount = 2;
        data.imageSize[0] = data.imageSize[1] = Size(1280, 1024);
        const int views = 5 + (int)random.uniform(0, 6);
        for (int i = 0; i < views; i++)
        {
            const double z = random.uniform(1000, 3000);
            View view = observe(truth, board(9, 6, 60.), random.vector(0.5), Vec3d(random.uniform(-0.1, 0.1)*z,
                               random.uniform(-0.08, 0.08)*z, z), false, 0.3, random);
            view.stem = "view" + std::to_string(i);
            for (int c = 0; c < 2; c++)
            {
                for (Point2d& p : view.glass[c])
                    if (!Rect2d(0, 0, 1280, 1024).contains(p))
                        p = Point2d(NAN, NAN);
                displaceSome(view.glass[c], 0.05, random);
                if (std::count_if(view.glass[c].begin(), view.glass[c].end(), seen) < 12)
                    view.glass[c].clear();
            }
            data.views.push_back(view);
        }
    }
};

} // namespace

TEST_CASE("Five hundred sealed rigs from afar, few views, wrong corners: no crash, and intervals of lengths hold", "[.honesty][flows]")
{
    const int count = scenes::trials(500);
    Ratio lengths;
    int answers = 0;
    std::map<std::string, int> refusals;
    for (int trial = 0; trial < count; trial++)
    {
        scenes::Random random(20000 + trial);
        const SealedRig scene(random);
        try
        {
            RigOptions options;
            options.window = scene.truth.cameras[0]->window();
            options.window.normal = Vec3d(0, 0, 1);
            options.window.distance = 60.;
            options.flags = GLASS_FREE_DISTANCE | GLASS_FREE_INTRINSICS;
            if (scene.shared)
                options.windows = {0, 0};
            options.lensCoefficients = 4;
            std::vector<LensSource> sources;
            RigData data = scene.data;
            RigModel start;
            startWithoutOutliers(data, options, start, sources);
            const Fit fit = fitAllImages(data, start, sources, options.flags);
            const Point3d a(-60, 20, 1800), b(60, -30, 2000);
            std::vector<Point2d> pixels1, pixels2;
            std::vector<Point3d> points;
            refractiveProjectPoints(std::vector<Point3d>{a, b}, Vec3d(), Vec3d(), scene.truth.cameras[0], pixels1);
            refractiveProjectPoints(std::vector<Point3d>{a, b}, Mat(scene.truth.extrinsics[1].R), scene.truth.extrinsics[1].t,
                                    scene.truth.cameras[1], pixels2);
            triangulateRefractive(fit.rig.cameras[0], fit.rig.cameras[1], fit.rig.extrinsics[1].R, fit.rig.extrinsics[1].t, pixels1,
                                  pixels2, points);
            answers++;
            lengths.add(norm(points[1] - points[0]) - norm(b - a), std::sqrt(lengthVariance(fit, points[0], points[1])));
        }
        catch (const std::exception& e)
        {
            refusals[std::string(e.what()).substr(0, 60)]++;
        }
    }
    std::cout << "[numbers] sealed rigs from afar: " << answers << " of " << count << " answer; 95 % intervals of a length hold "
              << 100*lengths.within(1.96) << " %, error over stated " << lengths.value() << std::endl;
    for (const auto& refusal : refusals)
        std::cout << "    " << refusal.second << " x " << refusal.first << std::endl;
    CHECK(answers > 0);
}

TEST_CASE("A stated +- is true from rendered images, where corners err together", "[.honesty]")
{
    for (const Setup& setup : {Setup{Flow::PAIRS, Medium::AIR, 1, true}, Setup{Flow::HAND_HELD, Medium::AIR, 1, true},
                               Setup{Flow::HAND_HELD, Medium::HOUSING, 1, true}, Setup{Flow::PAIRS, Medium::AIR, 2, true}})
        checkStated(setup, honestyOf(setup, scenes::trials(20), 9500));
}
