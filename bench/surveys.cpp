// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A camera behind a flat port moves above the sea floor, as photogrammetry has it: along a strip, 200 new points an image, each seen by
// seven or eight; or along lines side by side, each point seen by about ten. Lens and window are known to what a calibration says.
#include "surveys.hpp"
#include "measure.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/refract.hpp>

#include <cstdio>
#include <random>
#include <sys/resource.h>

using namespace cv;
using namespace cv::refract;

namespace bench {

namespace {

const double RANGE = 1500, RELIEF = 150;        // mm
const double REACH_ALONG = 1100, REACH_ACROSS = 900;    // mm, from the camera to what it may see
const double SIGMA = 0.3;               // px
const double BAR = 500, BAR_SIGMA = 0.1;        // lengths, one at each twentieth view
const Size IMAGE(1280, 1024);

//! What a calibration knows of a parameter.
double priorSigma(const String& name)
{
    if (name[0] == 'f' || name[0] == 'c')
        return name.find("curv") == 0 ? 0 : 0.5;
    if (name[0] == 'k' || name[0] == 'p')
        return 1e-3;
    if (name.find("normal") == 0)
        return 2e-3;
    if (name.find("distance") == 0)
        return 0.5;
    if (name.find("thickness") == 0)
        return 0.05;
    return name.find("outer") == 0 ? 5e-4 : name.find("index") == 0 ? 1e-3 : 0;
}

//! A camera's way, and its points: so many on the floor around each place of a view.
struct Way
{
    double step, across;    // mm, from view to view, and from line to line
    int points;
};
const Way STRIP = { 110, 1000, 200 }, LINES = { 320, 450, 170 };

//! Which one to make.
struct Strip
{
    Way way;
    int views, lines;
    double wrong;           // part of the observations
    unsigned seed, startSeed;
    bool hasWindow;
};

struct Survey
{
    Ptr<RefractiveCamera> camera;
    std::vector<Vec3d> rvecs, tvecs;
    std::vector<Point3d> points;
    std::vector<Vec3i> observations;
    std::vector<Point2d> pixels;
    std::vector<uchar> isWrong;
    std::vector<Vec4d> lengths;
};

Vec3d randomVector(std::mt19937_64& engine, double sigma)
{
    std::normal_distribution<double> noise(0, sigma);
    return Vec3d(noise(engine), noise(engine), noise(engine));
}

//! In the order of parameterNames(), of a flat pane without a wedge; of a camera without a window those of its lens.
std::vector<double> parametersOf(const Ptr<RefractiveCamera>& camera)
{
    const Mat_<double> lens = camera->lensParameters();
    const GlassWindow window = camera->window();
    std::vector<double> all(lens.begin(), lens.end());
    if (window.thickness.empty())
        return all;
    all.insert(all.end(), window.normal.val, window.normal.val + 3);
    all.insert(all.end(), { window.distance, window.thickness[0], window.index[0], window.innerIndex, window.outerIndex });
    CV_Assert(all.size() == camera->parameterNames().size());
    return all;
}

void setParameters(const std::vector<double>& all, const Ptr<RefractiveCamera>& camera)
{
    const int lens = camera->lensParameters().rows;
    camera->setLensParameters(Mat(std::vector<double>(all.begin(), all.begin() + lens), true));
    if ((int)all.size() == lens)
        return;
    GlassWindow window = camera->window();
    const double* const own = &all[lens];
    window.normal = normalize(Vec3d(own));
    window.distance = own[3];
    window.thickness[0] = own[4];
    window.index[0] = own[5];
    window.outerIndex = own[7];
    camera->setWindow(window);
}

//! The camera, or one that is off by what is known of it.
Ptr<RefractiveCamera> makeCamera(bool hasWindow, std::mt19937_64* off, Mat& covariance)
{
    const GlassWindow window = hasWindow ? GlassWindow(normalize(Vec3d(0.03, -0.02, 1)), 12, 1.49, 40, 1.34) : GlassWindow();
    Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d(1200, 0, 640, 0, 1200, 512, 0, 0, 1),
                                                            std::vector<double>{ -0.1, 0.05, 0, 0 }, window);
    const std::vector<String> names = camera->parameterNames();
    std::vector<double> values = parametersOf(camera);
    covariance = Mat::zeros((int)names.size(), (int)names.size(), CV_64F);
    int normal = -1;
    for (int i = 0; i < (int)values.size(); i++)
    {
        covariance.at<double>(i, i) = std::pow(priorSigma(names[i]), 2);
        normal = normal < 0 && names[i].find("normal") == 0 ? i : normal;
    }
    const Vec3d n = window.normal;
    if (normal > 0)
        Mat(std::pow(priorSigma("normal"), 2)*(Matx33d::eye() - n*n.t())).copyTo(covariance(Rect(normal, normal, 3, 3)));
    if (off)
    {
        std::normal_distribution<double> noise(0, 1);
        for (int i = 0; i < (int)values.size(); i++)
            values[i] += priorSigma(names[i])*noise(*off);
        setParameters(values, camera);
    }
    return camera;
}

//! Places of views, and around them those that points are at: more on each side, as a camera sees so far.
struct Grid
{
    explicit Grid(const Strip& strip)
        : way(strip.way), lines(strip.lines), along(strip.views/strip.lines), beside((int)std::ceil(350/way.step)),
          wide(lines > 1) {}
    int rows() const { return lines + 2*wide; }
    int columns() const { return along + 2*beside; }
    //! Lines are flown to and fro.
    Point2d placeOf(int view) const
    {
        const int line = view/along, i = view % along;
        return Point2d(way.step*(line % 2 ? along - 1 - i : i), way.across*line);
    }
    //! The first point at a place; outside: at the nearest.
    int pointAt(double x, double y) const
    {
        const int column = std::min(std::max(cvRound(x/way.step) + beside, 0), columns() - 1);
        const int row = std::min(std::max(cvRound(y/way.across) + wide, 0), rows() - 1);
        return (row*columns() + column)*way.points;
    }

    const Way way;
    const int lines, along, beside, wide;
};

std::vector<Point3d> makePoints(const Grid& grid, std::mt19937_64& engine)
{
    std::uniform_real_distribution<double> part(-0.5, 0.5);
    std::vector<Point3d> points;
    for (int row = 0; row < grid.rows(); row++)
        for (int column = 0; column < grid.columns(); column++)
            for (int k = 0; k < grid.way.points; k++)
                points.push_back(Point3d(grid.way.step*(column - grid.beside + part(engine)),
                                         grid.way.across*(row - grid.wide + part(engine)), RELIEF*part(engine)));
    return points;
}

//! From points within the strip, where most images see them.
void addLengths(const Grid& grid, int views, std::mt19937_64& engine, Survey& survey)
{
    std::normal_distribution<double> noise(0, BAR_SIGMA);
    for (int view = 6; view < views; view += 20)
    {
        const Point2d place = grid.placeOf(view);
        const int a = grid.pointAt(place.x, place.y);
        const bool isOdd = view % 40 > 20;
        const Vec3d along(isOdd ? 0.6 : 0.8, isOdd ? 0.8 : -0.6, 0);
        Point3d& end = survey.points[a + 1];
        end = survey.points[a] + Point3d(BAR*along*((survey.points[a].y - place.y)*along[1] > 0 ? -1 : 1));
        survey.lengths.push_back(Vec4d(a, a + 1, BAR + noise(engine), BAR_SIGMA));
    }
}

//! Of some points, which follow each other from the first.
void observe(const Strip& strip, int view, int first, int count, std::mt19937_64& engine, Survey& survey)
{
    std::uniform_real_distribution<double> part(0, 1);
    std::normal_distribution<double> noise(0, SIGMA);
    const std::vector<Point3d> some(survey.points.begin() + first, survey.points.begin() + first + count);
    std::vector<Point2d> pixels;
    std::vector<uchar> status;
    refractiveProjectPoints(some, survey.rvecs[view], survey.tvecs[view], survey.camera, pixels, status);
    for (size_t k = 0; k < pixels.size(); k++)
    {
        const Point2d pixel = pixels[k];
        if (status[k] != REFRACT_OK || !(pixel.x > 0 && pixel.y > 0 && pixel.x < IMAGE.width && pixel.y < IMAGE.height))
            continue;
        const bool isWrong = part(engine) < strip.wrong;
        const Vec2d off = isWrong ? 20*Vec2d(part(engine) - 0.5, part(engine) - 0.5) : Vec2d(noise(engine), noise(engine));
        survey.observations.push_back(Vec3i(view, 0, first + (int)k));
        survey.pixels.push_back(pixel + Point2d(off));
        survey.isWrong.push_back(isWrong);
    }
}

Survey makeSurvey(const Strip& strip)
{
    std::mt19937_64 engine(strip.seed);
    const Grid grid(strip);
    const Way& way = strip.way;
    Survey survey;
    Mat unused;
    survey.camera = makeCamera(strip.hasWindow, nullptr, unused);
    survey.points = makePoints(grid, engine);
    addLengths(grid, strip.views, engine, survey);
    for (int view = 0; view < grid.along*grid.lines; view++)
    {
        const Point2d place = grid.placeOf(view);
        const Vec3d rvec = randomVector(engine, 0.05), centre = Vec3d(place.x, place.y, -RANGE) + randomVector(engine, 30);
        Matx33d R;
        Rodrigues(rvec, R);
        survey.rvecs.push_back(rvec);
        survey.tvecs.push_back(-(R*centre));
        const int reach = strip.lines > 1 ? (int)std::ceil(REACH_ACROSS/way.across) : 0;
        int before = -1;
        for (int line = -reach; line <= reach; line++)
        {
            const int first = grid.pointAt(place.x - REACH_ALONG, place.y + line*way.across);
            const int last = grid.pointAt(place.x + REACH_ALONG, place.y + line*way.across) + way.points;
            if (first != before)        // else it is beyond the last line
                observe(strip, view, first, last - first, engine, survey);
            before = first;
        }
    }
    return survey;
}

//! What was found.
struct Found : BundleAdjustResult
{
    double cpu, clock;
    std::vector<Mat> rvecs, tvecs;
    std::vector<Point3d> points;
    Ptr<RefractiveCamera> camera;
};

//! Cameras are off by half a degree and 10 mm, but for the first.
Found adjust(const Strip& strip, const Survey& survey)
{
    std::mt19937_64 engine(strip.startSeed);
    Found found;
    Mat prior;
    found.camera = makeCamera(strip.hasWindow, &engine, prior);
    for (size_t view = 0; view < survey.rvecs.size(); view++)
    {
        Matx33d R, offR;
        Rodrigues(survey.rvecs[view], R);
        const Vec3d rvec = survey.rvecs[view] + (view > 0)*randomVector(engine, 0.5*CV_PI/180);
        const Vec3d centre = -(R.t()*survey.tvecs[view]) + (view > 0)*randomVector(engine, 10);
        Rodrigues(rvec, offR);
        found.rvecs.push_back(Mat(rvec, true));
        found.tvecs.push_back(Mat(-(offR*centre), true));
    }
    found.points.assign(survey.points.size(), Point3d(NAN, NAN, NAN));
    BundleAdjustOptions options((strip.wrong > 0 ? GLASS_ROBUST : 0) | (strip.hasWindow ? 0 : GLASS_FIX_NORMAL));
    options.rigCovariance = prior;
    const double begin = processorSeconds(), clock = (double)getTickCount();
    std::vector<Mat> Rs, Ts;
    static_cast<BundleAdjustResult&>(found) = refractiveBundleAdjust(survey.observations, survey.pixels, { found.camera }, {}, Rs, Ts,
                                                                     found.rvecs, found.tvecs, found.points, survey.lengths, options);
    found.cpu = processorSeconds() - begin;
    found.clock = ((double)getTickCount() - clock)/getTickFrequency();
    return found;
}

//! Root mean square of errors of the poses over their stated standard deviations.
double posesOverStated(const Survey& survey, const Found& found)
{
    double sum = 0;
    for (size_t view = 1; view < survey.rvecs.size(); view++)
    {
        Mat_<double> error(6, 1);
        Mat(found.rvecs[view] - Mat(survey.rvecs[view])).copyTo(error.rowRange(0, 3));
        Mat(found.tvecs[view] - Mat(survey.tvecs[view])).copyTo(error.rowRange(3, 6));
        Mat solved;
        solve(found.viewCovariances[view], error, solved, DECOMP_CHOLESKY);
        sum += error.dot(solved)/6;
    }
    return std::sqrt(sum/(survey.rvecs.size() - 1));
}

double pointsOverStated(const Survey& survey, const Found& found)
{
    double sum = 0;
    int count = 0;
    for (size_t i = 0; i < survey.points.size(); i++)
    {
        const Vec3d error(found.points[i] - survey.points[i]);
        if (!std::isfinite(error[0]))
            continue;
        for (int k = 0; k < 3; k++)
            sum += std::pow(error[k]/found.pointDeviations.at<double>((int)i, k), 2);
        count += 3;
    }
    return std::sqrt(sum/count);
}

double cameraOverStated(const Survey& survey, const Found& found)
{
    const std::vector<double> truth = parametersOf(survey.camera), own = parametersOf(found.camera);
    double sum = 0;
    int count = 0;
    for (int i = 0; i < (int)truth.size(); i++)
        if (found.stdDeviations.at<double>(i) > 0)
        {
            sum += std::pow((own[i] - truth[i])/found.stdDeviations.at<double>(i), 2);
            count++;
        }
    return std::sqrt(sum/count);
}

//! A strip, or an area as long as it is wide.
Strip stripOf(int views, bool isArea, double wrong)
{
    const int lines = isArea ? cvRound(std::sqrt(views*LINES.step/LINES.across)) : 1;
    return { isArea ? LINES : STRIP, views/lines*lines, lines, wrong, (unsigned)views, 7, true };
}

//! @return seconds
double run(const Strip& strip, double secondsBefore, int viewsBefore)
{
    const int views = strip.views;
    const double wrong = strip.wrong;
    const Survey survey = makeSurvey(strip);
    const Found found = adjust(strip, survey);
    // A point that too few see to tell which of them is wrong is left out as a whole. What is wrong by less than the noise pulls its
    // point away from the others.
    std::vector<uchar> isPulled(survey.points.size(), 0);
    size_t lost[2] = { 0, 0 }, good[2] = { 0, 0 }, kept = 0;
    for (size_t i = 0; i < survey.isWrong.size(); i++)
        if (survey.isWrong[i] && found.inliers[0].at<uchar>((int)i))
            isPulled[survey.observations[i][2]] = 1;
    for (size_t i = 0; i < survey.isWrong.size(); i++)
    {
        const int point = survey.observations[i][2];
        if (!std::isfinite(found.points[point].x))
            continue;
        good[isPulled[point]] += !survey.isWrong[i];
        lost[isPulled[point]] += !survey.isWrong[i] && !found.inliers[0].at<uchar>((int)i);
        kept += survey.isWrong[i] && found.inliers[0].at<uchar>((int)i);
    }
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    std::printf("%7d%9zu%9zu%9.1f%9.1f%7ld%9.3f%8.2f%8.2f%8.2f", views, survey.points.size(), survey.pixels.size(), found.cpu, found.clock,
                usage.ru_maxrss/1024, found.rms, posesOverStated(survey, found), pointsOverStated(survey, found),
                cameraOverStated(survey, found));
    if (wrong > 0)
        std::printf("%11.0f%11zu%11.1e%11.1e", 100*wrong, kept, (double)lost[0]/(double)good[0], (double)lost[1]/(double)good[1]);
    else if (viewsBefore > 0)
        std::printf("%11.2f", std::log(found.cpu/secondsBefore)/std::log((double)views/viewsBefore));
    std::printf("\n");
    std::fflush(stdout);
    return found.cpu;
}

void printHead(const char* last)
{
    std::printf("\n%7s%9s%9s%9s%9s%7s%9s%8s%8s%8s%s\n", "views", "points", "pixels", "CPU, s", "clock, s", "MB", "RMS, px", "poses",
                "points", "camera", last);
}

//! Of several strips: what is off in a camera is off in all points of its strip alike.
void runMany(int views, int strips, bool hasWindow)
{
    double poses = 0, points = 0, camera = 0, seconds = 0;
    for (int i = 0; i < strips; i++)
    {
        const unsigned seed = 1000u*(i + 1) + views;
        const Strip strip = { STRIP, views, 1, 0, seed, seed + 7, hasWindow };
        const Survey survey = makeSurvey(strip);
        const Found found = adjust(strip, survey);
        poses += std::pow(posesOverStated(survey, found), 2)/strips;
        points += std::pow(pointsOverStated(survey, found), 2)/strips;
        camera += std::pow(cameraOverStated(survey, found), 2)/strips;
        seconds += found.cpu/strips;
    }
    std::printf("%-17s%7d%8d%9.1f%8.2f%8.2f%8.2f\n", hasWindow ? "through its port" : "without a window", strips, views, seconds,
                std::sqrt(poses), std::sqrt(points), std::sqrt(camera));
    std::fflush(stdout);
}

} // namespace

void printManySurveys(int views, int strips)
{
    std::printf("strips of other seeds; error/sigma, RMS\n%-17s%7s%8s%9s%8s%8s%8s\n", "", "strips", "views", "CPU, s", "poses", "points",
                "camera");
    for (const bool hasWindow : { true, false })
        runMany(views, strips, hasWindow);
}

void printSurveys(int least, int most, bool isArea)
{
    std::printf("%s through a flat port in water, lens and window within their priors; poses, points, camera: error/sigma\n",
                isArea ? "lines side by side" : "a strip");
    printHead("    views^x");
    double seconds = 0;
    int before = 0;
    for (int views : { 20, 60, 100, 300, 1000, 3000, 6000 })
        if (views >= least && views <= most)
        {
            const Strip strip = stripOf(views, isArea, 0);
            seconds = run(strip, seconds, before);
            before = strip.views;
        }
    printHead("    wrong, % wrong kept  good lost of others");
    for (int views : { 20, 100, 300, 1000 })
        if (views >= least && views <= most)
            run(stripOf(views, isArea, 0.1), 0, 0);
}

} // namespace bench
