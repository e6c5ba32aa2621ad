// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A camera behind a flat port moves along a strip of the sea floor, as photogrammetry has it: 200 new points an image, each seen by
// seven or eight. Lens and window are known to what a calibration says.
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

const double RANGE = 1500, STEP = 110, WIDTH = 1000, RELIEF = 150;      // mm
const int PER_VIEW = 200;               // new points
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

//! Which one to make.
struct Strip
{
    int views;
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

Survey makeSurvey(const Strip& strip)
{
    const int views = strip.views;
    std::mt19937_64 engine(strip.seed);
    std::uniform_real_distribution<double> part(0, 1);
    std::normal_distribution<double> noise(0, SIGMA);
    Survey survey;
    Mat unused;
    survey.camera = makeCamera(strip.hasWindow, nullptr, unused);
    const double length = STEP*views + 700;
    const int count = PER_VIEW*views;
    for (int i = 0; i < count; i++)
        survey.points.push_back(Point3d(length*(i + part(engine))/count - 350, WIDTH*(part(engine) - 0.5), RELIEF*(part(engine) - 0.5)));
    for (int view = 6; view < views; view += 20)        // within the strip, where seven or eight images see it
    {
        const int a = PER_VIEW*view + PER_VIEW/2;
        const bool isOdd = view % 40 > 20;
        const Vec3d along(isOdd ? 0.6 : 0.8, isOdd ? 0.8 : -0.6, 0);
        Point3d& end = survey.points[a + 1];
        end = survey.points[a] + Point3d(BAR*along*(survey.points[a].y*along[1] > 0 ? -1 : 1));
        survey.lengths.push_back(Vec4d(a, a + 1, BAR + BAR_SIGMA/SIGMA*noise(engine), BAR_SIGMA));
    }
    for (int view = 0; view < views; view++)
    {
        const Vec3d rvec = randomVector(engine, 0.05), centre = Vec3d(STEP*view, 0, -RANGE) + randomVector(engine, 30);
        Matx33d R;
        Rodrigues(rvec, R);
        survey.rvecs.push_back(rvec);
        survey.tvecs.push_back(-(R*centre));
        const int near = (int)(PER_VIEW*1100/STEP), middle = (int)((STEP*view + 350)/length*count);
        const int begin = std::max(0, middle - near), end = std::min(count, middle + near);
        const std::vector<Point3d> some(survey.points.begin() + begin, survey.points.begin() + end);
        std::vector<Point2d> pixels;
        std::vector<uchar> status;
        refractiveProjectPoints(some, rvec, survey.tvecs.back(), survey.camera, pixels, status);
        for (size_t k = 0; k < pixels.size(); k++)
        {
            const Point2d pixel = pixels[k];
            if (status[k] != REFRACT_OK || !(pixel.x > 0 && pixel.y > 0 && pixel.x < IMAGE.width && pixel.y < IMAGE.height))
                continue;
            const bool isWrong = part(engine) < strip.wrong;
            const Vec2d off = isWrong ? 20*Vec2d(part(engine) - 0.5, part(engine) - 0.5) : Vec2d(noise(engine), noise(engine));
            survey.observations.push_back(Vec3i(view, 0, begin + (int)k));
            survey.pixels.push_back(pixel + Point2d(off));
            survey.isWrong.push_back(isWrong);
        }
    }
    return survey;
}

//! What was found.
struct Found
{
    double rms, cpu, clock;
    std::vector<Mat> rvecs, tvecs, viewCovariances;
    std::vector<Point3d> points;
    Mat pointDeviations, deviations;
    std::vector<uchar> inliers;
    Ptr<RefractiveCamera> camera;
};

//! Cameras are off by half a degree and 10 mm, but for the first.
Found adjust(const Strip& strip, const Survey& survey)
{
    std::mt19937_64 engine(strip.startSeed);
    Found found;
    Mat prior, covariance, perViewErrors;
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
    const int flags = (strip.wrong > 0 ? GLASS_ROBUST : 0) | (strip.hasWindow ? 0 : GLASS_FIX_NORMAL);
    const double begin = processorSeconds(), clock = (double)getTickCount();
    std::vector<Mat> Rs, Ts;
    found.rms = refractiveBundleAdjust(survey.observations, survey.pixels, { found.camera }, {}, Rs, Ts, found.rvecs, found.tvecs,
                                       found.points, survey.lengths, found.deviations, covariance, found.viewCovariances,
                                       found.pointDeviations, perViewErrors, found.inliers, flags, noArray(),
                                       TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 1000, 1e-12), noArray(), noArray(), prior);
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
        if (found.deviations.at<double>(i) > 0)
        {
            sum += std::pow((own[i] - truth[i])/found.deviations.at<double>(i), 2);
            count++;
        }
    return std::sqrt(sum/count);
}

//! @return seconds
double run(int views, double wrong, double secondsBefore, int viewsBefore)
{
    const Strip strip = { views, wrong, (unsigned)views, 7, true };
    const Survey survey = makeSurvey(strip);
    const Found found = adjust(strip, survey);
    size_t lost = 0, kept = 0, good = 0;        // a point that too few see to tell which of them is wrong is left out as a whole
    for (size_t i = 0; i < survey.isWrong.size(); i++)
    {
        if (!std::isfinite(found.points[survey.observations[i][2]].x))
            continue;
        good += !survey.isWrong[i];
        lost += !survey.isWrong[i] && !found.inliers[i];
        kept += survey.isWrong[i] && found.inliers[i];
    }
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    std::printf("%7d%9zu%9zu%9.1f%9.1f%7ld%9.3f%8.2f%8.2f%8.2f", views, survey.points.size(), survey.pixels.size(), found.cpu, found.clock,
                usage.ru_maxrss/1024, found.rms, posesOverStated(survey, found), pointsOverStated(survey, found),
                cameraOverStated(survey, found));
    if (wrong > 0)
        std::printf("%11.0f%11.1e%11zu", 100*wrong, (double)lost/(double)good, kept);
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
        const Strip strip = { views, 0, seed, seed + 7, hasWindow };
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

void printSurveys(int least, int most)
{
    std::printf("a strip through a flat port in water, lens and window within their priors; poses, points, camera: error/sigma\n");
    printHead("    views^x");
    double seconds = 0;
    int before = 0;
    for (int views : { 20, 60, 100, 300, 1000, 3000, 6000 })
        if (views >= least && views <= most)
        {
            seconds = run(views, 0, seconds, before);
            before = views;
        }
    printHead("    wrong, %  good lost wrong kept");
    for (int views : { 20, 100, 300, 1000 })
        if (views >= least && views <= most)
            run(views, 0.1, 0, 0);
}

} // namespace bench
