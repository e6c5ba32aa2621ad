// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Pose of a target seen through lens and window.

Start: every pixel's ray has its own origin tau*normal; about the mean origin the rays are nearly central, so the pose is
found by cv::solvePnP on the rays' directions, in a frame that looks along their mean (wide lenses see beyond 90 degrees),
and moved by the mean origin. A planar target has two such poses (IPPE gives both); the likelihood decides. */

#include "poses.hpp"
#include "arrays.hpp"
#include "residual.hpp"
#include "rotation.hpp"
#include <ceres/problem.h>
#include <ceres/solver.h>

namespace cv { namespace refract {

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();

//! Rank of the points' scatter: 0 one place, 1 a line, 2 a plane, 3 space.
int scatterRank(const std::vector<Point3d>& points)
{
    Vec3d mean;
    for (const Point3d& p : points)
        mean += Vec3d(p)/(double)points.size();
    Matx33d scatter = Matx33d::zeros();
    for (const Point3d& p : points)
        scatter += (Vec3d(p) - mean)*(Vec3d(p) - mean).t();
    Vec3d values;
    eigen(scatter, values);
    int rank = 0;
    for (int i = 0; i < 3; i++)
        rank += values[i] > 1e-12*values[0];    // squares: flat to one in a million
    return rank;
}

//! Rotation that turns the unit vector a to the z axis.
Matx33d turnToZ(const Vec3d& a)
{
    const Vec3d axis = a.cross(Vec3d(0, 0, 1));
    const double sine = norm(axis);
    return sine > 0 ? rotationMatrix(axis*(std::atan2(sine, a[2])/sine)) : Matx33d::eye();
}

Pose makePose(const Matx33d& R, const Vec3d& t)
{
    Pose pose;
    pose.rvec = rotationVector(R);
    pose.tvec = t;
    pose.found = true;
    return pose;
}

//! The rays of the points that have one.
void raysOf(const Camera& camera, const ImagePoints& points, std::vector<Point3d>& object,
            std::vector<Vec3d>& directions, double& meanTau)
{
    meanTau = 0;
    for (size_t i = 0; i < points.pixel.size(); i++)
    {
        const Point2d& pixel = points.pixel[i];
        double tau;
        Vec3d d;
        uchar status = REFRACT_OK;
        camera.unproject(1, &pixel.x, &pixel.y, &tau, &d[0], &d[1], &d[2], &status);
        if (status != REFRACT_OK)
            continue;
        object.push_back(points.object[i]);
        directions.push_back(d);
        meanTau += (tau - meanTau)/(double)object.size();
    }
}

std::vector<Pose> closedFormPoses(const Camera& camera, const ImagePoints& points)
{
    std::vector<Point3d> withRay;
    std::vector<Vec3d> directions;
    double meanTau;
    raysOf(camera, points, withRay, directions, meanTau);
    Vec3d look;
    for (const Vec3d& d : directions)
        look += d;
    if (!(norm(look) > 0))
        return std::vector<Pose>();
    const Matx33d turn = turnToZ(look/norm(look));
    const Vec3d origin = camera.layers().normal()*meanTau;

    std::vector<Point3d> object;
    std::vector<Point2d> normalized;
    for (size_t i = 0; i < directions.size(); i++)
    {
        const Vec3d d = turn*directions[i];
        if (!(d[2] > 0.05))     // normalised coordinates end before 90 degrees
            continue;
        object.push_back(withRay[i]);
        normalized.push_back(Point2d(d[0]/d[2], d[1]/d[2]));
    }
    std::vector<Pose> poses;
    const int rank = object.size() < 4 ? 0 : scatterRank(object);
    if (rank < 2)
        return poses;
    std::vector<Mat> rvecs, tvecs;
    solvePnPGeneric(object, normalized, Matx33d::eye(), noArray(), rvecs, tvecs, false,
                    rank == 2 ? SOLVEPNP_IPPE : SOLVEPNP_SQPNP);
    for (size_t i = 0; i < rvecs.size(); i++)
    {
        if (checkRange(rvecs[i]) && checkRange(tvecs[i]))
            poses.push_back(makePose(turn.t()*rotationMatrix(Vec3d(rvecs[i].ptr<double>())),
                                     turn.t()*Vec3d(tvecs[i].ptr<double>()) + origin));
    }
    return poses;
}

//! Maximum likelihood from a start; the RMS, NaN if it failed.
double refinePose(const Camera& camera, const ImagePoints& points, Pose& pose)
{
    std::vector<double> parameters = camera.parameters();
    double* lens = parameters.data();
    double* normal = lens + camera.lensCount();
    double values[6];
    std::copy(pose.rvec.val, pose.rvec.val + 3, values);
    std::copy(pose.tvec.val, pose.tvec.val + 3, values + 3);

    ceres::Problem problem;
    problem.AddResidualBlock(ImageResidual::Create(camera, points, false, ImageResidual::OWN), nullptr,
                             std::vector<double*>{ values, lens, normal, normal + 3 });
    for (double* block : { lens, normal, normal + 3 })
        problem.SetParameterBlockConstant(block);

    // A start that gives some point no image is none. Ceres would log an error whatever its logging_type says.
    double cost;
    if (!problem.Evaluate(ceres::Problem::EvaluateOptions(), &cost, nullptr, nullptr, nullptr))
        return NaN;
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 100;
    options.function_tolerance = 1e-14;
    options.parameter_tolerance = 1e-14;
    options.gradient_tolerance = 1e-14;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable())
        return NaN;
    pose.rvec = Vec3d(values);
    pose.tvec = Vec3d(values + 3);
    return std::sqrt(2*summary.final_cost/(double)points.pixel.size());
}

} // namespace

Pose solvePose(const Camera& camera, const std::vector<Point3d>& objectPoints, const std::vector<Point2d>& imagePoints,
               const Pose& start, double& rms)
{
    const ImagePoints points = observed(objectPoints, imagePoints);
    Pose best;
    rms = NaN;
    if (points.pixel.size() < 3 || scatterRank(points.object) < 2)
        return best;
    std::vector<Pose> candidates(1, start);
    if (!start.found)
        candidates = closedFormPoses(camera, points);
    for (Pose& candidate : candidates)
    {
        const double candidateRms = refinePose(camera, points, candidate);
        if (std::isnan(candidateRms) || (best.found && candidateRms >= rms))
            continue;
        best = candidate;
        rms = candidateRms;
    }
    return best;
}

static double solvePnP(InputArray objectPoints_, InputArray imagePoints_, const Camera& camera,
                       InputOutputArray rvec, InputOutputArray tvec, bool useExtrinsicGuess)
{
    const std::vector<Point3d> objectPoints = readPoints3(objectPoints_, "objectPoints");
    const std::vector<Point2d> imagePoints = readPoints2(imagePoints_, "imagePoints");
    const size_t least = useExtrinsicGuess ? 3 : 4;
    if (objectPoints.size() != imagePoints.size())
        CV_Error_(Error::StsUnmatchedSizes, ("objectPoints has %d points, imagePoints %d; they must agree",
                                             (int)objectPoints.size(), (int)imagePoints.size()));
    if (objectPoints.size() < least)
        CV_Error_(Error::StsBadArg, ("objectPoints has %d points; a pose needs at least %d",
                                     (int)objectPoints.size(), (int)least));
    for (const Point3d& p : objectPoints)
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            CV_Error_(Error::StsBadArg, ("objectPoints holds the point (%g, %g, %g); it must be finite", p.x, p.y, p.z));

    Pose start;
    if (useExtrinsicGuess)
        start = makePose(readRotation(rvec, "rvec"), readVec3(tvec, "tvec"));
    double rms;
    Pose pose = solvePose(camera, objectPoints, imagePoints, start, rms);
    if (!pose.found)
        pose.rvec = pose.tvec = Vec3d::all(NaN);
    Mat(pose.rvec).copyTo(rvec);
    Mat(pose.tvec).copyTo(tvec);
    return rms;
}

double refractiveSolvePnP(InputArray objectPoints, InputArray imagePoints, InputArray cameraMatrix,
                          InputArray distCoeffs, const GlassWindow& window, InputOutputArray rvec,
                          InputOutputArray tvec, bool useExtrinsicGuess)
{
    CV_INSTRUMENT_REGION();

    return refractiveSolvePnP(objectPoints, imagePoints, RefractiveCamera::create(cameraMatrix, distCoeffs, window),
                              rvec, tvec, useExtrinsicGuess);
}

double refractiveSolvePnP(InputArray objectPoints, InputArray imagePoints, const Ptr<RefractiveCamera>& camera,
                          InputOutputArray rvec, InputOutputArray tvec, bool useExtrinsicGuess)
{
    CV_INSTRUMENT_REGION();

    return solvePnP(objectPoints, imagePoints, cameraOf(camera), rvec, tvec, useExtrinsicGuess);
}

}} // namespace
