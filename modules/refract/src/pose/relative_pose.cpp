// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "pose/relative_pose.hpp"
#include "math/least_squares.hpp"
#include "math/rotation.hpp"
#include "points/epipolar_distance.hpp"

namespace cv { namespace refract {

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();

//! A pixel's ray, as its numbers: tau, direction, offset; and s at the last surface.
struct RayNumbers
{
    Vec4d ray = Vec4d::all(NaN);
    Vec3d offset;
    double surface = NaN;
};

//! Rays of all pixels, moved by a step.
std::vector<RayNumbers> raysAt(const Camera& camera, const std::vector<Point2d>& pixels, const Point2d& step)
{
    std::vector<RayNumbers> rays(pixels.size());
    forEachBlock((int)pixels.size(), [&](int begin, int n)
    {
        Rays block;
        double u[BLOCK] = {}, v[BLOCK] = {};
        uchar status[BLOCK];
        for (int i = 0; i < n; i++)
        {
            u[i] = pixels[begin + i].x + step.x;
            v[i] = pixels[begin + i].y + step.y;
            status[i] = REFRACT_OK;
        }
        camera.unproject(n, u, v, block, status);
        for (int i = 0; i < n; i++)
            if (status[i] == REFRACT_OK)
            {
                RayNumbers& ray = rays[begin + i];
                ray.ray = Vec4d(block.tau[i], block.dx[i], block.dy[i], block.dz[i]);
                ray.offset = block.offsetOf(i);
                ray.surface = 1/camera.layers().leavingMu(block, i);
            }
    });
    return rays;
}

Vec3d directionOf(const Vec4d& ray) { return Vec3d(ray[1], ray[2], ray[3]); }

//! What all matches share at a pose.
struct PoseTerms
{
    PoseTerms(const MatchedCameras& pair, const RigidTransform& pose)
        : R(pose.R), t(pose.t), normal1(pose.R*pair.camera1.layers().normal()), normal2(pair.camera2.layers().normal()),
          hasOffsets(pair.camera1.layers().hasOffsets() || pair.camera2.layers().hasOffsets())
    {
        const Vec3d rvec = rotationVector(pose.R);
        const Rotation rotation(rvec.val);
        for (int k = 0; k < 3; k++)
        {
            const Matx33d turn = rotation.dR[k]*pose.R.t();        // of the angular velocity's cross product
            const double axis[3] = { turn(2, 1), turn(0, 2), turn(1, 0) };
            for (int r = 0; r < 3; r++)
                turnByRvec(r, k) = axis[r];
        }
    }
    Matx33d R;
    Vec3d t, normal1, normal2;      //!< in camera 2
    bool hasOffsets;                //!< of rays
    Matx33d turnByRvec;             //!< columns: angular velocities
};

/** The error of one match.
@param byPose may be null
@param inFront whether the rays come nearest to each other beyond both windows */
double sampsonError(const Match& m, const PoseTerms& pose, double* byPose, bool& inFront)
{
    const Vec3d a = pose.R*m.ray1.direction;
    Vec3d origin = m.ray1.tau*pose.normal1, origin2 = m.ray2.tau*pose.normal2;
    if (pose.hasOffsets)
    {
        origin += pose.R*m.ray1.offset;
        origin2 += m.ray2.offset;
    }
    const Vec3d w = origin2 - origin - pose.t;
    const Vec3d &d2 = m.ray2.direction, c = a.cross(d2), byA = d2.cross(w), byD2 = w.cross(a);
    const Vec3d byD1 = pose.R.t()*byA;
    const double by1 = -pose.normal1.dot(c), by2 = pose.normal2.dot(c);
    double g[4] = { byD1.dot(m.ray1.directionByU) + by1*m.ray1.tauByPixel[0],
                          byD1.dot(m.ray1.directionByV) + by1*m.ray1.tauByPixel[1],
                          byD2.dot(m.ray2.directionByU) + by2*m.ray2.tauByPixel[0],
                          byD2.dot(m.ray2.directionByV) + by2*m.ray2.tauByPixel[1] };
    if (pose.hasOffsets)
    {
        const Vec3d byOrigin1 = pose.R.t()*c;
        g[0] -= byOrigin1.dot(m.ray1.offsetByU);
        g[1] -= byOrigin1.dot(m.ray1.offsetByV);
        g[2] += c.dot(m.ray2.offsetByU);
        g[3] += c.dot(m.ray2.offsetByV);
    }
    const double scale = 1/std::sqrt(g[0]*g[0] + g[1]*g[1] + g[2]*g[2] + g[3]*g[3]), c2 = c.dot(c);
    inFront = -byA.dot(c) > m.ray1.surface*c2 && byD2.dot(c) > m.ray2.surface*c2;
    const double error = w.dot(c)*scale;
    if (!byPose)
        return error;
    // The derivatives of g, and of half the squared length of its gradient.
    const Vec3d moved1 = pose.R*(g[0]*m.ray1.directionByU + g[1]*m.ray1.directionByV);
    const Vec3d moved2 = g[2]*m.ray2.directionByU + g[3]*m.ray2.directionByV;
    const double tau1 = g[0]*m.ray1.tauByPixel[0] + g[1]*m.ray1.tauByPixel[1];
    const double tau2 = g[2]*m.ray2.tauByPixel[0] + g[3]*m.ray2.tauByPixel[1];
    const Vec3d lengthByW = moved1.cross(d2) + a.cross(moved2);
    Vec3d lengthByTurn = moved1.cross(byA) - origin.cross(lengthByW) + a.cross(moved2.cross(w) + tau2*d2.cross(pose.normal2))
                         - tau1*pose.normal1.cross(a).cross(d2);
    if (pose.hasOffsets)
    {
        const Vec3d moved = pose.R*(g[0]*m.ray1.offsetByU + g[1]*m.ray1.offsetByV);
        lengthByTurn += a.cross(d2.cross(g[2]*m.ray2.offsetByU + g[3]*m.ray2.offsetByV)) - moved.cross(a).cross(d2);
    }
    const double ratio = error*scale;
    const Vec3d byTurn = (a.cross(byA) - origin.cross(c) - ratio*lengthByTurn)*scale, byT = (ratio*lengthByW - c)*scale;
    const Vec3d byRvec = pose.turnByRvec.t()*byTurn;
    for (int k = 0; k < 3; k++)
    {
        byPose[k] = byRvec[k];
        byPose[3 + k] = byT[k];
    }
    return error;
}

/* Rays that do not meet in front agree best at an end of the curve, infinitely far or at a window: the distance from there, also
over the length of its gradient. */
void errorsAtEnds(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& pose, const std::vector<int>& which,
                  std::vector<double>& errors, std::vector<Matx16d>* byPose)
{
    const EpipolarDistance distance(pair.camera1, pair.camera2, pose.R, pose.t, 1, DepthRange{ 0, DBL_MAX });
    forEachBlock((int)which.size(), [&](int begin, int n)
    {
        Matches block;
        for (int i = 0; i < n; i++)
        {
            const Match& m = matches[which[begin + i]];
            block.ofCurve[i] = m.pixel1.x; block.ofCurve[BLOCK + i] = m.pixel1.y;
            block.other[i] = m.pixel2.x; block.other[BLOCK + i] = m.pixel2.y;
            block.status[i] = REFRACT_OK;
        }
        distance.evaluate(block, n, true);
        for (int i = 0; i < n; i++)
        {
            const auto J = [&](int c) { return block.jacobian[c*BLOCK + i]; };
            const double gradient = std::sqrt(J(0)*J(0) + J(1)*J(1) + J(2)*J(2) + J(3)*J(3));
            const bool ok = block.status[i] == REFRACT_OK && gradient > 0;
            errors[which[begin + i]] = ok ? block.distance[i]/gradient : NaN;
            for (int c = 0; c < 6 && byPose; c++)
                (*byPose)[which[begin + i]](c) = J(4 + c)/gradient;
        }
    });
}

//! The most likely pose of those that N parameters reach.
template<int N, typename Move>
double minimizeErrors(const MatchedCameras& pair, const PixelMatches& matches, RigidTransform& pose, int iterations, const Move& move)
{
    const LeastSquaresEnd end = { iterations, 1e-7, 1e-12 };        // square pixels
    std::vector<double> errors;
    std::vector<Matx16d> byPose;
    const auto evaluate = [&](const Vec<double, N>& x, SumOfSquares<N>& sum)
    {
        Matx<double, 6, N> motion;
        sampsonErrors(pair, matches, move(x, motion), errors, &byPose);
        for (size_t i = 0; i < errors.size(); i++)
        {
            if (std::isnan(errors[i]))
                return false;
            sum.add(errors[i], (byPose[i]*motion).val);
        }
        return !errors.empty();
    };
    Vec<double, N> x;
    const double sum = minimizeSquares(evaluate, end, x);
    if (std::isnan(sum))
        return std::numeric_limits<double>::infinity();
    Matx<double, 6, N> motion;
    pose = move(x, motion);
    return sum;
}

} // namespace

std::vector<PixelRay> pixelRays(const Camera& camera, const std::vector<Point2d>& pixels)
{
    const double STEP = 1e-2;           // pixels: a central difference is good to eight digits
    const std::vector<RayNumbers> at = raysAt(camera, pixels, Point2d());
    const std::vector<RayNumbers> right = raysAt(camera, pixels, Point2d(STEP, 0)), left = raysAt(camera, pixels, Point2d(-STEP, 0));
    const std::vector<RayNumbers> below = raysAt(camera, pixels, Point2d(0, STEP)), above = raysAt(camera, pixels, Point2d(0, -STEP));
    std::vector<PixelRay> rays(pixels.size());
    for (size_t i = 0; i < pixels.size(); i++)
    {
        const Vec4d byU = (right[i].ray - left[i].ray)*(0.5/STEP), byV = (below[i].ray - above[i].ray)*(0.5/STEP);
        rays[i] = { at[i].ray[0], directionOf(at[i].ray), Vec2d(byU[0], byV[0]), directionOf(byU), directionOf(byV), at[i].surface,
                    at[i].offset, (right[i].offset - left[i].offset)*(0.5/STEP), (below[i].offset - above[i].offset)*(0.5/STEP) };
    }
    return rays;
}

PixelMatches matchesOf(const Camera& camera1, const Camera& camera2, const MatchedPixels& pixels)
{
    const std::vector<PixelRay> rays1 = pixelRays(camera1, pixels.first), rays2 = pixelRays(camera2, pixels.second);
    PixelMatches matches;
    for (size_t i = 0; i < pixels.first.size(); i++)
        matches.push_back({ pixels.first[i], pixels.second[i], rays1[i], rays2[i] });
    return matches;
}

PixelMatches select(const PixelMatches& matches, const std::vector<int>& which)
{
    PixelMatches some;
    some.reserve(which.size());
    for (int i : which)
        some.push_back(matches[i]);
    return some;
}

double MatchedCameras::depth() const
{
    return std::max(camera1.layers().stack().total, camera2.layers().stack().total) + norm(centre1) + norm(centre2);
}

bool setLength(const MatchedCameras& pair, double length, RigidTransform& pose)
{
    const Vec3d offset = pair.centre2 - pose.R*pair.centre1, between = pose.t - offset;
    const double now = norm(between), along = offset.dot(between)/now;
    const double square = along*along - offset.dot(offset) + length*length, root = std::sqrt(std::max(square, 0.));
    // Two q may give a short T.
    const double q = std::abs(now + along - root) <= std::abs(now + along + root) ? root - along : -root - along;
    const bool isReached = square > 0 && q > 0;
    pose.t = isReached ? offset + between*(q/now) : pose.t*(length/norm(pose.t));
    return isReached;
}

Matx<double, 6, 5> motionAtLength(const RigidTransform& pose)
{
    const Matx<double, 3, 2> across = norm(pose.t)*tangents(normalize(pose.t));
    Matx<double, 6, 5> motion = Matx<double, 6, 5>::eye();
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 2; c++)
            motion(3 + r, 3 + c) = across(r, c);
    return motion;
}

void sampsonErrors(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& pose,
                   std::vector<double>& errors, std::vector<Matx16d>* byPose, double limit)
{
    const PoseTerms terms(pair, pose);
    std::vector<uchar> atEnd(matches.size());
    errors.resize(matches.size());
    if (byPose)
        byPose->resize(matches.size());
    forEachBlock((int)matches.size(), [&](int begin, int n)
    {
        for (int i = begin; i < begin + n; i++)
        {
            bool inFront;
            errors[i] = sampsonError(matches[i], terms, byPose ? (*byPose)[i].val : nullptr, inFront);
            atEnd[i] = !inFront && std::abs(errors[i]) <= limit;
        }
    });
    std::vector<int> which;
    for (size_t i = 0; i < matches.size(); i++)
        if (atEnd[i])
            which.push_back((int)i);
    errorsAtEnds(pair, matches, pose, which, errors, byPose);
}

double refine(const MatchedCameras& pair, const PixelMatches& matches, RigidTransform& pose, int iterations)
{
    const RigidTransform start = pose;
    return minimizeErrors<6>(pair, matches, pose, iterations, [&](const Vec6d& six, Matx66d& motion)
    {
        motion = Matx66d::eye();
        return RigidTransform{ rotationMatrix(rotationVector(start.R) + Vec3d(six.val)), start.t + Vec3d(six.val + 3) };
    });
}

double refineAtLength(const MatchedCameras& pair, const PixelMatches& matches, RigidTransform& pose, int iterations)
{
    const RigidTransform start = pose;
    const double length = norm(start.t);
    const Vec3d direction = normalize(start.t);
    const Matx<double, 3, 2> across = tangents(direction);
    return minimizeErrors<5>(pair, matches, pose, iterations, [&](const Vec<double, 5>& five, Matx<double, 6, 5>& motion)
    {
        const Vec3d sum = direction + across*Vec2d(five[3], five[4]), u = normalize(sum);
        const Matx<double, 3, 2> byDirection = (length/norm(sum))*((Matx33d::eye() - u*u.t())*across);
        motion = Matx<double, 6, 5>::eye();
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 2; c++)
                motion(3 + r, 3 + c) = byDirection(r, c);
        return RigidTransform{ rotationMatrix(rotationVector(start.R) + Vec3d(five.val)), length*u };
    });
}

double refineRotation(const PixelMatches& matches, Matx33d& R, int iterations)
{
    const LeastSquaresEnd end = { iterations, 1e-7, 1e-12 };        // square pixels
    const auto evaluate = [&](const Vec3d& turn, SumOfSquares<3>& sum)
    {
        const Rotation rotation(turn.val);
        for (const Match& m : matches)
        {
            const Matx33d turned = rotation.R*R;
            const Matx<double, 2, 3> across = tangents(m.ray2.direction).t();
            const Vec2d off = across*(turned*m.ray1.direction - m.ray2.direction);
            const Matx<double, 2, 3> byTurn = across*rotation.derivativeOf(R*m.ray1.direction);
            const Vec2d byPixels[] = { across*(turned*m.ray1.directionByU), across*(turned*m.ray1.directionByV),
                                       across*m.ray2.directionByU, across*m.ray2.directionByV };
            Matx22d C;
            for (const Vec2d& by : byPixels)
                C += by*by.t();
            // Cholesky's factor of the covariance: whitened errors are of pixels.
            const double first = std::sqrt(C(0, 0)), both = C(1, 0)/first, second = std::sqrt(C(1, 1) - both*both);
            const double e0 = off[0]/first, e1 = (off[1] - both*e0)/second;
            if (std::isnan(e0) || std::isnan(e1))
                return false;
            double by0[3], by1[3];
            for (int k = 0; k < 3; k++)
            {
                by0[k] = byTurn(0, k)/first;
                by1[k] = (byTurn(1, k) - both*by0[k])/second;
            }
            sum.add(e0, by0);
            sum.add(e1, by1);
        }
        return !matches.empty();
    };
    Vec3d turn;
    const double sum = minimizeSquares<3>(evaluate, end, turn);
    if (std::isnan(sum))
        return std::numeric_limits<double>::infinity();
    R = rotationMatrix(turn)*R;
    return sum;
}

}} // namespace
