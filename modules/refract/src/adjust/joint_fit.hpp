// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_JOINT_FIT_HPP
#define OPENCV_REFRACT_JOINT_FIT_HPP

#include "adjust/outliers.hpp"

namespace cv { namespace refract {

/** One fit, with outliers left out where it is robust; where priors are weighed against the pixels' noise, repeated until that is
the noise that the fit finds. */
class JointFit
{
public:
    //! @param seenCount observations that the caller gave
    JointFit(Problem& problem, Outliers& outliers, bool isRobust, int seenCount, const TermCriteria& criteria);

    bool isRobust() const { return isRobust_; }
    FitOutcome run();
    //! Towards the minimum from far, with a few iterations.
    FitOutcome approach();

private:
    const std::vector<Image>& images() const { return problem_.images(); }
    std::vector<std::vector<double> > errors() const;
    std::vector<double> imageScales(const std::vector<std::vector<double> >& errors) const;
    double absorbed() const;
    FitOutcome reweightGradually();
    void estimateScale();
    FitOutcome chooseFirstInliers();
    double spread() const;
    int countWithin(double error) const;
    FitOutcome rejectOutliers();
    FitOutcome solveAndScale();
    FitOutcome rejectUntilStable();
    Masks smallErrors() const;
    Masks chooseInliers();
    FitOutcome checkMajority(int count) const;

    Problem& problem_;
    Outliers& outliers_;
    const bool isRobust_;
    const int seenCount_;
    const TermCriteria criteria_;
    double scale_;                      //!< of a pixel coordinate; 0: not known yet
    double damping_;                    //!< of a scene's next step
    Masks inliers_;
    std::vector<std::vector<uchar> > timesOut_;
    std::vector<uchar> returned_;       //!< per scene point
};

}} // namespace

#endif // OPENCV_REFRACT_JOINT_FIT_HPP
