// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

/* A camera and a laser, each behind its own tilted pane in water: the sheet from images of boards, then the steps of a block, against their
stated uncertainty; beside them a plane for the sheet, and the camera's window ignored. The camera's window is known with errors, as a
calibration leaves them, and so is how the laser was built. */
#include "laser/scan_line.hpp"
#include "laser/sheet_fit.hpp"
#include "laser/sheet.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/rig_model.hpp"
#include "console/failure.hpp"
#include "laser_behind_pane.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <iostream>

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

const double CORNER = 0.05, DEGREE = CV_PI/180.;
const double CAMERA_NORMAL = 0.03*DEGREE, CAMERA_DISTANCE = 0.3, CAMERA_THICKNESS = 0.05;                   // standard deviations
const double TURNED = 1.5*DEGREE, PLACED = 4., NORMAL = 0.3*DEGREE, DISTANCE = 1.;                          // of the emitter
const double HEIGHTS[] = {500., 450., 430., 400.};                                                          // z of the block's faces

TexturedScene block()
{
    TexturedScene scene = laser::wall(HEIGHTS[0]);
    for (int i = 1; i < 4; i++)
        scene.surfaces.push_back(laser::bar(Vec3d(-90. + 40*i, 0, HEIGHTS[i]), Size2d(20, 100)));
    return scene;
}

Vec3d tangent(const Vec3d& n, double a, double b)
{
    const Vec3d b1 = normalize(n.cross(Vec3d(0, 1, 0))), b2 = n.cross(b1);
    return normalize(n + a*b1 + b*b2);
}

//! The camera as a calibration finds it, with the covariance that this error is drawn from.
Calibration calibrated(const Calibration& truth, scenes::Random& random)
{
    Calibration calibration = truth;
    const Ptr<RefractiveCamera> camera = truth.cameras[0].camera;
    const ParameterColumns at = columnsOf(*camera);
    GlassWindow window = camera->window();
    const Vec3d n = window.normal;
    window.normal = tangent(n, random.normal(CAMERA_NORMAL), random.normal(CAMERA_NORMAL));
    window.distance += random.normal(CAMERA_DISTANCE);
    window.thickness[0] += random.normal(CAMERA_THICKNESS);
    calibration.cameras[0].camera = copyWithWindow(camera, window);
    calibration.cameras[0].camera->setImageSize(camera->imageSize());
    calibration.covariance = Mat::zeros(at.end, at.end, CV_64F);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            calibration.covariance.at<double>(at.normal + i, at.normal + j) = CAMERA_NORMAL*CAMERA_NORMAL*((i == j) - n[i]*n[j]);
    calibration.covariance.at<double>(at.distance, at.distance) = CAMERA_DISTANCE*CAMERA_DISTANCE;
    calibration.covariance.at<double>(at.thickness, at.thickness) = CAMERA_THICKNESS*CAMERA_THICKNESS;
    return calibration;
}

//! The emitter as its drawing has it, from which it was built with errors.
EmitterPrior drawing(const Emitter& truth, scenes::Random& random)
{
    Emitter drawn = truth;
    drawn.R = rotationMatrix(Vec3d(random.normal(TURNED), random.normal(TURNED), random.normal(TURNED)))*truth.R;
    drawn.position += Vec3d(random.normal(PLACED), random.normal(PLACED), random.normal(PLACED));
    GlassWindow window = truth.camera->window();
    window.normal = tangent(window.normal, random.normal(NORMAL), random.normal(NORMAL));
    window.distance += random.normal(DISTANCE);
    drawn.camera = copyWithWindow(truth.camera, window);
    const TemporaryFolder folder;
    const std::string path = folder / "emitter.yml";
    {
        FileStorage fs(path, FileStorage::WRITE);
        writeEmitter(fs, drawn);
        fs << "rotation_std_deg" << TURNED/DEGREE << "position_std" << PLACED << "glass_window_std" << "{" << "normal_deg"
           << std::vector<double>(2, NORMAL/DEGREE) << "distance" << DISTANCE << "}";
    }
    return EmitterPrior(path);
}

//! What the camera saw.
struct Images
{
    std::vector<std::vector<Point2d>> corners;
    std::vector<Mat> boards;
    Mat scan;
    TrueLine line;          // on the block

    Images(const Calibration& camera, const LightSource& source, int count, scenes::Random& random)
    {
        const Viewpoint view = {camera.cameras[0].camera};
        Illumination light;
        light.sources = {source};
        for (int i = 0; i < count; i++)
        {
            const laser::Pose pose = laser::randomPose(random);
            light.seed = (uint64_t)random.uniform(1, 1e9);
            boards.push_back(laserSignal(render(laser::board(), {pose.rvec, pose.tvec}, view, laser::exposure(), light.seed + 7, &light),
                                         LASER_GREEN));
            std::vector<Point2d> pixels;
            refractiveProjectPoints(laser::board().objectPoints(), pose.rvec, pose.tvec, view.camera, pixels);
            for (Point2d& p : pixels)
                p += Point2d(random.normal(CORNER), random.normal(CORNER));
            corners.push_back(pixels);
        }
        light.seed = (uint64_t)random.uniform(1, 1e9);
        scan = laserSignal(renderScene(block(), view, laser::exposure(), light.seed + 7, &light), LASER_GREEN);
        line = trueLine(source, true, block(), view);
    }

    std::vector<BoardImage> linesFor(const Calibration& calibration) const
    {
        std::vector<BoardImage> images;
        for (size_t i = 0; i < boards.size(); i++)
            images.push_back(findLinesOnBoard(std::to_string(i), calibration, laser::board(), corners[i], boards[i], 1.8));
        return images;
    }

    //! Which face of the block a pixel of the line is on; -1: none, or too near to its ends.
    int faceOf(const Point2d& pixel) const
    {
        const size_t END = 12;
        for (size_t i = END; i + END < line.pixels.size(); i++)
            if (norm(pixel - line.pixels[i]) < 2. && line.points[i - END][2] - line.points[i + END][2] == 0.)
                for (int face = 0; face < 4; face++)
                    if (std::abs(line.points[i][2] - HEIGHTS[face]) < 1e-6)
                        return face;
        return -1;
    }
};

//! Heights of the block's faces over its back: their errors, and one standard deviation.
struct Steps
{
    double error[3], sigma[3];
};

Steps stepsOf(const Images& images, const Calibration& calibration, const Sheet& sheet)
{
    const ScanLine line = findScanLine(images.scan, calibration, sheet, Vec2d(0, 1e9));
    std::vector<RidgePoint> points[4], all;
    std::vector<int> faces;
    for (const RidgePoint& p : line.points)
    {
        const int face = images.faceOf(p.pixel);
        if (face < 0)
            continue;
        faces.push_back(face);
        all.push_back(p);
        points[face].push_back(p);
    }
    const Measurement m = measureOnSheet(calibration, sheet, all);
    const OnSheetDerivatives d = differentiateOnSheet(calibration, sheet, all, m.points);
    const MatrixXd C = covarianceOfCamera1(calibration, d.byParameters.cols()), ofSheet = toEigen(sheet.covariance);
    Steps steps;
    for (int face = 1; face < 4; face++)
    {
        REQUIRE(points[0].size() > 30);
        REQUIRE(points[face].size() > 30);
        double height = 0., noise = 0.;
        Eigen::RowVectorXd byState = Eigen::RowVectorXd::Zero(d.byState.cols()), byParameters = Eigen::RowVectorXd::Zero(C.rows());
        for (size_t i = 0; i < all.size(); i++)
        {
            const double share = faces[i] == face ? 1./points[face].size() : faces[i] == 0 ? -1./points[0].size() : 0.;
            if (share == 0.)
                continue;
            height += share*m.points[i].z;
            byState += share*d.byState.row(3*i + 2);
            byParameters += share*d.byParameters.row(3*i + 2);
            // Neighbours share their noise, which a ridge's Gaussian smears.
            noise += std::pow(share*all[i].sigma*d.byAcross(3*i + 2, 0), 2)*independentAfter(sheet.scale);
        }
        steps.error[face - 1] = height - (HEIGHTS[face] - HEIGHTS[0]);
        steps.sigma[face - 1] = std::sqrt(noise + (byState*ofSheet*byState.transpose())(0, 0)
                                          + (byParameters*C*byParameters.transpose())(0, 0));
    }
    return steps;
}

struct Tally
{
    double squares = 0., ratios = 0., worst = 0.;
    int count = 0, covered = 0, refused = 0;

    void add(const Steps& steps)
    {
        for (int k = 0; k < 3; k++)
        {
            squares += steps.error[k]*steps.error[k];
            ratios += std::pow(steps.error[k]/steps.sigma[k], 2);
            worst = std::max(worst, std::abs(steps.error[k]));
            covered += std::abs(steps.error[k]) <= 2*steps.sigma[k];
            count++;
        }
    }
    double rms() const { return std::sqrt(squares/count); }
    double ratio() const { return std::sqrt(ratios/count); }
    void print(const std::string& name) const
    {
        std::cout << "[numbers] two panes, steps of a block, " << name << ": " << rms() << " mm RMS, " << worst << " at most, " << covered
                  << " of " << count << " within U (k = 2), " << ratio() << " x stated";
        std::cout << (refused ? "; " + std::to_string(refused) + " rigs refused\n" : "\n");
    }
};

struct Comparison
{
    Tally bent, nearest, plane, ignored;
    double heldOut = 0., least = INFINITY;

    //! A plane, which may be refused.
    static void addBaseline(Tally& tally, const Images& images, const Calibration& calibration, const std::vector<BoardImage>& lines)
    {
        try
        {
            tally.add(stepsOf(images, calibration, fitSheet(lines, calibration, CORNER, 1.8).sheet));
        }
        catch (const Failure&)
        {
            tally.refused++;
        }
    }

    void run(int trials)
    {
        const Calibration truth = laser::camera();
        const LightSource source = laser::laserBehindPane();
        for (int trial = 0; trial < trials; trial++)
        {
            scenes::Random random(2980 + trial);
            const Images images(truth, source, 10, random);
            const Calibration calibration = calibrated(truth, random);
            const EmitterPrior prior = drawing(source.emitter, random);
            const std::vector<BoardImage> lines = images.linesFor(calibration);
            const SheetFit fit = fitSheet(lines, calibration, CORNER, 1.8, &prior);
            CHECK(fit.moved < 4.5);
            bent.add(stepsOf(images, calibration, fit.sheet));
            heldOut += std::pow(fit.heldOutRatio(), 2)/trials;
            least = std::min(least, fit.planeExcess);
            Sheet flat = fit.sheet;         // the nearest plane to the very same lines
            flat.emitter = Emitter();
            flat.covariance = Mat::zeros(4, 4, CV_64F);
            flat.byParameters = Mat::zeros(4, fit.sheet.byParameters.cols, CV_64F);
            nearest.add(stepsOf(images, calibration, flat));
            addBaseline(plane, images, calibration, lines);
            Calibration none = truth;
            none.cameras[0].camera = copyWithWindow(truth.cameras[0].camera, GlassWindow());
            none.cameras[0].camera->setImageSize(laser::IMAGE);
            addBaseline(ignored, images, none, images.linesFor(none));
        }
        std::cout << "seed " << scenes::seed() << ", " << trials << " rigs\n";
        bent.print("the sheet refracted at its window");
        plane.print("a plane for the sheet");
        std::cout << "[numbers] two panes, steps of a block, the nearest plane to the lines of the bent sheet: " << nearest.rms()
                  << " mm RMS, " << nearest.worst << " at most\n";
        ignored.print("the camera's window ignored");
        std::cout << "[numbers] two panes: boards held out " << std::sqrt(heldOut) << " x stated; chi-square of a plane larger by " << least
                  << " or more\n";
    }
};

} // namespace

TEST_CASE("Steps of a block by a laser and a camera, each behind its pane, are within their uncertainty", "[laser][two_panes]")
{
    Comparison c;
    c.run(1);
    CHECK(c.bent.ratio() < 2.3);            // 0.1 % of three, were they independent
    CHECK(c.bent.rms() < 0.2);
    CHECK(c.nearest.rms() > 4*c.bent.rms());
    CHECK(c.plane.rms() > 4*c.bent.rms());
    CHECK(c.ignored.rms() > 10*c.bent.rms());
    CHECK(c.least > 100.);
}

TEST_CASE("Steps of a block behind two panes, many rigs", "[.][monte-carlo][two_panes_many]")
{
    Comparison c;
    c.run(20);
    CHECK(c.bent.ratio() > 0.75);           // three steps of a rig share most of their error
    CHECK(c.bent.ratio() < 1.3);
    CHECK(c.bent.covered >= 0.87*c.bent.count);
}

TEST_CASE("Derivatives of an emitter's sheet are those of differences", "[laser][two_panes]")
{
    scenes::Random random(2977);
    const LightSource source = laser::laserBehindPane();
    const EmitterPrior prior = drawing(source.emitter, random);
    const Calibration calibration = laser::camera();
    std::vector<Point2d> pixels;
    std::vector<RidgePoint> line;
    for (int i = 0; i < 6; i++)
    {
        pixels.emplace_back(120. + 80*i, 180. + 20*i);
        line.push_back({pixels.back(), normalize(Vec2d(0.2, 1.)), 1., 0.1});
    }
    Sheet sheet;
    sheet.emitter = source.emitter;
    const Eigen::Index states = prior.basis().rows(), parameters = columnsOf(*calibration.cameras[0].camera).end;
    sheet.byParameters = Mat::zeros((int)states, (int)parameters, CV_64F);
    std::vector<Point3d> X;
    std::vector<uchar> status;
    pointsOnSheet(calibration, sheet, pixels, X, status);
    REQUIRE(countNonZero(status) == 0);
    const SheetDistances at = distancesFromEmitter(sheet.emitter, X);
    const OnSheetDerivatives on = differentiateOnSheet(calibration, sheet, line, X);
    CHECK(at.e.cwiseAbs().maxCoeff() < 1e-8);
    const auto agree = [](const VectorXd& expected, const VectorXd& found)
    { return (expected - found).cwiseAbs().maxCoeff() < 1e-4*expected.cwiseAbs().maxCoeff() + 1e-7; };
    const auto asVector = [](const std::vector<Point3d>& points)
    {
        VectorXd v(3*points.size());
        for (size_t i = 0; i < points.size(); i++)
            v.segment(3*i, 3) << points[i].x, points[i].y, points[i].z;
        return v;
    };

    // By the state: the sheet moves, points on it stay where they are, and pixels see others.
    const double H = 1e-3;
    for (Eigen::Index k = 0; k < prior.basis().cols(); k++)
    {
        VectorXd step = VectorXd::Zero(prior.basis().cols());
        step[k] = H;
        const Emitter more = prior.moved(source.emitter, step), less = prior.moved(source.emitter, -step);
        CAPTURE(k);
        CHECK(agree((distancesFromEmitter(more, X).e - distancesFromEmitter(less, X).e)/(2*H), at.byState*prior.basis().col(k)));
        Sheet moved = sheet;
        std::vector<Point3d> after, before;
        moved.emitter = more;
        pointsOnSheet(calibration, moved, pixels, after, status);
        moved.emitter = less;
        pointsOnSheet(calibration, moved, pixels, before, status);
        CHECK(agree((asVector(after) - asVector(before))/(2*H), on.byState*prior.basis().col(k)));
        // Turned by degrees from the prior, a rotation vector adds up to some hundredths only.
        CHECK((prior.deviation(more) - prior.deviation(less) - 2*step).cwiseAbs().maxCoeff() < 0.05*H);
    }
    // By the point: a unit normal.
    for (int k = 0; k < 3; k++)
    {
        std::vector<Point3d> more = X, less = X;
        for (size_t i = 0; i < X.size(); i++)
        {
            (&more[i].x)[k] += H;
            (&less[i].x)[k] -= H;
        }
        CHECK(agree((distancesFromEmitter(sheet.emitter, more).e - distancesFromEmitter(sheet.emitter, less).e)/(2*H), at.byPoint.col(k)));
    }
    // By the pixel, and by the camera's window.
    std::vector<Point2d> up = pixels, down = pixels;
    for (size_t i = 0; i < pixels.size(); i++)
    {
        up[i] += H*Point2d(line[i].across);
        down[i] -= H*Point2d(line[i].across);
    }
    std::vector<Point3d> after, before;
    pointsOnSheet(calibration, sheet, up, after, status);
    pointsOnSheet(calibration, sheet, down, before, status);
    CHECK(agree((asVector(after) - asVector(before))/(2*H), on.byAcross));
    const ParameterColumns columns = columnsOf(*calibration.cameras[0].camera);
    std::vector<Point3d> ends[2];
    for (int sign : {1, -1})
    {
        Calibration other = calibration;
        GlassWindow window = calibration.cameras[0].camera->window();
        window.distance += sign*H;
        other.cameras[0].camera = copyWithWindow(calibration.cameras[0].camera, window);
        pointsOnSheet(other, sheet, pixels, ends[sign < 0], status);
    }
    CHECK(agree((asVector(ends[0]) - asVector(ends[1]))/(2*H), on.byParameters.col(columns.distance)));
}

TEST_CASE("A sheet that crosses its window straight is a plane, with and without its emitter", "[laser][two_panes]")
{
    LightSource source = laser::laserBehindPane();
    source.emitter.camera = copyWithWindow(source.emitter.camera, GlassWindow(Vec3d(0, 0.1, 1), 8., 1.52, 30., 1.333));
    source.emitter.camera->setImageSize(Size(400, 1200));
    scenes::Random random(2979);
    const Calibration truth = laser::camera();
    const Images images(truth, source, 6, random);
    const EmitterPrior prior = drawing(source.emitter, random);
    const std::vector<BoardImage> lines = images.linesFor(truth);
    const SheetFit bent = fitSheet(lines, truth, CORNER, 1.8, &prior), plane = fitSheet(lines, truth, CORNER, 1.8);
    CHECK(std::abs(bent.planeExcess) < 25.);
    const Steps one = stepsOf(images, truth, bent.sheet), two = stepsOf(images, truth, plane.sheet);
    for (int k = 0; k < 3; k++)
        CHECK(std::abs(one.error[k] - two.error[k]) < 3*std::hypot(one.sigma[k], two.sigma[k]));
}

TEST_CASE("An emitter's sheet comes back from its file, and one that sends no light is refused", "[laser][two_panes]")
{
    LightSource source = laser::laserBehindPane();
    scenes::Random random(2978);
    const Calibration truth = laser::camera();
    const Images images(truth, source, 6, random);
    const std::vector<BoardImage> lines = images.linesFor(truth);
    const EmitterPrior prior = drawing(source.emitter, random);
    const SheetFit fit = fitSheet(lines, truth, CORNER, 1.8, &prior);
    const TemporaryFolder folder;
    writeSheet(folder / "sheet.yml", fit.sheet, truth);
    const Sheet back = readSheet(folder / "sheet.yml", truth);
    REQUIRE_FALSE(isPlane(back));
    const std::vector<Point2d> pixels = {Point2d(100, 200), Point2d(320, 240), Point2d(500, 220)};
    std::vector<Point3d> before, after;
    std::vector<uchar> status;
    pointsOnSheet(truth, fit.sheet, pixels, before, status);
    pointsOnSheet(truth, back, pixels, after, status);
    for (size_t i = 0; i < pixels.size(); i++)
        CHECK(norm(before[i] - after[i]) < 1e-9);
    CHECK(norm(fit.sheet.covariance, back.covariance) == 0.);

    // Its window behind it, as seen from the boards: turned away from them.
    source.emitter.R = Matx33d(1, 0, 0, 0, -1, 0, 0, 0, -1)*source.emitter.R;
    const EmitterPrior away = drawing(source.emitter, random);
    CHECK_THROWS_WITH(fitSheet(lines, truth, CORNER, 1.8, &away), Catch::Contains("sends no light to the boards"));
}
