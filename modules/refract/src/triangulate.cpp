// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays.hpp"
#include "camera.hpp"
#include "rotation.hpp"
#include <Eigen/Dense>

/* Two refracted rays -> a point. The midpoint of the shortest segment between them is the start; the maximum-likelihood
point minimises the sum of squared pixel errors in both raw images, by Gauss-Newton with exact derivatives. */

namespace cv { namespace refract {

namespace {

typedef Eigen::Matrix<double, 4, 1> Residual;
typedef Eigen::Matrix<double, 4, 3> Jacobian;

struct Pair
{
    Pair(const Camera& c1, const Camera& c2, InputArray R_, InputArray T_)
        : camera1(c1), camera2(c2), R(readRotation(R_, "R")), T(readVec3(T_, "T")) {}
    const Camera& camera1;
    const Camera& camera2;
    const Matx33d R;
    const Vec3d T;
};

//! Rays in the frame of camera 1.
struct Rays
{
    Vec3d o1, d1, o2, d2;
};

uchar midpoint(const Rays& r, Vec3d& X)
{
    // o1 + s1 d1 - o2 - s2 d2 is parallel to d1 x d2
    const Vec3d axis = r.d1.cross(r.d2), between = r.o2 - r.o1;
    const double sine2 = axis.dot(axis);
    if (!(sine2 > 1e-24))
        return REFRACT_PARALLEL_RAYS;
    const double s1 = between.cross(r.d2).dot(axis)/sine2, s2 = between.cross(r.d1).dot(axis)/sine2;
    X = 0.5*(r.o1 + s1*r.d1 + r.o2 + s2*r.d2);
    return s1 > 0 && s2 > 0 ? REFRACT_OK : REFRACT_NO_INTERSECTION;
}

//! Both pixels of X minus the observed ones, and their derivative by X; parameters may be null.
uchar reproject(const Pair& pair, const Vec3d& X, const Vec2d& p1, const Vec2d& p2, Residual& e, Jacobian& J,
                double* parameters1, double* parameters2)
{
    Vec2d u1, u2;
    double J1[6], J2[6];
    uchar status = pair.camera1.projectJacobian(X, u1, J1, parameters1);
    if (status == REFRACT_OK)
        status = pair.camera2.projectJacobian(pair.R*X + pair.T, u2, J2, parameters2);
    if (status != REFRACT_OK)
        return status;
    const Matx23d J2R = Matx23d(J2)*pair.R;
    e << u1[0] - p1[0], u1[1] - p1[1], u2[0] - p2[0], u2[1] - p2[1];
    for (int c = 0; c < 3; ++c)
        J.col(c) << J1[c], J1[3 + c], J2R(0, c), J2R(1, c);
    return REFRACT_OK;
}

/* Far from the minimum a step must reduce the cost; near it full Gauss-Newton steps converge, and the cost, whose
changes drown in rounding there, is not asked. */
uchar refine(const Pair& pair, const Vec2d& p1, const Vec2d& p2, Vec3d& X)
{
    const double NEAR = 1e-3, DONE = 1e-11, ROUNDING = 1e-6;        // pixels that a step moves the two images
    Residual e, eNew;
    Jacobian J, JNew;
    uchar status = reproject(pair, X, p1, p2, e, J, NULL, NULL);
    if (status != REFRACT_OK)
        return status;
    double last = DBL_MAX;
    for (int iteration = 0; iteration < 100; ++iteration)
    {
        const Eigen::Vector3d step = -J.colPivHouseholderQr().solve(e);
        Vec3d move(step[0], step[1], step[2]);
        const double moved = (J*step).norm();
        bool taken = false;
        for (int cut = 0; cut < 40 && !taken; ++cut, move *= 0.5)
        {
            taken = reproject(pair, X + move, p1, p2, eNew, JNew, NULL, NULL) == REFRACT_OK
                    && (moved < NEAR || eNew.squaredNorm() < e.squaredNorm());
            if (taken)
            {
                X += move; e = eNew; J = JNew;
            }
        }
        if (!taken)
            return REFRACT_NOT_CONVERGED;
        if (moved <= DONE || (moved <= ROUNDING && moved >= 0.5*last))
            return REFRACT_OK;
        last = moved;
    }
    return REFRACT_NOT_CONVERGED;
}

uchar triangulateOne(const Pair& pair, const Rays& rays, const Vec2d& p1, const Vec2d& p2, int flags, Vec3d& X)
{
    uchar status = midpoint(rays, X);
    if (status == REFRACT_OK && !(flags & TRIANGULATE_MIDPOINT))
        status = refine(pair, p1, p2, X);
    if (status != REFRACT_OK)
        return status;
    const Vec3d X2 = pair.R*X + pair.T;
    const bool beyond = pair.camera1.layers().isBeyond(X[0], X[1], X[2])
                     && pair.camera2.layers().isBeyond(X2[0], X2[1], X2[2]);
    return beyond ? REFRACT_OK : REFRACT_BEHIND_WINDOW;
}

/* Covariance of the maximum-likelihood point: sigma^2 (J^T J)^-1 from the pixels, plus G C G^T, G = -J^+ J_parameters,
from the calibration's covariance C. */
class PointCovariance
{
public:
    PointCovariance(const Pair& pair, double sigma, InputArray calibration) : pair_(pair), sigma_(sigma)
    {
        if (!(sigma >= 0) || !std::isfinite(sigma))
            CV_Error_(Error::StsOutOfRange, ("pixelSigma is %g; it must not be negative", sigma));
        count1_ = pair.camera1.parameterCount();
        count2_ = pair.camera2.parameterCount();
        const int count = count1_ + count2_ + 6;
        const std::vector<double> c = readNumbers(calibration, "calibrationCovariance");
        if (c.empty())
            return;
        if ((int)c.size() != count*count)
            CV_Error_(Error::StsBadSize, ("calibrationCovariance has %d values; it must be %dx%d", (int)c.size(),
                                          count, count));
        calibration_ = Eigen::Map<const Eigen::MatrixXd>(c.data(), count, count);
        rotationMatrix(rotationVector(pair.R), dR_);
    }

    void evaluate(const Vec3d& X, double* covariance) const
    {
        Residual e;
        Jacobian J;
        std::vector<double> p1(2*count1_), p2(2*count2_);
        if (reproject(pair_, X, Vec2d(), Vec2d(), e, J, p1.data(), p2.data()) != REFRACT_OK)
        {
            std::fill(covariance, covariance + 9, std::numeric_limits<double>::quiet_NaN());
            return;
        }
        const Eigen::Matrix3d inverse = (J.transpose()*J).inverse();
        Eigen::Matrix3d C = sigma_*sigma_*inverse;
        if (calibration_.size())
        {
            const Eigen::MatrixXd G = inverse*J.transpose()*parameterJacobian(X, J, p1, p2);
            C += G*calibration_*G.transpose();
        }
        std::copy(C.data(), C.data() + 9, covariance);
    }

private:
    //! byPoint: reproject's derivative by X; its lower rows are those by the point in camera 2, times R.
    Eigen::MatrixXd parameterJacobian(const Vec3d& X, const Jacobian& byPoint, const std::vector<double>& p1,
                                      const std::vector<double>& p2) const
    {
        Eigen::MatrixXd J = Eigen::MatrixXd::Zero(4, count1_ + count2_ + 6);
        for (int r = 0; r < 2; ++r)
        {
            for (int c = 0; c < count1_; ++c)
                J(r, c) = p1[r*count1_ + c];
            for (int c = 0; c < count2_; ++c)
                J(2 + r, count1_ + c) = p2[r*count2_ + c];
            const Vec3d D = pair_.R*Vec3d(byPoint(2 + r, 0), byPoint(2 + r, 1), byPoint(2 + r, 2));
            for (int c = 0; c < 3; ++c)
            {
                J(2 + r, count1_ + count2_ + c) = D.dot(dR_[c]*X);
                J(2 + r, count1_ + count2_ + 3 + c) = D[c];
            }
        }
        return J;
    }

    const Pair& pair_;
    double sigma_;
    int count1_, count2_;
    Eigen::MatrixXd calibration_;
    Matx33d dR_[3];
};

//! pointCovariance may be null, else its results go into covariance, one row a point.
void triangulate(const Pair& pair, InputArray points1, InputArray points2, OutputArray points3D, OutputArray status,
                 int flags, const PointCovariance* pointCovariance, Mat& covariance)
{
    const PointReader in1(points1, 2, "points1"), in2(points2, 2, "points2");
    if (in1.size() != in2.size())
        CV_Error_(Error::StsUnmatchedSizes, ("points1 has %d points, points2 %d; they must agree", in1.size(), in2.size()));
    if (flags != TRIANGULATE_OPTIMAL && flags != TRIANGULATE_MIDPOINT)
        CV_Error_(Error::StsBadFlag, ("flags is %d; it must be TRIANGULATE_OPTIMAL or TRIANGULATE_MIDPOINT", flags));
    if (pointCovariance)
        covariance = Mat(in1.size(), 9, CV_64F, Scalar::all(std::numeric_limits<double>::quiet_NaN()));
    PointWriter out(points3D, in1.size(), 3, std::max(in1.depth(), in2.depth()));
    StatusWriter outStatus(status, in1.size());
    const Matx33d Rt = pair.R.t();
    forEachBlock(in1.size(), [&](int begin, int n)
    {
        double u1[BLOCK], v1[BLOCK], u2[BLOCK], v2[BLOCK], x[BLOCK], y[BLOCK], z[BLOCK];
        double tau1[BLOCK], dx1[BLOCK], dy1[BLOCK], dz1[BLOCK], tau2[BLOCK], dx2[BLOCK], dy2[BLOCK], dz2[BLOCK];
        uchar st[BLOCK], st2[BLOCK];
        in1.load(begin, n, u1, v1, NULL, st);
        in2.load(begin, n, u2, v2, NULL, st2);
        pair.camera1.unproject(n, u1, v1, tau1, dx1, dy1, dz1, st);
        pair.camera2.unproject(n, u2, v2, tau2, dx2, dy2, dz2, st2);
        for (int i = 0; i < n; ++i)
        {
            Vec3d X;
            if (st[i] == REFRACT_OK)
                st[i] = st2[i];
            if (st[i] == REFRACT_OK)
            {
                const Rays rays = { tau1[i]*pair.camera1.layers().normal(), Vec3d(dx1[i], dy1[i], dz1[i]),
                                    Rt*(tau2[i]*pair.camera2.layers().normal() - pair.T),
                                    Rt*Vec3d(dx2[i], dy2[i], dz2[i]) };
                st[i] = triangulateOne(pair, rays, Vec2d(u1[i], v1[i]), Vec2d(u2[i], v2[i]), flags, X);
            }
            x[i] = X[0]; y[i] = X[1]; z[i] = X[2];
            if (pointCovariance && st[i] == REFRACT_OK)
                pointCovariance->evaluate(X, covariance.ptr<double>(begin + i));
        }
        out.store(begin, n, x, y, z, st);
        outStatus.store(begin, n, st);
    });
}

} // namespace

void triangulateRefractive(const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
                           InputArray R, InputArray T, InputArray points1, InputArray points2,
                           OutputArray points3D, OutputArray status, int flags)
{
    CV_INSTRUMENT_REGION();

    const Pair pair(cameraOf(camera1, "camera1"), cameraOf(camera2, "camera2"), R, T);
    Mat none;
    triangulate(pair, points1, points2, points3D, status, flags, NULL, none);
}

void triangulateRefractive(InputArray cameraMatrix1, InputArray distCoeffs1, const GlassWindow& window1,
                           InputArray cameraMatrix2, InputArray distCoeffs2, const GlassWindow& window2,
                           InputArray R, InputArray T, InputArray points1, InputArray points2,
                           OutputArray points3D, OutputArray status, int flags)
{
    triangulateRefractive(RefractiveCamera::create(cameraMatrix1, distCoeffs1, window1),
                          RefractiveCamera::create(cameraMatrix2, distCoeffs2, window2),
                          R, T, points1, points2, points3D, status, flags);
}

void triangulateRefractive(const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
                           InputArray R, InputArray T, InputArray points1, InputArray points2,
                           OutputArray points3D, OutputArray status, int flags,
                           double pixelSigma, InputArray calibrationCovariance, OutputArray covariance)
{
    CV_INSTRUMENT_REGION();

    const Pair pair(cameraOf(camera1, "camera1"), cameraOf(camera2, "camera2"), R, T);
    const PointCovariance pointCovariance(pair, pixelSigma, calibrationCovariance);
    Mat C;
    triangulate(pair, points1, points2, points3D, status, flags, &pointCovariance, C);
    if (covariance.needed())
        C.copyTo(covariance);
}

}} // namespace
