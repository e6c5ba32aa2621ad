// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Points that start badly are tried again from where the fit has come to. With GLASS_ROBUST, as in rig_robust.cpp: first under
a loss whose scale falls with the errors, then a hard decision at the 1 - 1e-4 quantile of their Rayleigh distribution, repeated
with its scale until the same sightings stay. */

#include "calibrate/bundle_fit.hpp"
#include "calibrate/bundle_information.hpp"
#include "calibrate/bundle_start.hpp"
#include "calibrate/covariance.hpp"
#include "math/robust_scale.hpp"
#include <opencv2/core/eigen.hpp>

namespace cv { namespace refract {

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();
// px: nobody finds points better than this; without it, lengths would lose all weight where data are perfect.
const double LEAST_PIXEL_SIGMA = 1e-3;
typedef std::vector<std::vector<uchar> > Masks;     // per image, per point of it

class BundleAdjustment
{
public:
    BundleAdjustment(const Rig& rig, const BundleTask& task)
        : bundle_(rig, task.pixels, (int)task.points.size(), task.poses, task.knowledge, task.lengths, task.flags),
          isRobust_((task.flags & GLASS_ROBUST) != 0), criteria_(checkedCriteria(task.criteria)), varianceFactor_(1) {}

    void run(const std::vector<Point3d>& given, bool needsLengths)
    {
        bundle_.setPoints(startPoints(rig(), given), Masks());
        if (needsLengths && bundle_.lengthCount() == 0)
            CV_Error(Error::StsBadArg, "lengths has none between two points that are seen in two images or more, by rays "
                                       "that meet beyond the windows; nothing else tells the scale");
        checkFreedom();
        approach();
        solve();
        if (usePointsThatStartedBadly())
            solve();
        if (!converged_)
        {
            covariance(reduced());      // first, as what is undetermined is also what does not converge
            CV_Error_(Error::StsNoConv, ("the bundle adjustment did not converge in %d iterations; raise criteria.maxCount, "
                                         "give a better start, or fix what the images hardly determine",
                                         criteria_.maxCount));
        }
    }

    void describe(bool wantsPointDeviations, BundleFit& fit);
    RigProblem& rig() { return bundle_.rig(); }

private:
    void checkFreedom() const;
    void approach();
    void solve();
    bool usePointsThatStartedBadly();
    void graduate();
    void decide();
    Masks chooseInliers() const;
    bool useInliers(const Masks& inliers);
    std::vector<double> errors() const;
    ReducedBundle reduced();
    Eigen::MatrixXd covariance(const ReducedBundle& equations);
    double variance() const { return varianceFactor_*bundle_.squaredError()/std::max(bundle_.freedom(), 1); }

    BundleProblem bundle_;
    const bool isRobust_;
    const TermCriteria criteria_;
    double varianceFactor_;
    bool converged_ = false;
    double scale_ = 0;          //!< of a pixel coordinate, robust
};

void BundleAdjustment::checkFreedom() const
{
    if (bundle_.freedom() <= 0)
        CV_Error_(Error::StsBadArg, ("points that are seen in two images or more give %d equations, with lengths and poses; %d "
                                     "fewer than are needed; take more points, or points that more images see",
                                     bundle_.equationCount(), 1 - bundle_.freedom()));
}

/** Normals, R and T, poses and points first: while they are far off, distances and lenses would run away along what makes up for
them, into other minima. */
void BundleAdjustment::approach()
{
    const auto hold = [this](bool isHeld)
    {
        for (RigBlock& block : rig().blocks())
            if (block.kind == RigBlock::MEDIA || block.kind == RigBlock::LENS)
                for (size_t i = 0; i < block.isFree.size(); i++)
                    block.isHeld[i] = isHeld && block.isFree[i];
    };
    hold(true);
    bundle_.solve(TermCriteria(TermCriteria::COUNT, 20, 0), isRobust_ ? 1. : 0.);
    hold(false);
}

//! Until lengths and poses are weighed against the pixels' own noise.
void BundleAdjustment::solve()
{
    const int ROUNDS = 20;
    for (int round = 0; round < ROUNDS; round++)
    {
        if (isRobust_)
            decide();
        else
            converged_ = bundle_.solve(criteria_);
        if (!bundle_.hasPriors() || !converged_)
            break;
        const double before = rig().pixelSigma();
        rig().setPixelSigma(std::max(std::sqrt(variance()), LEAST_PIXEL_SIGMA));
        if (std::abs(rig().pixelSigma() - before) < 1e-4*before)
            break;
    }
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

//! Distances of predicted from observed pixels, of all sightings.
std::vector<double> BundleAdjustment::errors() const
{
    std::vector<double> all;
    for (const Cluster& cluster : bundle_.clusters())
        for (const Sighting& s : cluster.sightings)
            all.push_back(bundle_.state(s.image).derivatives.residuals.segment<2>(2*s.row).norm());
    return all;
}

void BundleAdjustment::graduate()
{
    const int ROUNDS = 30;
    const TermCriteria few(TermCriteria::COUNT, 5, 0);
    double last = std::numeric_limits<double>::infinity();
    for (int round = 0; round < ROUNDS; round++)
    {
        CV_Assert(bundle_.evaluate(false));
        scale_ = std::max(scaleOf(errors()), LEAST_SCALE);
        if (scale_ > 0.99*last)
            return;
        last = scale_;
        bundle_.solve(few, 2.385*scale_);       // 95 % as efficient as squares on clean data
    }
}

//! Sightings in images whose errors are those of good ones.
Masks BundleAdjustment::chooseInliers() const
{
    Masks inliers;
    for (const RigImage& image : bundle_.rig().images())
    {
        inliers.push_back(std::vector<uchar>());
        for (double error : bundle_.rig().pixelErrors(image, bundle_.rig().pose(image.view)))
            inliers.back().push_back(error < CUT*scale_);
    }
    return inliers;
}

//! False if they are as before. A point that fewer than two images see rightly is no longer in use.
bool BundleAdjustment::useInliers(const Masks& inliers)
{
    std::vector<Point3d> points = bundle_.points();
    std::vector<int> seen(points.size(), 0);
    bool changed = false;
    for (size_t i = 0; i < inliers.size(); i++)
    {
        const RigImage& image = rig().images()[i];
        for (size_t row = 0; row < inliers[i].size(); row++)
        {
            seen[image.points.index[row]] += inliers[i][row];
            changed = changed || (std::isfinite(points[image.points.index[row]].x) &&
                                  (image.rootWeights[row] > 0) != (inliers[i][row] > 0));
        }
    }
    if (!changed)
        return false;
    for (size_t i = 0; i < points.size(); i++)
        if (seen[i] < 2)
            points[i] = Point3d(NaN, NaN, NaN);
    bundle_.setPoints(points, inliers);
    return true;
}

void BundleAdjustment::decide()
{
    const int ROUNDS = 10;
    if (scale_ == 0)
        graduate();
    const int seen = rig().pointCount();
    // What points and parameters absorbed is added.
    CV_Assert(bundle_.evaluate(false));
    scale_ = std::max(truncatedScale(errors(), scale_, 3), LEAST_SCALE)*
             std::sqrt(bundle_.equationCount()/std::max((double)bundle_.freedom(), 1.));
    converged_ = false;
    for (int round = 0; round < ROUNDS && (useInliers(chooseInliers()) || round == 0); round++)
    {
        if (2*rig().pointCount() < seen)
            CV_Error_(Error::StsNoConv, ("only %d of %d sightings fit; are the points matched, and is the start near enough?",
                                         rig().pointCount(), seen));
        checkFreedom();
        converged_ = bundle_.solve(criteria_);
        varianceFactor_ = 1/truncationFactor(CUT);
        scale_ = std::max(std::sqrt(variance()), LEAST_SCALE);
    }
}

ReducedBundle BundleAdjustment::reduced()
{
    CV_Assert(bundle_.evaluate(true));
    return ReducedBundle(bundle_, true);
}

Eigen::MatrixXd BundleAdjustment::covariance(const ReducedBundle& equations)
{
    return rigCovariance(rig(), equations.information(), variance());
}

void BundleAdjustment::describe(bool wantsPointDeviations, BundleFit& fit)
{
    const ReducedBundle equations = reduced();
    eigen2cv(covariance(equations), fit.covariance);
    sqrt(max(fit.covariance.diag(), 0), fit.stdDeviations);
    if (wantsPointDeviations)
        fit.pointDeviations = equations.pointDeviations(variance());
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
    adjustment.run(task.points, task.needsLengths);
    BundleFit fit;
    adjustment.describe(task.wantsPointDeviations, fit);
    rig = adjustment.rig().rig();
    return fit;
}

}} // namespace
