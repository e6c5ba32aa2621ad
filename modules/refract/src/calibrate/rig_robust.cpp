// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The joint fit where some points and some images are wrong.

1. Start: poses of random samples drop what is grossly wrong (agreeingViews).
2. Graduated: every point is weighed by Tukey's biweight with each image's own scale, the median of its errors, so that an
   image keeps its points while the window is still wrong; the scales fall as the fit improves. An image far worse than
   the others of its kind has no say.
3. Images whose target was moved are left out (moved_images.hpp).
4. Points: a hard decision at the 1 - 1e-4 quantile of the errors' Rayleigh distribution, repeated with its scale until the
   same points stay. So clean data lose nothing, and what remains is weighed by maximum likelihood. */

#include "calibrate/rig_robust.hpp"
#include "calibrate/moved_images.hpp"
#include "math/robust_scale.hpp"
#include <numeric>

namespace cv { namespace refract {

namespace {

class RobustFit
{
public:
    RobustFit(RigProblem& rig, int seenCount, const TermCriteria& criteria)
        : problem_(rig), seenCount_(seenCount), criteria_(criteria),
          status_(rig.images().size(), (uchar)GLASS_IMAGE_USED), scale_(0) {}

    RobustOutcome run()
    {
        int inImages = 0;
        for (const RigImage& image : images())
            inImages += (int)image.points.pixel.size();
        checkMajority(inImages);
        graduate();
        estimateScale();
        leaveOutMovedImages();
        RobustOutcome outcome;
        outcome.converged = decide();
        outcome.varianceFactor = 1/truncationFactor(CUT);
        outcome.imageStatus = status_;
        return outcome;
    }

private:
    const std::vector<RigImage>& images() const { return problem_.images(); }

    std::vector<double> imageScales(const std::vector<std::vector<double> >& errors) const;
    void graduate();
    void estimateScale();
    void leaveOutMovedImages();
    bool decide();
    bool chooseInliers();

    void checkMajority(int count) const;

    RigProblem& problem_;
    const int seenCount_;
    const TermCriteria criteria_;
    std::vector<uchar> status_;
    double scale_;
};

//! Each image's own scale, but no more than a few times that of the median image of its kind.
std::vector<double> RobustFit::imageScales(const std::vector<std::vector<double> >& errors) const
{
    const double MOST = 3;
    std::vector<double> scales, ofKind[2];
    for (size_t i = 0; i < errors.size(); i++)
    {
        scales.push_back(scaleOf(errors[i]));
        ofKind[images()[i].refracted].push_back(scales[i]);
    }
    const double limits[] = { MOST*median(ofKind[0]), MOST*median(ofKind[1]) };
    for (size_t i = 0; i < errors.size(); i++)
        scales[i] = std::min(scales[i], limits[images()[i].refracted]);
    return scales;
}

void RobustFit::graduate()
{
    const int ROUNDS = 30;
    const double TUKEY = 4.685;
    const TermCriteria few(TermCriteria::COUNT, 5, 0);
    double last = std::numeric_limits<double>::infinity();
    for (int round = 0; round < ROUNDS; round++)
    {
        std::vector<std::vector<double> > errors;
        for (const RigImage& image : images())
            errors.push_back(problem_.pixelErrors(image, problem_.pose(image.view)));
        const std::vector<double> scales = imageScales(errors);
        const double sum = std::accumulate(scales.begin(), scales.end(), 0.);
        if (sum > 0.99*last)
            return;
        last = sum;
        for (int i = 0; i < (int)images().size(); i++)
        {
            std::vector<double> rootWeights;
            for (double r : errors[i])
                rootWeights.push_back(std::max(0., 1 - std::pow(r/(TUKEY*scales[i]), 2)));
            problem_.setRootWeights(i, rootWeights);
        }
        if (problem_.pointCount() == 0)     // none has an image, as where given poses are turned round
            checkMajority(0);
        problem_.solve(few);
    }
}

//! From all images; what the parameters absorbed is added.
void RobustFit::estimateScale()
{
    std::vector<double> all, scales;
    for (const RigImage& image : images())
    {
        const std::vector<double> errors = problem_.pixelErrors(image, problem_.pose(image.view));
        scales.push_back(scaleOf(errors));
        all.insert(all.end(), errors.begin(), errors.end());
    }
    const double inflation = std::sqrt(problem_.equationCount()/std::max((double)problem_.freedom(), 1.));
    scale_ = truncatedScale(all, median(scales), 3)*inflation;
}

void RobustFit::leaveOutMovedImages()
{
    for (int i : findMovedImages(problem_, scale_))
        status_[i] = GLASS_IMAGE_MOVED;
}

//! Weights 1 and 0; false if they are as before.
bool RobustFit::chooseInliers()
{
    bool changed = false;
    for (int i = 0; i < (int)images().size(); i++)
    {
        const RigImage& image = images()[i];
        std::vector<double> rootWeights(image.points.pixel.size(), 0.);
        if (status_[i] == GLASS_IMAGE_USED)
        {
            const std::vector<double> errors = problem_.pixelErrors(image, problem_.pose(image.view));
            for (size_t k = 0; k < errors.size(); k++)
                rootWeights[k] = errors[k] < CUT*scale_;
            const double kept = (double)std::count(rootWeights.begin(), rootWeights.end(), 1.);
            if (kept < LEAST_AGREEING*(double)errors.size())
            {
                status_[i] = GLASS_IMAGE_UNUSABLE;
                std::fill(rootWeights.begin(), rootWeights.end(), 0.);
            }
        }
        changed = changed || rootWeights != image.rootWeights;
        problem_.setRootWeights(i, rootWeights);
    }
    return changed;
}

void RobustFit::checkMajority(int count) const
{
    if (2*count < seenCount_)
        CV_Error_(Error::StsNoConv, ("only %d of %d points fit; are the target's size, its square and the order of its points "
                                     "right, and the poses, if they were given (target to camera 1)?", count, seenCount_));
}

bool RobustFit::decide()
{
    const int ROUNDS = 10;
    bool converged = false;
    for (int round = 0; round < ROUNDS && chooseInliers(); round++)
    {
        checkMajority(problem_.pointCount());
        converged = problem_.solve(criteria_);
        if (problem_.freedom() > 0)
            scale_ = std::max(std::sqrt(problem_.squaredError()/(problem_.freedom()*truncationFactor(CUT))), LEAST_SCALE);
    }
    return converged;
}

} // namespace

RobustOutcome solveRobustly(RigProblem& rig, int seenCount, const TermCriteria& criteria)
{
    return RobustFit(rig, seenCount, criteria).run();
}

RigViews agreeingViews(const Rig& rig, const RigViews& views)
{
    RigViews agreeing = views;
    for (int c = 0; c < rig.count(); c++)
    {
        const Camera bare = withWindow(rig.cameras[c]);
        for (int view = 0; view < views.count(); view++)
        {
            CameraViews& seen = agreeing.cameras[c];
            seen.direct[view] = pointsOfOnePose(bare, views.object[view], seen.direct[view]);
            seen.refracted[view] = pointsOfOnePose(rig.cameras[c], views.object[view], seen.refracted[view]);
        }
    }
    return agreeing;
}

}} // namespace
