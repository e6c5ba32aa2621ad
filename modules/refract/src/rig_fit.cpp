// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "rig_fit.hpp"
#include "covariance.hpp"
#include "rig_start.hpp"
#include <opencv2/core/eigen.hpp>

namespace cv { namespace refract {

static Mat rmsPerView(const RigProblem& rig, int cameras)
{
    Mat errors(rig.viewCount(), 2*cameras, CV_64F, Scalar(std::numeric_limits<double>::quiet_NaN()));
    for (const RigImage& image : rig.images())
        errors.at<double>(image.view, 2*image.camera + (image.refracted ? 0 : 1)) =
            std::sqrt(rig.squaredError(image)/(double)image.points.pixel.size());
    return errors;
}

//! Both limits in force: what the caller left open is generous.
static TermCriteria checkedCriteria(TermCriteria criteria)
{
    if (!(criteria.type & (TermCriteria::COUNT | TermCriteria::EPS)))
        CV_Error_(Error::StsBadArg, ("criteria.type is %d; it must have COUNT, EPS or both", criteria.type));
    if (!(criteria.type & TermCriteria::COUNT))
        criteria.maxCount = 1000;
    if (criteria.maxCount < 1)
        CV_Error_(Error::StsOutOfRange, ("criteria.maxCount is %d; it must be at least 1", criteria.maxCount));
    if ((criteria.type & TermCriteria::EPS) && !(criteria.epsilon >= 0))
        CV_Error_(Error::StsOutOfRange, ("criteria.epsilon is %g; it must not be negative", criteria.epsilon));
    return criteria;
}

RigFit fitRig(std::vector<Camera>& cameras, Pose& extrinsics, const RigViews& views, int flags,
              const TermCriteria& criteria_, bool wantsJacobian)
{
    const TermCriteria criteria = checkedCriteria(criteria_);
    const std::vector<Pose> poses = startPoses(cameras, extrinsics, views);
    RigProblem rig(cameras, extrinsics, views, poses, flags);
    const int observations = 2*rig.pointCount(), unknowns = rig.freeCount() + 6*rig.viewCount();
    if (observations <= unknowns)
        CV_Error_(Error::StsBadArg, ("%d points were observed, which give %d equations for %d unknowns; take more views",
                                     rig.pointCount(), observations, unknowns));
    const bool converged = rig.solve(criteria);

    // First, as what is undetermined is also what does not converge.
    RigFit fit;
    eigen2cv(rigCovariance(rig), fit.covariance);
    if (!converged)
        CV_Error_(Error::StsNoConv, ("the calibration did not converge in %d iterations; raise criteria.maxCount, or fix "
                                     "what the views hardly determine", criteria.maxCount));
    sqrt(max(fit.covariance.diag(), 0), fit.stdDeviations);
    fit.perViewErrors = rmsPerView(rig, (int)cameras.size());
    if (wantsJacobian)
        eigen2cv(rigJacobian(rig), fit.jacobian);
    fit.rms = std::sqrt(rig.squaredError()/rig.pointCount());
    for (int view = 0; view < rig.viewCount(); view++)
        fit.poses.push_back(rig.pose(view));
    for (int c = 0; c < (int)cameras.size(); c++)
        cameras[c] = rig.camera(c);
    if (rig.isStereo())
        extrinsics = rig.extrinsics();
    return fit;
}

//! One array of vectors, as calib3d writes them.
static void writeVectors(const std::vector<Pose>& poses, Vec3d Pose::*member, OutputArrayOfArrays out)
{
    if (!out.needed())
        return;
    const int count = (int)poses.size();
    if (!out.isMatVector())
    {
        Mat all(count, 1, CV_64FC3);
        for (int i = 0; i < count; i++)
            all.at<Vec3d>(i) = poses[i].*member;
        all.copyTo(out);
        return;
    }
    out.create(count, 1, CV_64FC3);
    for (int i = 0; i < count; i++)
    {
        out.create(3, 1, CV_64F, i, true);
        Mat(poses[i].*member).copyTo(out.getMat(i));
    }
}

void writeFit(const RigFit& fit, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, OutputArray stdDeviations,
              OutputArray covariance, OutputArray perViewErrors, OutputArray jacobian)
{
    writeVectors(fit.poses, &Pose::rvec, rvecs);
    writeVectors(fit.poses, &Pose::tvec, tvecs);
    if (stdDeviations.needed())
        fit.stdDeviations.copyTo(stdDeviations);
    if (covariance.needed())
        fit.covariance.copyTo(covariance);
    if (perViewErrors.needed())
        fit.perViewErrors.copyTo(perViewErrors);
    if (jacobian.needed())
        fit.jacobian.copyTo(jacobian);
}

}} // namespace
