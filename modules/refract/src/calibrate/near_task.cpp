// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/near_task.hpp"
#include "math/dense.hpp"

namespace cv { namespace refract {

static Eigen::MatrixXd toEigen(const Matx66d& A) { return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor> >(A.val); }

void moveNear(const NearOrigin& origin, Pose& pose, PosePrior* prior)
{
    pose = origin.toNear(pose);
    if (prior && prior->kind == PosePrior::UNCERTAIN)
        prior->sqrtInformation = product(prior->sqrtInformation, toEigen(origin.farByNear(pose)));
}

NearTask::NearTask(const RigTask& given) : task_(given), origins_(given.views.count())
{
    NearOrigin last;                // one for all targets that it serves: errors that they share are about it
    for (int view = 0; view < task_.views.count(); view++)
    {
        PosePrior* const prior = task_.posePriors.empty() ? nullptr : &task_.posePriors[view];
        // Of a pose that is known in part, what is known is of the target as it was given.
        if (prior && !canMove(*prior))
            continue;
        if (!last.isNear(task_.views.object[view]))
            last = NearOrigin(task_.views.object[view]);
        const NearOrigin& origin = origins_[view] = last;
        if (!origin.isMoved())
            continue;
        origin.move(task_.views.object[view]);
        if (prior && prior->kind != PosePrior::NONE)
            moveNear(origin, task_.knownPoses[view], prior);
    }
}

void NearTask::moveBack(RigFit& fit) const
{
    const int count = (int)origins_.size(), first = fit.jacobian.cols - 6*count;
    const double error = fit.targetErrors.empty() ? 0 : fit.targetErrors.at<double>(0), scale = std::isnan(error) ? 1 : 1 + error;
    for (int view = 0; view < count; view++)
    {
        if (!origins_[view].isMoved() || !fit.poses[view].found)
            continue;
        if (!fit.jacobian.empty())
        {
            Mat byPose = fit.jacobian.colRange(first + 6*view, first + 6*view + 6);
            Mat(byPose*Mat(origins_[view].nearByFar(fit.poses[view]))).copyTo(byPose);
        }
        fit.poses[view] = origins_[view].toFar(fit.poses[view], scale);
    }
}

void NearTask::moveBack(FitOutcome& outcome) const
{
    if (outcome.status == FitOutcome::NO_IMAGE && outcome.view >= 0)
        outcome.point += Point3d(origins_[outcome.view].origin());
}

}} // namespace
