// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Start, fit, and what it tells. Points that start badly are tried again from where the fit has come to. */

#include "calibrate/bundle_fit.hpp"
#include "calibrate/bundle_information.hpp"
#include "calibrate/bundle_robust.hpp"
#include "calibrate/bundle_start.hpp"
#include "calibrate/covariance.hpp"
#include <opencv2/core/eigen.hpp>

namespace cv { namespace refract {

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();

class BundleAdjustment
{
public:
    BundleAdjustment(const Rig& rig, const BundleTask& task)
        : bundle_(rig, task.pixels, (int)task.points.size(), task.poses, task.knowledge, task.lengths, task.flags),
          problem_(bundle_, task.isRigKnown, task.arePosesKnown), isRobust_((task.flags & GLASS_ROBUST) != 0),
          criteria_(checkedCriteria(task.criteria)) {}

    void run(const std::vector<Point3d>& given)
    {
        bundle_.setPoints(startPoints(rig(), given), Masks());
        problem_.checkWhatIsLeft();
        fit();
        if (!isRobust_ && usePointsThatStartedBadly())
            outcome_ = Fit(problem_, false, rig().pointCount(), criteria_).run();
        if (!outcome_.converged)
        {
            halfCovariance(rig(), reduced().information());     // first, as what is undetermined is also what does not converge
            CV_Error_(Error::StsNoConv, ("the bundle adjustment did not converge in %d iterations; raise criteria.maxCount, "
                                         "give a better start, or fix what the images hardly determine",
                                         criteria_.maxCount));
        }
    }

    void describe(bool wantsPointDeviations, BundleFit& fit);
    RigProblem& rig() { return bundle_.rig(); }

private:
    void fit();
    bool usePointsThatStartedBadly();
    ReducedBundle reduced();

    BundleProblem bundle_;
    BundleFitProblem problem_;
    const bool isRobust_;
    const TermCriteria criteria_;
    FitOutcome outcome_;
};

/** Normals, R and T, poses and points first: while they are far off, distances and lenses would run away along what makes up for
them, into other minima. */
void BundleAdjustment::fit()
{
    const auto hold = [this](bool isHeld)
    {
        for (RigBlock& block : rig().blocks())
            if (block.kind == RigBlock::MEDIA || block.kind == RigBlock::LENS)
                for (size_t i = 0; i < block.isFree.size(); i++)
                    block.isHeld[i] = isHeld && block.isFree[i];
    };
    Fit fit(problem_, isRobust_, rig().pointCount(), criteria_);
    hold(true);
    fit.approach();
    hold(false);
    outcome_ = fit.run();
}

bool BundleAdjustment::usePointsThatStartedBadly()
{
    const std::vector<Point3d> before = bundle_.points(), now = startPoints(rig(), before);
    const auto count = [](const std::vector<Point3d>& points)
    { return std::count_if(points.begin(), points.end(), [](const Point3d& p) { return std::isfinite(p.x); }); };
    if (count(now) == count(before))
        return false;
    bundle_.setPoints(now, Masks());
    return true;
}

ReducedBundle BundleAdjustment::reduced()
{
    CV_Assert(bundle_.evaluate(true));
    return ReducedBundle(bundle_, true);
}

void BundleAdjustment::describe(bool wantsPointDeviations, BundleFit& fit)
{
    const ReducedBundle equations = reduced();
    const Eigen::MatrixXd half = halfCovariance(rig(), equations.information());
    const double variance = outcome_.varianceFactor*bundle_.squaredError()/std::max(bundle_.freedom(), 1);
    eigen2cv(publicCovariance(rig(), half, variance), fit.covariance);
    sqrt(max(fit.covariance.diag(), 0), fit.stdDeviations);
    if (wantsPointDeviations)
        fit.pointDeviations = equations.pointDeviations(half, variance);
    fit.points = bundle_.points();
    const int cameras = rig().cameraCount();
    fit.perViewErrors = Mat(rig().viewCount(), cameras, CV_64F, Scalar(NaN));
    fit.inliers.assign(rig().viewCount()*cameras, Mat());
    double sum = 0;
    for (const RigImage& image : rig().images())
    {
        const double squares = rig().residuals(image).squaredNorm();
        sum += squares;
        if (image.usedCount() > 0)
            fit.perViewErrors.at<double>(image.view, image.camera) = std::sqrt(squares/image.usedCount());
        Mat mask((int)fit.points.size(), 1, CV_8U, Scalar(0));
        for (size_t k = 0; k < image.points.index.size(); k++)
            mask.at<uchar>(image.points.index[k]) = image.rootWeights[k] > 0;
        fit.inliers[image.view*cameras + image.camera] = mask;
    }
    fit.rms = std::sqrt(sum/rig().pointCount());
    for (int view = 0; view < rig().viewCount(); view++)
        fit.poses.push_back(rig().pose(view));
}

} // namespace

BundleFit fitBundle(Rig& rig, const BundleTask& task)
{
    BundleAdjustment adjustment(rig, task);
    adjustment.run(task.points);
    BundleFit fit;
    adjustment.describe(task.wantsPointDeviations, fit);
    rig = adjustment.rig().rig();
    return fit;
}

}} // namespace
