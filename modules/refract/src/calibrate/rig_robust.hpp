// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIG_ROBUST_HPP
#define OPENCV_REFRACT_RIG_ROBUST_HPP

#include "calibrate/robust_fit.hpp"

namespace cv { namespace refract {

//! A calibration: the points are the target's. Images whose target was not where the view's other images have it are wrong.
class RigFitProblem : public FitProblem
{
public:
    explicit RigFitProblem(RigProblem& rig) : FitProblem(rig), status_(rig.images().size(), (uchar)GLASS_IMAGE_USED) {}

    bool solve(const TermCriteria& criteria) override { return rig().solve(criteria); }
    int equationCount() const override { return rig().equationCount(); }
    int freedom() const override { return rig().freedom(); }
    double squaredError() const override { return rig().squaredError(); }
    bool hasPriors() const override { return rig().hasPriors(); }
    double rootWeight(double ratio) const override;
    void leaveOutImages(double scale) override;
    void setInliers(Masks& inliers) override;
    std::vector<std::vector<DeletionResidual> > deletionResiduals(const Masks& inliers) override;
    String minorityFault(int fitting, int seen) const override;

    //! GlassImageStatus, in the order of RigProblem::images().
    const std::vector<uchar>& imageStatus() const { return status_; }

private:
    std::vector<uchar> status_;
};

/** The views without the points that agree with no common pose of their image, to start from. Images without a pose
become empty. */
RigViews agreeingViews(const Rig& rig, const RigViews& views);

}} // namespace

#endif // OPENCV_REFRACT_RIG_ROBUST_HPP
