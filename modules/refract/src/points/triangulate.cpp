// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/triangulate.hpp"
#include "points/point_kernels.hpp"
#include "math/rotation.hpp"
#include <Eigen/Dense>

/* Two refracted rays -> a point. The midpoint of the shortest segment between them is the start; the maximum-likelihood
point minimises the sum of squared pixel errors in both raw images, by Gauss-Newton with exact derivatives. */

namespace cv { namespace refract {

namespace {

typedef Eigen::Matrix<double, 4, 1> Residual;
typedef Eigen::Matrix<double, 4, 3> Jacobian;

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
uchar reproject(const StereoPair& pair, const Vec3d& X, const Vec2d& p1, const Vec2d& p2, Residual& e, Jacobian& J,
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
    for (int c = 0; c < 3; c++)
        J.col(c) << J1[c], J1[3 + c], J2R(0, c), J2R(1, c);
    return REFRACT_OK;
}

/* Far from the minimum a step must reduce the cost; near it full Gauss-Newton steps converge, and the cost, whose
changes drown in rounding there, is not asked. */
uchar refine(const StereoPair& pair, const Vec2d& p1, const Vec2d& p2, Vec3d& X)
{
    const double NEAR = 1e-3, DONE = 1e-11, ROUNDING = 1e-6;        // pixels that a step moves the two images
    Residual e, eNew;
    Jacobian J, JNew;
    uchar status = reproject(pair, X, p1, p2, e, J, NULL, NULL);
    if (status != REFRACT_OK)
        return status;
    double last = DBL_MAX;
    for (int iteration = 0; iteration < 100; iteration++)
    {
        const Eigen::Vector3d step = -J.colPivHouseholderQr().solve(e);
        Vec3d move(step[0], step[1], step[2]);
        const double moved = (J*step).norm();
        bool taken = false;
        for (int cut = 0; cut < 40 && !taken; cut++, move *= 0.5)
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

/* Full Gauss-Newton steps of all lanes side by side. They converge at a rate that the sum of squares leaves small; a lane
whose moves shrink so fast that less than DONE pixels are left has arrived, and one that moved by less than `enough` pixels, any
other is left where it was, for refine(). Returns which lanes have arrived. */
void refineTogether(const StereoPair& pair, PixelPairs& block, int n, double off, double enough, uchar* arrived)
{
    const double DONE = 1e-11, SHRINK = 0.01;
    const int STEPS = 6;
    double predicted[4*BLOCK], J1[6*BLOCK], J2[6*BLOCK], x[BLOCK], y[BLOCK], z[BLOCK], x2[BLOCK], y2[BLOCK], z2[BLOCK];
    double moved[BLOCK], last[BLOCK];
    uchar st[BLOCK];
    CV_Assert(n > 0 && n <= BLOCK);
    const Columns observed = { block.pixels, 1, BLOCK }, prediction = { predicted, 1, BLOCK };
    const Columns byPoint1 = { J1, 3, BLOCK }, byPoint2 = { J2, 3, BLOCK }, none = { NULL, 0, 0 };
    std::copy(block.x, block.x + n, x); std::copy(block.y, block.y + n, y); std::copy(block.z, block.z + n, z);
    std::copy(block.status, block.status + n, st);
    std::fill(arrived, arrived + n, (uchar)false);
    std::fill(last, last + n, off*off/SHRINK);
    int missing = n;
    for (int k = 0; k < STEPS && missing > 0; k++)
    {
        std::copy(x, x + n, x2); std::copy(y, y + n, y2); std::copy(z, z + n, z2);
        pointKernels().transform(pair.R.val, pair.T.val, n, x2, y2, z2);
        pair.camera1.projectJacobian(n, x, y, z, predicted, predicted + BLOCK, byPoint1, none, st);
        pair.camera2.projectJacobian(n, x2, y2, z2, predicted + 2*BLOCK, predicted + 3*BLOCK, byPoint2, none, st);
        pointKernels().gaussNewton(n, pair.R.val, observed, prediction, byPoint1, byPoint2, x, y, z, moved);
        missing = 0;
        for (int i = 0; i < n; i++)
        {
            // What is left after moves of a, then b: about b^2/a. Squares throughout.
            const bool shrinks = moved[i] <= SHRINK*last[i] && st[i] == REFRACT_OK;
            const bool done = shrinks && (moved[i]*moved[i] <= DONE*DONE*last[i] || moved[i] < enough*enough);
            if (done && !arrived[i])
            {
                block.x[i] = x[i]; block.y[i] = y[i]; block.z[i] = z[i];
                arrived[i] = true;
            }
            if (!shrinks && st[i] == REFRACT_OK)
                st[i] = REFRACT_NOT_CONVERGED;
            missing += !arrived[i] && st[i] == REFRACT_OK;
            last[i] = moved[i];
        }
    }
}

//! The point of one pair of rays: its midpoint, by which the search begins.
uchar meet(const StereoPair& pair, double tau1, const Vec3d& d1, double tau2, const Vec3d& d2, Vec3d& X)
{
    const Matx33d Rt = pair.R.t();
    const Rays rays = { tau1*pair.camera1.layers().normal(), d1, Rt*(tau2*pair.camera2.layers().normal() - pair.T), Rt*d2 };
    return midpoint(rays, X);
}

bool isBeyondBoth(const StereoPair& pair, const Vec3d& X)
{
    const Vec3d X2 = pair.R*X + pair.T;
    return pair.camera1.layers().isBeyond(X[0], X[1], X[2]) && pair.camera2.layers().isBeyond(X2[0], X2[1], X2[2]);
}

} // namespace

/* Covariance of the maximum-likelihood point: J^+ S J^+^T from the pixels' covariance S, plus G C G^T, G = -J^+ J_parameters, from
the calibration's covariance C. */
struct PointCovariance::Calibration
{
    Eigen::MatrixXd covariance;     //!< empty: exact
    Matx33d dR[3];
};

PointCovariance::PointCovariance(const StereoPair& pair, InputArray calibration)
    : pair_(pair), calibration_(makePtr<Calibration>())
{
    const int count = pair.camera1.parameterCount() + pair.camera2.parameterCount() + 6;
    const std::vector<double> c = readNumbers(calibration, "calibrationCovariance");
    if (c.empty())
        return;
    if ((int)c.size() != count*count)
        CV_Error_(Error::StsBadSize, ("calibrationCovariance has %d values; it must be %dx%d", (int)c.size(), count, count));
    calibration_->covariance = Eigen::Map<const Eigen::MatrixXd>(c.data(), count, count);
    rotationMatrix(rotationVector(pair.R), calibration_->dR);
}

//! byPoint: reproject's derivative by X; its lower rows are those by the point in camera 2, times R.
static Eigen::MatrixXd parameterJacobian(const StereoPair& pair, const Matx33d* dR, const Vec3d& X, const Jacobian& byPoint,
                                         const std::vector<double>& p1, const std::vector<double>& p2)
{
    const int count1 = pair.camera1.parameterCount(), count2 = pair.camera2.parameterCount();
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(4, count1 + count2 + 6);
    for (int r = 0; r < 2; r++)
    {
        for (int c = 0; c < count1; c++)
            J(r, c) = p1[r*count1 + c];
        for (int c = 0; c < count2; c++)
            J(2 + r, count1 + c) = p2[r*count2 + c];
        const Vec3d D = pair.R*Vec3d(byPoint(2 + r, 0), byPoint(2 + r, 1), byPoint(2 + r, 2));
        for (int c = 0; c < 3; c++)
        {
            J(2 + r, count1 + count2 + c) = D.dot(dR[c]*X);
            J(2 + r, count1 + count2 + 3 + c) = D[c];
        }
    }
    return J;
}

void PointCovariance::evaluate(const Vec3d& X, const Matx44d& pixels, double* covariance) const
{
    Residual e;
    Jacobian J;
    std::vector<double> p1(2*pair_.camera1.parameterCount()), p2(2*pair_.camera2.parameterCount());
    if (reproject(pair_, X, Vec2d(), Vec2d(), e, J, p1.data(), p2.data()) != REFRACT_OK)
    {
        std::fill(covariance, covariance + 9, std::numeric_limits<double>::quiet_NaN());
        return;
    }
    const Eigen::Matrix<double, 3, 4> pseudoInverse = (J.transpose()*J).inverse()*J.transpose();
    Eigen::Matrix3d C = pseudoInverse*Eigen::Matrix4d(pixels.val)*pseudoInverse.transpose();
    if (calibration_->covariance.size())
    {
        const Eigen::MatrixXd G = pseudoInverse*parameterJacobian(pair_, calibration_->dR, X, J, p1, p2);
        C += G*calibration_->covariance*G.transpose();
    }
    std::copy(C.data(), C.data() + 9, covariance);
}

void checkSigma(double sigma, const char* name)
{
    if (!(sigma >= 0) || !std::isfinite(sigma))
        CV_Error_(Error::StsOutOfRange, ("%s is %g; it must not be negative", name, sigma));
}

void refineBlock(const StereoPair& pair, PixelPairs& block, int n, double off, double enough)
{
    uchar arrived[BLOCK];
    refineTogether(pair, block, n, off, enough, arrived);
    for (int i = 0; i < n; i++)
    {
        Vec3d X(block.x[i], block.y[i], block.z[i]);
        if (block.status[i] == REFRACT_OK && !arrived[i])
        {
            block.status[i] = refine(pair, Vec2d(block.pixel(0)[i], block.pixel(1)[i]),
                                     Vec2d(block.pixel(2)[i], block.pixel(3)[i]), X);
            block.x[i] = X[0]; block.y[i] = X[1]; block.z[i] = X[2];
        }
        if (block.status[i] == REFRACT_OK && !isBeyondBoth(pair, X))
            block.status[i] = REFRACT_BEHIND_WINDOW;
    }
}

void triangulateBlock(const StereoPair& pair, PixelPairs& block, int n, int flags)
{
    const double MIDPOINT_OFF = 0.1;    // pixels, of pixels that see one point
    double tau1[BLOCK], dx1[BLOCK], dy1[BLOCK], dz1[BLOCK], tau2[BLOCK], dx2[BLOCK], dy2[BLOCK], dz2[BLOCK];
    pair.camera1.unproject(n, block.pixel(0), block.pixel(1), tau1, dx1, dy1, dz1, block.status);
    pair.camera2.unproject(n, block.pixel(2), block.pixel(3), tau2, dx2, dy2, dz2, block.status);
    for (int i = 0; i < n; i++)
    {
        Vec3d X;
        if (block.status[i] == REFRACT_OK)
            block.status[i] = meet(pair, tau1[i], Vec3d(dx1[i], dy1[i], dz1[i]), tau2[i], Vec3d(dx2[i], dy2[i], dz2[i]), X);
        block.x[i] = X[0]; block.y[i] = X[1]; block.z[i] = X[2];
    }
    if (flags != TRIANGULATE_MIDPOINT)
        return refineBlock(pair, block, n, MIDPOINT_OFF, 0);
    for (int i = 0; i < n; i++)
        if (block.status[i] == REFRACT_OK && !isBeyondBoth(pair, Vec3d(block.x[i], block.y[i], block.z[i])))
            block.status[i] = REFRACT_BEHIND_WINDOW;
}

//! pointCovariance may be null, else its results go into covariance, one row a point.
static void triangulate(const StereoPair& pair, InputArray points1, InputArray points2, OutputArray points3D, OutputArray status,
                        int flags, const PointCovariance* pointCovariance, double sigma, Mat& covariance)
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
    forEachBlock(in1.size(), [&](int begin, int n)
    {
        PixelPairs block;
        uchar status2[BLOCK];
        in1.load(begin, n, block.pixel(0), block.pixel(1), NULL, block.status);
        in2.load(begin, n, block.pixel(2), block.pixel(3), NULL, status2);
        for (int i = 0; i < n; i++)
            if (block.status[i] == REFRACT_OK)
                block.status[i] = status2[i];
        out.prepare(begin, n);
        triangulateBlock(pair, block, n, flags);
        for (int i = 0; i < n && pointCovariance; i++)
            if (block.status[i] == REFRACT_OK)
                pointCovariance->evaluate(Vec3d(block.x[i], block.y[i], block.z[i]), sigma*sigma*Matx44d::eye(), covariance.ptr<double>(begin + i));
        out.store(begin, n, block.x, block.y, block.z, block.status);
        outStatus.store(begin, n, block.status);
    });
}

void triangulateRefractive(const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
                           InputArray R, InputArray T, InputArray points1, InputArray points2,
                           OutputArray points3D, OutputArray status, int flags)
{
    CV_INSTRUMENT_REGION();

    const StereoPair pair(cameraOf(camera1, "camera1"), cameraOf(camera2, "camera2"), R, T);
    Mat none;
    triangulate(pair, points1, points2, points3D, status, flags, NULL, 0, none);
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

    const StereoPair pair(cameraOf(camera1, "camera1"), cameraOf(camera2, "camera2"), R, T);
    checkSigma(pixelSigma, "pixelSigma");
    const PointCovariance pointCovariance(pair, calibrationCovariance);
    Mat C;
    triangulate(pair, points1, points2, points3D, status, flags, &pointCovariance, pixelSigma, C);
    if (covariance.needed())
        C.copyTo(covariance);
}

}} // namespace
