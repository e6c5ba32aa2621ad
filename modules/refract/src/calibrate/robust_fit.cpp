// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The joint fit where some observations are wrong, whether the points are known (a calibration) or not (a bundle).

1. Graduated: every observation has a weight by its error over its image's own scale, the median of its errors, so that an
   image keeps its points while the window is still wrong; the scales fall as the fit improves. An image far worse than the
   others of its kind has no say.
2. Images that are wrong as a whole are left out, where the problem knows such.
3. Observations: a hard decision by their deletion residuals (studentized.hpp), repeated with the scale until the same ones
   stay. So clean data lose nothing whatever the leverage, what remains is weighed by maximum likelihood, and what was left out
   comes back where the others come to predict it.

An outlier drags a point that is not known along, and all its other observations look wrong. So of one point, and of those that
are tied to it, only the worst goes at a time, with those that cannot be told apart from it. */

#include "calibrate/robust_fit.hpp"
#include "math/robust_scale.hpp"
#include <map>
#include <numeric>

namespace cv { namespace refract {

// px: nobody finds points better than this; without it, what is known would lose all weight where data are perfect.
static const double LEAST_PIXEL_SIGMA = 1e-3;

FitOutcome Fit::run()
{
    const int ROUNDS = 20;
    FitOutcome outcome = { false, 1 };
    for (int round = 0; round < ROUNDS; round++)
    {
        if (isRobust_)
        {
            outcome.converged = rejectOutliers();
            outcome.varianceFactor = 1/truncationFactor(CUT);
        }
        else
            outcome.converged = problem_.solve(criteria_);
        if (!problem_.hasPriors() || !outcome.converged)
            break;
        RigProblem& rig = problem_.rig();
        const double before = rig.pixelSigma();
        const double variance = outcome.varianceFactor*problem_.squaredError()/std::max(problem_.freedom(), 1);
        rig.setPixelSigma(std::max(std::sqrt(variance), LEAST_PIXEL_SIGMA));
        if (std::abs(rig.pixelSigma() - before) < 1e-4*before)
            break;
    }
    return outcome;
}

void Fit::approach()
{
    const TermCriteria few(TermCriteria::COUNT, 20, 0);
    if (isRobust_)
        graduate();
    else
        problem_.solve(few);
}

//! Distances of predicted from observed pixels, of what is in use.
std::vector<std::vector<double> > Fit::errors() const
{
    std::vector<std::vector<double> > all;
    const RigProblem& rig = problem_.rig();
    for (int i = 0; i < (int)images().size(); i++)
    {
        const std::vector<double> ofImage = rig.pixelErrors(images()[i], rig.pose(images()[i].view));
        all.push_back(std::vector<double>());
        for (int row = 0; row < (int)ofImage.size(); row++)
            if (problem_.isInUse(i, row))
                all.back().push_back(ofImage[row]);
    }
    return all;
}

//! By how much errors are larger than the residuals, of which parameters, poses and points absorb a part.
double Fit::absorbed() const
{
    return std::sqrt(problem_.equationCount()/std::max((double)problem_.freedom(), 1.));
}

//! Each image's own scale, but no more than a few times that of the median image of its kind.
std::vector<double> Fit::imageScales(const std::vector<std::vector<double> >& errors) const
{
    const double MOST = 3, absorbed = this->absorbed();
    std::vector<double> scales, ofKind[2];
    for (size_t i = 0; i < errors.size(); i++)
    {
        scales.push_back(absorbed*scaleOf(errors[i]));
        if (!errors[i].empty())
            ofKind[images()[i].refracted].push_back(scales[i]);
    }
    const double limits[] = { MOST*median(ofKind[0]), MOST*median(ofKind[1]) };
    for (size_t i = 0; i < errors.size(); i++)
        scales[i] = std::min(scales[i], limits[images()[i].refracted]);
    return scales;
}

void Fit::graduate()
{
    const int ROUNDS = 30;
    const TermCriteria few(TermCriteria::COUNT, 5, 0);
    double last = std::numeric_limits<double>::infinity();
    RigProblem& rig = problem_.rig();
    for (int round = 0; round < ROUNDS; round++)
    {
        const std::vector<std::vector<double> > errors = this->errors();
        const std::vector<double> scales = imageScales(errors);
        const double sum = std::accumulate(scales.begin(), scales.end(), 0.);
        if (sum > 0.99*last)
            return;
        last = sum;
        for (int i = 0; i < (int)images().size(); i++)
        {
            std::vector<double> rootWeights(images()[i].points.pixel.size(), 0.);
            int next = 0;
            for (int row = 0; row < (int)rootWeights.size(); row++)
                if (problem_.isInUse(i, row))
                    rootWeights[row] = problem_.rootWeight(errors[i][next++]/scales[i]);
            rig.setRootWeights(i, rootWeights);
        }
        if (rig.pointCount() == 0)      // none has an image, as where given poses are turned round
            checkMajority(0);
        problem_.solve(few);
    }
}

//! From all images.
void Fit::estimateScale()
{
    std::vector<double> all, scales;
    for (const std::vector<double>& ofImage : errors())
    {
        if (!ofImage.empty())
            scales.push_back(scaleOf(ofImage));
        all.insert(all.end(), ofImage.begin(), ofImage.end());
    }
    scale_ = truncatedScale(all, median(scales), 3)*absorbed();
}

//! Before leverages are known.
Masks Fit::smallErrors() const
{
    Masks inliers;
    const RigProblem& rig = problem_.rig();
    for (int i = 0; i < (int)images().size(); i++)
    {
        inliers.push_back(std::vector<uchar>());
        for (double error : rig.pixelErrors(images()[i], rig.pose(images()[i].view)))
        {
            const int row = (int)inliers.back().size();
            inliers.back().push_back(problem_.isInUse(i, row) && error < CUT*scale_);
        }
    }
    return inliers;
}

//! By deletion residuals. What leaves a second time has left for good, so that this comes to an end.
Masks Fit::chooseInliers()
{
    const std::vector<std::vector<DeletionResidual> > residuals = problem_.deletionResiduals(inliers_);
    std::vector<double> variances;
    for (size_t i = 0; i < residuals.size(); i++)
        for (size_t row = 0; row < residuals[i].size(); row++)
            if (residuals[i][row].dimensions > 0)
                variances.push_back(residuals[i][row].varianceAsMedian());
    // Half of what the median tells: a smaller scale would leave out most of what is right, and fall with it.
    const double variance = std::max(scale_*scale_, median(variances)/4);
    const int freedom = problem_.freedom();

    std::map<int, double> worst;        // of each scene point, and of those tied to it
    for (int i = 0; i < (int)residuals.size(); i++)
        for (int row = 0; row < (int)residuals[i].size(); row++)
            if (inliers_[i][row] && problem_.scenePoint(i, row) >= 0)
            {
                double& ofPoint = worst[problem_.scenePoint(i, row)];
                ofPoint = std::max(ofPoint, residuals[i][row].excess(variance, freedom));
            }
    std::map<int, double> nearby = worst;
    for (const std::pair<int, int>& tie : problem_.tiedPoints())
    {
        nearby[tie.first] = std::max(nearby[tie.first], worst[tie.second]);
        nearby[tie.second] = std::max(nearby[tie.second], worst[tie.first]);
    }
    Masks chosen = inliers_;
    for (int i = 0; i < (int)residuals.size(); i++)
        for (int row = 0; row < (int)residuals[i].size(); row++)
        {
            const double excess = residuals[i][row].excess(variance, freedom);
            const int point = problem_.scenePoint(i, row);
            if (!inliers_[i][row])
                chosen[i][row] = residuals[i][row].dimensions > 0 && excess < 1 && timesOut_[i][row] < 2;
            else if (excess > 1 && (point < 0 || !(excess < nearby[point] - 1)))
            {
                chosen[i][row] = 0;
                timesOut_[i][row]++;
            }
        }
    return chosen;
}

void Fit::checkMajority(int count) const
{
    if (2*count < seenCount_)
        CV_Error(Error::StsNoConv, problem_.minorityFault(count, seenCount_));
}

bool Fit::solveAndScale()
{
    checkMajority(problem_.rig().pointCount());
    const bool converged = problem_.solve(criteria_);
    if (problem_.freedom() > 0)
        scale_ = std::max(std::sqrt(problem_.squaredError()/(problem_.freedom()*truncationFactor(CUT))), LEAST_SCALE);
    return converged;
}

//! Decides until the same observations stay.
bool Fit::settle()
{
    const int ROUNDS = 30;
    bool converged = solveAndScale();
    for (int round = 0; round < ROUNDS; round++)
    {
        Masks chosen = chooseInliers();
        if (chosen == inliers_)
            break;
        problem_.setInliers(chosen);
        if (chosen == inliers_)
            break;
        inliers_ = chosen;
        converged = solveAndScale();
    }
    return converged;
}

bool Fit::rejectOutliers()
{
    if (scale_ == 0)
    {
        int inImages = 0;
        for (const RigImage& image : images())
            inImages += (int)image.points.pixel.size();
        checkMajority(inImages);
        graduate();
        estimateScale();
        problem_.leaveOutImages(scale_);
        inliers_ = smallErrors();
        problem_.setInliers(inliers_);
        timesOut_.clear();
        for (const std::vector<uchar>& ofImage : inliers_)
            timesOut_.push_back(std::vector<uchar>(ofImage.size(), 0));
    }
    bool converged = settle();
    if (problem_.bringBack(inliers_, scale_))
        converged = settle();
    return converged;
}

}} // namespace
