// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A rig sealed behind its windows: lens, R, T and normals from glass-only views, judged by lengths that it measures, beside
// the pinhole cameras that the same views give. The long form is hidden: run with [.monte-carlo].
#include "cramer_rao.hpp"
#include "rig_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const double SIGMA = 0.1, LENGTH = 39;
const Size IMAGE(1280, 1024);

//! What measures a point: two cameras with or without windows.
struct Measurer
{
    std::vector<Ptr<RefractiveCamera> > cameras;
    Matx33d R;
    Vec3d T;

    std::vector<Point3d> measure(const std::vector<Point2d>& left, const std::vector<Point2d>& right) const
    {
        std::vector<Point3d> points;
        std::vector<uchar> status;
        triangulateRefractive(cameras[0], cameras[1], R, T, left, right, points, status);
        CHECK(countNonZero(status) == 0);
        return points;
    }
};

//! Both ends of segments of known length, as both cameras see them: without noise, so that only the calibration's shows.
struct Segments
{
    std::vector<Point2d> left, right;

    std::vector<double> errors(const Measurer& measurer) const
    {
        const std::vector<Point3d> points = measurer.measure(left, right);
        std::vector<double> errors;
        for (size_t i = 0; i < points.size(); i += 2)
            errors.push_back(norm(points[i] - points[i + 1]) - LENGTH);
        return errors;
    }
};

//! Neighbouring corners of fresh boards, where both cameras see them.
Segments makeSegments(const RigTruth& truth, double near, double far, int boards, Random& random)
{
    const int COLUMNS = 6, ROWS = 5;
    const RigScene scene = makeRigScene(truth, ObjectViews(boards, board(COLUMNS, ROWS, LENGTH)), random, 0, near, far);
    const Rect_<double> image(0, 0, IMAGE.width, IMAGE.height);
    Segments segments;
    for (int view = 0; view < boards; view++)
        for (int i = 0; i < COLUMNS*ROWS; i++)
            for (int next : { i % COLUMNS + 1 < COLUMNS ? i + 1 : -1, i + COLUMNS < COLUMNS*ROWS ? i + COLUMNS : -1 })
            {
                const std::vector<Point2d>& left = scene.refracted[0][view];
                const std::vector<Point2d>& right = scene.refracted[1][view];
                if (next < 0 || !image.contains(left[i]) || !image.contains(left[next]) || !image.contains(right[i]) ||
                    !image.contains(right[next]))
                    continue;
                segments.left.insert(segments.left.end(), { left[i], left[next] });
                segments.right.insert(segments.right.end(), { right[i], right[next] });
            }
    REQUIRE(!segments.left.empty());
    return segments;
}

//! What a user would do instead: cv::calibrateCamera and cv::stereoCalibrate through the glass.
Measurer pinholeRig(const RigScene& scene)
{
    const std::vector<std::vector<Point3f> > object = as<Point3f>(scene.object);
    std::vector<std::vector<Point2f> > images[2];
    Mat K[2], D[2];
    const TermCriteria criteria(TermCriteria::COUNT | TermCriteria::EPS, 50, 1e-9);
    for (int c = 0; c < 2; c++)
    {
        images[c] = as<Point2f>(scene.refracted[c]);
        std::vector<Mat> rvecs, tvecs;
        calibrateCamera(object, images[c], IMAGE, K[c], D[c], rvecs, tvecs, 0, criteria);
    }
    Measurer rig;
    Mat R, T, E, F;
    stereoCalibrate(object, images[0], images[1], K[0], D[0], K[1], D[1], IMAGE, R, T, E, F, CALIB_USE_INTRINSIC_GUESS,
                    criteria);
    rig.R = R;
    rig.T = Vec3d(T.ptr<double>());
    for (int c = 0; c < 2; c++)
        rig.cameras.push_back(RefractiveCamera::create(K[c], D[c]));
    return rig;
}

//! Lens, R, T and normals from the glass views alone, from a data sheet's lens and windows that look straight ahead.
Measurer sealedRig(const RigTruth& truth, const RigScene& scene, Mat& covariance)
{
    RigCall call(truth, scene, false);
    call.cameras[0]->setLensParameters(std::vector<double>{ 2430, 2430, 640, 505, -0.4, 0.4, 0, 0 });
    call.cameras[1]->setLensParameters(std::vector<double>{ 2450, 2450, 650, 480, -0.4, 0.4, 0, 0 });
    call.Ts[1] += Mat(Vec3d(2, -1, 1));
    call.run(GLASS_FREE_INTRINSICS | GLASS_FIX_TANGENT_DIST | GLASS_FREE_EXTRINSICS);
    covariance = call.covariance;
    Measurer rig = { call.cameras, call.Rs[1], Vec3d(call.Ts[1]) };
    return rig;
}

Ptr<RefractiveCamera> moved(const Ptr<RefractiveCamera>& camera, const Mat& step)
{
    const int lens = (int)camera->lensParameters().total();
    GlassWindow window = camera->window();
    window.normal = normalize(window.normal + Vec3d(step.ptr<double>(lens)));
    Ptr<RefractiveCamera> other = RefractiveCamera::create(camera->cameraMatrix(), camera->distCoeffs(), window);
    other->setLensParameters(camera->lensParameters() + step.rowRange(0, lens));
    return other;
}

/** Stated standard deviations of the lengths: from the calibration's covariance, carried to both ends at once by differences
along its principal axes. */
std::vector<double> statedSigmas(const Measurer& rig, const Mat& covariance, const Segments& segments)
{
    const std::vector<double> here = segments.errors(rig);
    std::vector<double> variances(here.size(), 0.);
    // In units of each parameter's standard deviation, where the axes are well defined.
    Mat scale = covariance.diag().clone(), values, vectors;
    sqrt(max(scale, 0), scale);
    Mat invScale(scale.size(), CV_64F);
    for (int i = 0; i < scale.rows; i++)
        invScale.at<double>(i) = scale.at<double>(i) > 0 ? 1/scale.at<double>(i) : 0;
    eigen(covariance.mul(invScale*invScale.t()), values, vectors);
    const int P = (covariance.rows - 6)/2;
    const double SMALL = 0.01;          // of a standard deviation
    for (int k = 0; k < values.rows && values.at<double>(k) > 1e-9*values.at<double>(0); k++)
    {
        const Mat axis = vectors.row(k).t(), step = SMALL*std::sqrt(values.at<double>(k))*axis.mul(scale);
        Measurer other;
        other.cameras = { moved(rig.cameras[0], step.rowRange(0, P)), moved(rig.cameras[1], step.rowRange(P, 2*P)) };
        Vec3d rvec;
        Rodrigues(rig.R, rvec);
        Rodrigues(rvec + Vec3d(step.ptr<double>(2*P)), other.R);
        other.T = rig.T + Vec3d(step.ptr<double>(2*P + 3));
        const std::vector<double> there = segments.errors(other);
        for (size_t i = 0; i < here.size(); i++)
            variances[i] += std::pow((there[i] - here[i])/SMALL, 2);
    }
    for (double& v : variances)
        v = std::sqrt(v);
    return variances;
}

double rootMeanSquare(const std::vector<double>& values)
{
    double sum = 0;
    for (double v : values)
        sum += v*v/values.size();
    return std::sqrt(sum);
}

double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    const size_t n = values.size();
    return 0.5*(values[n/2] + values[(n - 1)/2]);
}

//! What one range tells over all rigs: RMS length errors of ours and of the pinhole rig, and ours over the stated ones.
struct Ranging
{
    const char* name;
    double near, far;
    std::vector<double> ours, pinhole, ratio;
    double stated = 0, actual = 0;

    void add(const RigTruth& truth, const Measurer& sealed, const Mat& covariance, const Measurer& simple, int boards,
             Random& random)
    {
        const Segments segments = makeSegments(truth, near, far, boards, random);
        const std::vector<double> errors = segments.errors(sealed), sigmas = statedSigmas(sealed, covariance, segments);
        ours.push_back(rootMeanSquare(errors));
        pinhole.push_back(rootMeanSquare(segments.errors(simple)));
        ratio.push_back(pinhole.back()/ours.back());
        for (size_t i = 0; i < errors.size(); i++)
        {
            actual += errors[i]*errors[i]/(sigmas[i]*sigmas[i]*errors.size());
            stated += sigmas[i]*sigmas[i]/errors.size();
        }
    }
    //! RMS of error over stated standard deviation: 1 if the statement is true.
    double honesty() const { return std::sqrt(actual/ours.size()); }
    void print() const
    {
        std::cout << "[numbers] sealed stereo rig, " << ours.size() << " rigs, lengths " << name << ": RMS "
                  << rootMeanSquare(ours) << " mm (median rig " << median(ours) << "), pinhole through the glass "
                  << rootMeanSquare(pinhole) << " (" << median(pinhole) << "), ratio in the median " << median(ratio)
                  << "; stated " << std::sqrt(stated/ours.size()) << " mm, error over stated " << honesty() << std::endl;
    }
};

std::vector<Ranging> measureSealedRigs(int rigs, int boards)
{
    std::vector<Ranging> ranges = { { "inside (520-720 mm)", 520, 720, {}, {}, {} }, { "at 300 mm", 295, 305, {}, {}, {} },
                                  { "at 1250 mm", 1230, 1270, {}, {}, {} } };
    const RigTruth truth = paperStereo();
    for (int rig = 0; rig < rigs; rig++)
    {
        Random random(9000 + rig);
        const RigScene scene = makeRigScene(truth, ObjectViews(25, board()), random, SIGMA, 520, 720);
        Mat covariance;
        const Measurer sealed = sealedRig(truth, scene, covariance), simple = pinholeRig(scene);
        for (Ranging& range : ranges)
            range.add(truth, sealed, covariance, simple, boards, random);
    }
    return ranges;
}

} // namespace

TEST_CASE("Lengths by 20 sealed stereo rigs", "[.monte-carlo]")
{
    std::vector<Ranging> ranges = measureSealedRigs(20, 10);
    for (const Ranging& range : ranges)
        range.print();
    CHECK(median(ranges[0].ours) < 0.0085);
    CHECK(median(ranges[0].ratio) > 5);
    CHECK(median(ranges[1].ratio) > 3);
    CHECK(median(ranges[2].ratio) > 3);
    for (const Ranging& range : ranges)
        CHECK(range.honesty() == Approx(1).margin(0.25));       // 20 rigs: errors of one rig are alike
}

TEST_CASE("Lengths by two sealed stereo rigs", "[stereo_glass][slow]")
{
    CAPTURE(seed());
    const std::vector<Ranging> ranges = measureSealedRigs(2, 3);
    for (const Ranging& range : ranges)
    {
        CAPTURE(range.name);
        CHECK(median(range.ratio) > 1.5);
        CHECK(range.honesty() < 2.5);
    }
}
