// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "pose/relative_pose.hpp"
#include "math/rotation.hpp"
#include "points/epipolar_distance.hpp"
#include <ceres/tiny_solver.h>

namespace cv { namespace refract {

namespace {

typedef Eigen::Matrix<double, 5, 1> Five;       // three of a rotation, two of the baseline's direction

Matx<double, 3, 2> tangents(const Vec3d& u)
{
    const Vec3d a = normalize(u.cross(std::abs(u[0]) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0))), b = u.cross(a);
    return Matx<double, 3, 2>(a[0], b[0], a[1], b[1], a[2], b[2]);
}

//! The pose moved by five parameters, and how the baseline moves by the last two.
RelativePose moved(const RelativePose& pose, const double* five, Matx<double, 3, 2>& byDirection)
{
    const Matx<double, 3, 2> across = tangents(pose.baseline);
    const Vec3d sum = pose.baseline + across*Vec2d(five[3], five[4]), u = normalize(sum);
    byDirection = (1/norm(sum))*((Matx33d::eye() - u*u.t())*across);
    return { rotationMatrix(rotationVector(pose.R) + Vec3d(five)), u, pose.length };
}

//! T without the baseline, and q.
bool parts(const MatchedCameras& pair, const RelativePose& pose, Vec3d& offset, double& q)
{
    offset = pair.centre2 - pose.R*pair.centre1;
    const double along = offset.dot(pose.baseline);
    const double square = along*along - offset.dot(offset) + pose.length*pose.length;
    q = std::sqrt(std::max(square, 0.)) - along;
    return square > 0 && q > 0;
}

//! dT = dOffset + dq u + q du, and T dT = 0 says what dq is.
Eigen::Matrix<double, 6, 5> motion(const MatchedCameras& pair, const RelativePose& pose, const Matx<double, 3, 2>& byDirection)
{
    Vec3d offset;
    double q;
    parts(pair, pose, offset, q);
    const Vec3d u = pose.baseline, T = offset + q*u;
    const Matx33d keepsLength = Matx33d::eye() - (1/T.dot(u))*(u*T.t());
    const Matx33d turned = Rotation(rotationVector(pose.R).val).derivativeOf(pair.centre1);
    const Matx33d byRotation = -1*(keepsLength*turned);
    const Matx<double, 3, 2> byBaseline = q*(keepsLength*byDirection);
    Eigen::Matrix<double, 6, 5> both = Eigen::Matrix<double, 6, 5>::Zero();
    both.topLeftCorner<3, 3>().setIdentity();
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 5; c++)
            both(3 + r, c) = c < 3 ? byRotation(r, c) : byBaseline(r, c - 3);
    return both;
}

//! Errors of all matches at one length, for ceres::TinySolver.
struct ErrorsAtLength
{
    typedef double Scalar;
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = 5 };
    const MatchedCameras& pair;
    const PixelMatches& matches;
    const RelativePose& start;

    int NumResiduals() const { return (int)matches.size(); }

    /* The jacobian is column-major, without the gradient's own change, which is of second order in the noise. Where a match has
    no distance the errors are infinite: no step is taken there. */
    bool operator()(const double* five, double* errors, double* jacobian) const
    {
        Matx<double, 3, 2> byDirection;
        const RelativePose pose = moved(start, five, byDirection);
        Vec3d T;
        std::vector<double> found;
        Eigen::MatrixXd byPose;
        if (translation(pair, pose, T))
            sampsonErrors(pair, matches, pose.R, T, found, jacobian ? &byPose : nullptr);
        if (found.empty() || std::any_of(found.begin(), found.end(), [](double e) { return std::isnan(e); }))
        {
            std::fill_n(errors, NumResiduals(), std::numeric_limits<double>::infinity());
            return false;
        }
        std::copy(found.begin(), found.end(), errors);
        if (jacobian)
            Eigen::Map<Eigen::MatrixXd>(jacobian, NumResiduals(), 5) = byPose*motion(pair, pose, byDirection);
        return true;
    }
};

} // namespace

bool translation(const MatchedCameras& pair, const RelativePose& pose, Vec3d& T)
{
    Vec3d offset;
    double q;
    if (!parts(pair, pose, offset, q))
        return false;
    T = offset + q*pose.baseline;
    return true;
}

Eigen::Matrix<double, 6, 5> motionAtLength(const MatchedCameras& pair, const RelativePose& pose)
{
    return motion(pair, pose, tangents(pose.baseline));
}

void sampsonErrors(const MatchedCameras& pair, const PixelMatches& matches, const Matx33d& R, const Vec3d& T,
                   std::vector<double>& errors, Eigen::MatrixXd* byPose)
{
    const EpipolarDistance distance(pair.camera1, pair.camera2, R, T, 1, DepthRange{ 0, DBL_MAX });
    const int count = (int)matches.size();
    errors.resize(count);
    if (byPose)
        byPose->resize(count, 6);
    forEachBlock(count, [&](int begin, int n)
    {
        Matches block;
        for (int i = 0; i < n; i++)
        {
            const Point2d &p1 = matches.pixel1[begin + i], &p2 = matches.pixel2[begin + i];
            block.ofCurve[i] = p1.x; block.ofCurve[BLOCK + i] = p1.y;
            block.other[i] = p2.x; block.other[BLOCK + i] = p2.y;
            block.status[i] = REFRACT_OK;
        }
        distance.evaluate(block, n, true);
        for (int i = 0; i < n; i++)
        {
            const auto J = [&](int c) { return block.jacobian[c*BLOCK + i]; };
            const double gradient = std::sqrt(J(0)*J(0) + J(1)*J(1) + J(2)*J(2) + J(3)*J(3));
            const bool ok = block.status[i] == REFRACT_OK && gradient > 0;
            errors[begin + i] = ok ? block.distance[i]/gradient : std::numeric_limits<double>::quiet_NaN();
            for (int c = 0; c < 6 && byPose; c++)
                (*byPose)(begin + i, c) = J(4 + c)/gradient;
        }
    });
}

double refineAtLength(const MatchedCameras& pair, const PixelMatches& matches, RelativePose& pose, int iterations)
{
    const double NaN = std::numeric_limits<double>::quiet_NaN();
    const RelativePose start = pose;
    const ErrorsAtLength errors = { pair, matches, start };
    Five five = Five::Zero();
    std::vector<double> atStart(matches.size());
    if (!errors(five.data(), atStart.data(), nullptr))
        return NaN;
    ceres::TinySolver<ErrorsAtLength> solver;
    solver.options.max_num_iterations = iterations;
    solver.options.function_tolerance = 1e-7;       // square pixels
    solver.options.parameter_tolerance = 1e-12;
    solver.options.gradient_tolerance = solver.options.cost_threshold = 0;
    const double cost = solver.Solve(errors, &five).final_cost;
    if (!five.allFinite() || !std::isfinite(cost))
        return NaN;
    Matx<double, 3, 2> byDirection;
    pose = moved(start, five.data(), byDirection);
    return 2*cost;
}

}} // namespace
