// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_BUNDLE_ROBUST_HPP
#define OPENCV_REFRACT_BUNDLE_ROBUST_HPP

#include "calibrate/bundle_problem.hpp"
#include "calibrate/robust_fit.hpp"

namespace cv { namespace refract {

//! A bundle: the points are not known, and those without enough inliers are not in use.
class BundleFitProblem : public FitProblem
{
public:
    /** @param isRigKnown, arePosesKnown R and T of several cameras, poses of several views: they tell the scale, as do lengths */
    BundleFitProblem(BundleProblem& bundle, bool isRigKnown, bool arePosesKnown)
        : FitProblem(bundle.rig()), bundle_(bundle), isRigKnown_(isRigKnown), arePosesKnown_(arePosesKnown) {}

    bool solve(const TermCriteria& criteria) override { return bundle_.solve(criteria); }
    int equationCount() const override { return bundle_.equationCount(); }
    int freedom() const override { return bundle_.freedom(); }
    double squaredError() const override { return bundle_.squaredError(); }
    bool hasPriors() const override { return bundle_.hasPriors(); }
    double rootWeight(double ratio) const override;
    void setInliers(Masks& inliers) override;
    bool bringBack(Masks& inliers, double scale) override;
    bool isInUse(int image, int row) const override { return bundle_.clusterOf(scenePoint(image, row)) >= 0; }
    int scenePoint(int image, int row) const override { return rig().images()[image].points.index[row]; }
    std::vector<std::pair<int, int> > tiedPoints() const override;
    std::vector<std::vector<DeletionResidual> > deletionResiduals(const Masks& inliers) override;
    String minorityFault(int fitting, int seen) const override;

    //! Throws where the observations in use do not tell the scale, or are too few.
    void checkWhatIsLeft() const;

private:
    bool tellsScale() const;
    BundleProblem& bundle_;
    const bool isRigKnown_, arePosesKnown_;
};

}} // namespace

#endif // OPENCV_REFRACT_BUNDLE_ROBUST_HPP
