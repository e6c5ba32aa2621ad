// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "pose/relative_pose.hpp"
#include "math/least_squares.hpp"
#include "math/rotation.hpp"
#include "points/epipolar_distance.hpp"

namespace cv { namespace refract {

namespace {

typedef Vec<double, 5> Vec5d;                   // three of a rotation, two of the baseline's direction

Matx<double, 3, 2> tangents(const Vec3d& u)
{
    const Vec3d a = normalize(u.cross(std::abs(u[0]) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0))), b = u.cross(a);
    return Matx<double, 3, 2>(a[0], b[0], a[1], b[1], a[2], b[2]);
}

//! The pose moved by five parameters, and how the baseline moves by the last two.
RelativePose moved(const RelativePose& pose, const Vec5d& five, Matx<double, 3, 2>& byDirection)
{
    const Matx<double, 3, 2> across = tangents(pose.baseline);
    const Vec3d sum = pose.baseline + across*Vec2d(five[3], five[4]), u = normalize(sum);
    byDirection = (1/norm(sum))*((Matx33d::eye() - u*u.t())*across);
    return { rotationMatrix(rotationVector(pose.R) + Vec3d(five.val)), u, pose.length };
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
Matx<double, 6, 5> motion(const MatchedCameras& pair, const RelativePose& pose, const Matx<double, 3, 2>& byDirection)
{
    Vec3d offset;
    double q;
    parts(pair, pose, offset, q);
    const Vec3d u = pose.baseline, T = offset + q*u;
    const Matx33d keepsLength = Matx33d::eye() - (1/T.dot(u))*(u*T.t());
    const Matx33d turned = Rotation(rotationVector(pose.R).val).derivativeOf(pair.centre1);
    const Matx33d byRotation = -1*(keepsLength*turned);
    const Matx<double, 3, 2> byBaseline = q*(keepsLength*byDirection);
    Matx<double, 6, 5> both = Matx<double, 6, 5>::eye();
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 5; c++)
            both(3 + r, c) = c < 3 ? byRotation(r, c) : byBaseline(r, c - 3);
    return both;
}

//! Errors of all matches at one length, without the gradient's own change, which is of second order in the noise.
struct ErrorsAtLength
{
    const MatchedCameras& pair;
    const PixelMatches& matches;
    const RelativePose& start;

    //! False where a match has no distance.
    bool operator()(const Vec5d& five, SumOfSquares<5>& sum) const
    {
        Matx<double, 3, 2> byDirection;
        const RelativePose pose = moved(start, five, byDirection);
        Vec3d T;
        if (matches.size() == 0 || !translation(pair, pose, T))
            return false;
        std::vector<double> errors;
        std::vector<Matx16d> byPose;
        sampsonErrors(pair, matches, pose.R, T, errors, &byPose);
        const Matx<double, 6, 5> byFive = motion(pair, pose, byDirection);
        for (size_t i = 0; i < errors.size(); i++)
        {
            if (std::isnan(errors[i]))
                return false;
            sum.add(errors[i], (byPose[i]*byFive).val);
        }
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

Matx<double, 6, 5> motionAtLength(const MatchedCameras& pair, const RelativePose& pose)
{
    return motion(pair, pose, tangents(pose.baseline));
}

void sampsonErrors(const MatchedCameras& pair, const PixelMatches& matches, const Matx33d& R, const Vec3d& T,
                   std::vector<double>& errors, std::vector<Matx16d>* byPose)
{
    const EpipolarDistance distance(pair.camera1, pair.camera2, R, T, 1, DepthRange{ 0, DBL_MAX });
    const int count = (int)matches.size();
    errors.resize(count);
    if (byPose)
        byPose->resize(count);
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
                (*byPose)[begin + i](c) = J(4 + c)/gradient;
        }
    });
}

double refineAtLength(const MatchedCameras& pair, const PixelMatches& matches, RelativePose& pose, int iterations)
{
    const RelativePose start = pose;
    const LeastSquaresEnd end = { iterations, 1e-7, 1e-12 };        // square pixels
    Vec5d five;
    const double sum = minimizeSquares(ErrorsAtLength{ pair, matches, start }, end, five);
    Matx<double, 3, 2> byDirection;
    if (!std::isnan(sum))
        pose = moved(start, five, byDirection);
    return sum;
}

}} // namespace
