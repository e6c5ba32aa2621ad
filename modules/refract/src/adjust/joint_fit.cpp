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

#include "adjust/joint_fit.hpp"
#include "adjust/deletion.hpp"
#include "adjust/minimize.hpp"
#include "arrays/whitening.hpp"
#include "math/robust_scale.hpp"
#include <numeric>

namespace cv { namespace refract {

// px, a numerical floor: without it, what is known would lose all weight where data are perfect.
static const double LEAST_PIXEL_SIGMA = 1e-3;

JointFit::JointFit(Problem& problem, Outliers& outliers, bool isRobust, int seenCount, const TermCriteria& criteria)
    : problem_(problem), outliers_(outliers), isRobust_(isRobust), seenCount_(seenCount), criteria_(criteria), scale_(0),
      damping_(FIRST_DAMPING) {}

FitOutcome JointFit::run()
{
    const int ROUNDS = 20;
    FitOutcome outcome;
    returned_.clear();
    for (int round = 0; round < ROUNDS; round++)
    {
        outcome = isRobust_ ? rejectOutliers() : minimize(problem_, criteria_, damping_);
        outcome.varianceFactor = isRobust_ ? 1/truncationFactor(CUT) : 1;
        if (!problem_.hasPriors() || !outcome.converged())
            break;
        const double before = problem_.pixelSigma();
        const double variance = outcome.varianceFactor*problem_.squaredError()/std::max(problem_.freedom(), 1);
        problem_.setPixelSigma(std::max(std::sqrt(variance), LEAST_PIXEL_SIGMA));
        if (std::abs(problem_.pixelSigma() - before) < 1e-4*before)
            break;
    }
    return outcome;
}

FitOutcome JointFit::approach()
{
    const double LEAST_GAIN = 1e-6;
    const TermCriteria few(TermCriteria::COUNT + TermCriteria::EPS, 20, LEAST_GAIN);
    return isRobust_ ? reweightGradually() : minimize(problem_, few, damping_, LEAST_GAIN);
}

//! Distances of predicted from observed pixels, of candidates; of halves as large as those of whole pixels usually are.
std::vector<std::vector<double> > JointFit::errors() const
{
    const double HALF = std::sqrt(std::log(4.))/0.6744898;      // between the medians of two coordinates' length and of one's
    std::vector<std::vector<double> > all;
    const Masks candidates = outliers_.candidates();
    const std::vector<std::vector<double> > pixelErrors = problem_.pixelErrors();
    for (size_t i = 0; i < images().size(); i++)
    {
        all.push_back(std::vector<double>());
        for (size_t row = 0; row < pixelErrors[i].size(); row++)
            if (candidates[i][row])
                all.back().push_back(images()[i].points.rowsOf(row) == 2 ? pixelErrors[i][row] : HALF*pixelErrors[i][row]);
    }
    return all;
}

//! By how much errors are larger than the residuals, of which parameters, poses and points absorb a part.
double JointFit::absorbed() const
{
    return std::sqrt(problem_.equationCount()/std::max((double)problem_.freedom(), 1.));
}

//! Each image's own scale, but no more than a few times that of the median image of its kind.
std::vector<double> JointFit::imageScales(const std::vector<std::vector<double> >& errors) const
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

//! Of the images whose weight is not zero.
static double medianScale(const std::vector<double>& scales, const std::vector<std::vector<double> >& errors)
{
    std::vector<double> some;
    for (size_t i = 0; i < scales.size(); i++)
        if (!errors[i].empty())
            some.push_back(scales[i]);
    return median(some);
}

FitOutcome JointFit::reweightGradually()
{
    const int ROUNDS = 30;
    const double LEAST_GAIN = 1e-3;         // of a scene: then weights change more than steps do
    const TermCriteria few(TermCriteria::COUNT, 5, 0);
    double last = std::numeric_limits<double>::infinity();
    FitOutcome outcome;
    for (int round = 0; round < ROUNDS && outcome.isUsable(); round++)
    {
        const std::vector<std::vector<double> > errors = this->errors();
        const std::vector<double> scales = imageScales(errors);
        const double sum = std::accumulate(scales.begin(), scales.end(), 0.);
        if (sum > 0.99*last)
            break;
        last = sum;
        if (problem_.hasPriors())   // weighed as the errors are now: too strong, they would make what contradicts them an outlier
            problem_.setPixelSigma(std::max(medianScale(scales, errors), LEAST_PIXEL_SIGMA));
        const Masks candidates = outliers_.candidates();
        for (int i = 0; i < (int)images().size(); i++)
        {
            std::vector<double> rootWeights(images()[i].points.pixel.size(), 0.);
            int next = 0;
            for (size_t row = 0; row < rootWeights.size(); row++)
                if (candidates[i][row])
                    rootWeights[row] = outliers_.rootWeight(errors[i][next++]/scales[i]);
            problem_.setRootWeights(i, rootWeights);
        }
        // None has an image, as where given poses are turned round?
        outcome = problem_.pointCount() == 0 ? checkMajority(0) : minimize(problem_, few, damping_, LEAST_GAIN);
    }
    return outcome;
}

//! From all images.
void JointFit::estimateScale()
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
Masks JointFit::smallErrors() const
{
    Masks inliers = outliers_.candidates();
    const std::vector<std::vector<double> > errors = problem_.pixelErrors();
    for (size_t i = 0; i < inliers.size(); i++)
        for (size_t row = 0; row < inliers[i].size(); row++)
            inliers[i][row] = inliers[i][row] && errors[i][row] < CUT*scale_;
    return inliers;
}

namespace {

//! The worst excess of the inliers of each scene point, and of those that lengths tie to it.
std::vector<double> worstNearby(const Problem& problem, const Masks& inliers, const std::vector<std::vector<double> >& excess)
{
    std::vector<double> worst(problem.scene().pointCount(), 0.);
    if (!problem.hasScene())
        return worst;
    for (size_t i = 0; i < excess.size(); i++)
        for (size_t row = 0; row < excess[i].size(); row++)
            if (inliers[i][row])
            {
                double& ofPoint = worst[problem.images()[i].points.index[row]];
                ofPoint = std::max(ofPoint, excess[i][row]);
            }
    std::vector<double> nearby = worst;
    for (const Cluster& cluster : problem.scene().clusters())
        for (const KnownLength& length : cluster.lengths)
        {
            const int a = cluster.points[length.a], b = cluster.points[length.b];
            nearby[a] = std::max(nearby[a], worst[b]);
            nearby[b] = std::max(nearby[b], worst[a]);
        }
    return nearby;
}

} // namespace

//! By deletion residuals. What leaves a second time has left for good, so that this comes to an end.
Masks JointFit::chooseInliers()
{
    const std::vector<std::vector<DeletionResidual> > residuals = deletionResiduals(problem_, inliers_, outliers_.candidates());
    std::vector<double> variances;
    for (const std::vector<DeletionResidual>& ofImage : residuals)
        for (const DeletionResidual& residual : ofImage)
            if (residual.dimensions > 0)
                variances.push_back(residual.varianceAsMedian());
    // Half of what the median tells: a smaller scale would leave out most of what is right, and fall with it.
    const double variance = std::max(scale_*scale_, median(variances)/4);
    const int freedom = problem_.freedom();
    std::vector<std::vector<double> > excess;
    for (const std::vector<DeletionResidual>& ofImage : residuals)
    {
        excess.push_back(std::vector<double>());
        for (const DeletionResidual& residual : ofImage)
            excess.back().push_back(residual.excess(variance, freedom));
    }
    const std::vector<double> nearby = worstNearby(problem_, inliers_, excess);
    Masks chosen = inliers_;
    for (size_t i = 0; i < residuals.size(); i++)
        for (size_t row = 0; row < residuals[i].size(); row++)
        {
            const double own = excess[i][row];
            const bool isWorst = !problem_.hasScene() || !(own < nearby[images()[i].points.index[row]] - 1);
            if (!inliers_[i][row])
                chosen[i][row] = residuals[i][row].dimensions > 0 && own < 1 && timesOut_[i][row] < 2;
            else if (own > 1 && isWorst)
            {
                chosen[i][row] = 0;
                timesOut_[i][row]++;
            }
        }
    return chosen;
}

FitOutcome JointFit::checkMajority(int count) const
{
    FitOutcome outcome(2*count < seenCount_ ? FitOutcome::TOO_FEW_INLIERS : FitOutcome::CONVERGED);
    outcome.count = count;
    outcome.expected = seenCount_;
    return outcome;
}

FitOutcome JointFit::solveAndScale()
{
    FitOutcome outcome = checkMajority(problem_.pointCount());
    if (!outcome.converged())
        return outcome;
    outcome = minimize(problem_, criteria_, damping_);
    if (problem_.freedom() > 0)
        scale_ = std::max(std::sqrt(problem_.squaredError()/(problem_.freedom()*truncationFactor(CUT))), LEAST_SCALE);
    return outcome;
}

//! Decides until the same observations stay. Where one fit of a scene after the other comes to no end, neither does what is left.
FitOutcome JointFit::rejectUntilStable()
{
    const int ROUNDS = 30, MOST_ENDLESS = 3;
    FitOutcome outcome = solveAndScale();
    for (int round = 0, endless = 0; round < ROUNDS && outcome.isUsable(); round++)
    {
        endless = outcome.status == FitOutcome::MAX_ITERATIONS ? endless + 1 : 0;
        if (endless == MOST_ENDLESS && problem_.hasScene())
            break;
        Masks chosen = chooseInliers();
        if (chosen == inliers_)
            break;
        const FitOutcome left = outliers_.setInliers(chosen);
        if (!left.converged())
            return left;
        if (chosen == inliers_)
            break;
        inliers_ = chosen;
        outcome = solveAndScale();
    }
    return outcome;
}

int JointFit::countWithin(double error) const
{
    int count = 0;
    for (const std::vector<double>& ofImage : errors())
        count += (int)std::count_if(ofImage.begin(), ofImage.end(), [&](double e) { return e < error; });
    return count;
}

//! Standard deviation of where a camera's whole pixels are, whichever has them farthest apart; infinite: none has any.
double JointFit::spread() const
{
    double largest = -1;
    for (int camera = 0; camera < problem_.cameraCount(); camera++)
    {
        std::vector<Point2d> pixels;
        for (const Image& image : images())
            if (image.camera == camera)
                std::copy_if(image.points.pixel.begin(), image.points.pixel.end(), std::back_inserter(pixels), isWhole);
        if (pixels.empty())
            continue;
        Scalar mean, deviation;
        meanStdDev(pixels, mean, deviation);
        largest = std::max(largest, norm(deviation)/std::sqrt(2.));
    }
    return largest < 0 ? std::numeric_limits<double>::infinity() : largest;
}

FitOutcome JointFit::chooseFirstInliers()
{
    const double FITS = 1;              // px
    const double NOTHING = 0.2;         // of the spread, which one point for all would leave: what leaves so much explains next to nothing
    int inImages = 0;
    for (const Image& image : images())
        inImages += (int)image.points.pixel.size();
    FitOutcome outcome = checkMajority(inImages);
    if (outcome.converged())
        outcome = reweightGradually();
    if (!outcome.isUsable())
        return outcome;
    estimateScale();
    if (problem_.hasScene() && scale_ > NOTHING*spread())
        return checkMajority(countWithin(FITS));        // it would creep for minutes, and come to nothing
    outliers_.leaveOutImages(scale_);
    inliers_ = smallErrors();
    outcome = outliers_.setInliers(inliers_);
    timesOut_.clear();
    for (const std::vector<uchar>& ofImage : inliers_)
        timesOut_.push_back(std::vector<uchar>(ofImage.size(), 0));
    return outcome;
}

FitOutcome JointFit::rejectOutliers()
{
    FitOutcome outcome;
    if (scale_ == 0)
        outcome = chooseFirstInliers();
    if (outcome.converged())
        outcome = rejectUntilStable();
    if (outcome.isUsable() && outliers_.bringBack(inliers_, scale_, returned_))
        outcome = rejectUntilStable();
    return outcome;
}

}} // namespace
