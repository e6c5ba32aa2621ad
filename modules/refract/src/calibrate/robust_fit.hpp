// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_ROBUST_FIT_HPP
#define OPENCV_REFRACT_ROBUST_FIT_HPP

#include "calibrate/rig_problem.hpp"
#include "math/studentized.hpp"

namespace cv { namespace refract {

typedef std::vector<std::vector<uchar> > Masks;     //!< per image, per point of it; 1: an inlier

/** A joint problem as the fit sees it: its observations are the points of its images. */
class FitProblem
{
public:
    explicit FitProblem(RigProblem& rig) : rig_(rig) {}
    virtual ~FitProblem() = default;
    RigProblem& rig() { return rig_; }
    const RigProblem& rig() const { return rig_; }

    //! As RigProblem's.
    virtual bool solve(const TermCriteria& criteria) = 0;
    virtual int equationCount() const = 0;
    virtual int freedom() const = 0;
    virtual double squaredError() const = 0;
    virtual bool hasPriors() const = 0;

    //! Root of an observation's weight while outliers are not yet known, by its error over the scale of its image.
    virtual double rootWeight(double ratio) const = 0;
    //! Takes out images that are wrong as a whole. @param scale of a pixel coordinate
    virtual void leaveOutImages(double scale) { (void)scale; }
    /** Uses these observations, and none that the others leave without meaning, which it takes out of inliers. Throws where what
    is left does not determine what is free. */
    virtual void setInliers(Masks& inliers) = 0;
    //! Tries to bring back what setInliers took out; false if there is nothing. @param scale of a pixel coordinate
    virtual bool bringBack(Masks& inliers, double scale) { (void)inliers; (void)scale; return false; }
    //! Whether an observation has a say now, or may have one.
    virtual bool isInUse(int image, int row) const { (void)image; (void)row; return true; }
    //! Where points are not known: which one it is; else -1.
    virtual int scenePoint(int image, int row) const { (void)image; (void)row; return -1; }
    //! Points that are tied to each other.
    virtual std::vector<std::pair<int, int> > tiedPoints() const { return std::vector<std::pair<int, int> >(); }
    //! Every observation against the others, whether it is used or not; those that are not in use, or have no image, have no
    //! dimension.
    virtual std::vector<std::vector<DeletionResidual> > deletionResiduals(const Masks& inliers) = 0;
    //! What to say where most observations do not fit.
    virtual String minorityFault(int fitting, int seen) const = 0;

private:
    RigProblem& rig_;
};

struct FitOutcome
{
    bool converged;
    double varianceFactor;              //!< corrects the residuals' variance for what was cut off
};

/** One fit, with outliers left out where it is robust; where something is known with a covariance, repeated until that is
weighed against the pixels' own noise. */
class Fit
{
public:
    //! @param seenCount observations that the caller gave
    Fit(FitProblem& problem, bool isRobust, int seenCount, const TermCriteria& criteria)
        : problem_(problem), isRobust_(isRobust), seenCount_(seenCount), criteria_(criteria), scale_(0) {}

    FitOutcome run();
    //! Towards the minimum from far, with a few iterations.
    void approach();

private:
    const std::vector<RigImage>& images() const { return problem_.rig().images(); }
    std::vector<std::vector<double> > errors() const;
    std::vector<double> imageScales(const std::vector<std::vector<double> >& errors) const;
    double absorbed() const;
    void graduate();
    void estimateScale();
    bool rejectOutliers();
    bool solveAndScale();
    bool settle();
    Masks smallErrors() const;
    Masks chooseInliers();
    void checkMajority(int count) const;

    FitProblem& problem_;
    const bool isRobust_;
    const int seenCount_;
    const TermCriteria criteria_;
    double scale_;                      //!< of a pixel coordinate; 0: not known yet
    Masks inliers_;
    std::vector<std::vector<uchar> > timesOut_;
};

}} // namespace

#endif // OPENCV_REFRACT_ROBUST_FIT_HPP
