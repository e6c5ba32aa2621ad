// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The joint fit where some points and some images are wrong.

1. Start: poses of random samples drop what is grossly wrong (agreeingViews).
2. Graduated: every point is weighed by Tukey's biweight with each image's own scale, the median of its errors, so that an
   image keeps its points while the window is still wrong; the scales fall as the fit improves. An image far worse than
   the others of its kind has no say.
3. Images: the view's one pose against a pose of its own for each image. The gain in squared errors is chi^2 with 6 degrees
   of freedom per further image where nothing moved. Views are judged against the median view as well, as a wrong
   constant (thickness, index) moves all of them.
4. Points: a hard decision at the 1 - 1e-4 quantile of the errors' Rayleigh distribution, repeated with its scale until the
   same points stay. So clean data lose nothing, and what remains is weighed by maximum likelihood. */

#include "rig_robust.hpp"
#include <numeric>

namespace cv { namespace refract {

namespace {

const double MEDIAN_OF_RAYLEIGH = 1.17741, TUKEY = 4.685;
const double CHANCE = 1e-4;         // that a good point, or view, is left out
const double CUT = std::sqrt(-2*std::log(CHANCE));      // that quantile of the Rayleigh distribution
const double LEAST_SCALE = 1e-7;    // pixels: errors of perfect data are rounding

double median(std::vector<double> values)
{
    if (values.empty())
        return 0;
    std::nth_element(values.begin(), values.begin() + values.size()/2, values.end());
    return values[values.size()/2];
}

//! Standard deviation of a coordinate that the median of the errors' lengths tells.
double scaleOf(const std::vector<double>& errors)
{
    return std::max(median(errors)/MEDIAN_OF_RAYLEIGH, LEAST_SCALE);
}

/** Standard deviation of a coordinate from errors (lengths) that were cut off at `cut` standard deviations. With
x = cut^2/2, the mean of r^2/(2 sigma^2) below the cut is 1 - x/(e^x - 1). */
double truncationFactor(double cut)
{
    const double x = cut*cut/2;
    return 1 - x/(std::exp(x) - 1);
}

double truncatedScale(const std::vector<double>& errors, double scale, double cut)
{
    for (int i = 0; i < 50; i++)
    {
        double sum = 0;
        int count = 0;
        for (double r : errors)
            if (r < cut*scale)
            {
                sum += r*r;
                count++;
            }
        if (count == 0)
            return scale;
        const double next = std::max(std::sqrt(sum/(2*count*truncationFactor(cut))), LEAST_SCALE);
        if (std::abs(next - scale) < 1e-6*scale)
            return next;
        scale = next;
    }
    return scale;
}

//! Quantile of chi^2 (Wilson and Hilferty).
double chiSquareQuantile(double normalQuantile, int freedom)
{
    const double a = 2./(9*freedom);
    return freedom*std::pow(1 - a + normalQuantile*std::sqrt(a), 3);
}

class RobustFit
{
public:
    RobustFit(RigProblem& rig, int seenCount, const TermCriteria& criteria)
        : rig_(rig), seenCount_(seenCount), criteria_(criteria),
          status_(rig.images().size(), (uchar)GLASS_IMAGE_USED), scale_(0) {}

    RobustOutcome run()
    {
        int inImages = 0;
        for (const RigImage& image : images())
            inImages += (int)image.points.pixel.size();
        checkMajority(inImages);
        graduate();
        estimateScale();
        dropMovedImages();
        RobustOutcome outcome;
        outcome.converged = decide();
        outcome.varianceFactor = 1/truncationFactor(CUT);
        outcome.imageStatus = status_;
        return outcome;
    }

private:
    const std::vector<RigImage>& images() const { return rig_.images(); }

    std::vector<double> imageScales(const std::vector<std::vector<double> >& errors) const;
    void graduate();
    void estimateScale();
    void dropMovedImages();
    bool decide();
    bool chooseInliers();

    void checkMajority(int count) const;
    double cutSum(const std::vector<double>& errors) const;
    double gainOfOwnPoses(const Rig& rig, const std::vector<int>& ofView, std::vector<Pose>& own) const;
    void dropMinority(const std::vector<int>& ofView, const std::vector<Pose>& own);
    int agreement(const std::vector<int>& ofView, const Pose& pose, std::vector<bool>& agrees) const;

    RigProblem& rig_;
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
    const TermCriteria few(TermCriteria::COUNT, 5, 0);
    double last = std::numeric_limits<double>::infinity();
    for (int round = 0; round < ROUNDS; round++)
    {
        std::vector<std::vector<double> > errors;
        for (const RigImage& image : images())
            errors.push_back(rig_.pixelErrors(image, rig_.pose(image.view)));
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
            rig_.setRootWeights(i, rootWeights);
        }
        rig_.solve(few);
    }
}

//! From all images; what the parameters absorbed is added.
void RobustFit::estimateScale()
{
    std::vector<double> all, scales;
    for (const RigImage& image : images())
    {
        const std::vector<double> errors = rig_.pixelErrors(image, rig_.pose(image.view));
        scales.push_back(scaleOf(errors));
        all.insert(all.end(), errors.begin(), errors.end());
    }
    const double inflation = std::sqrt(rig_.equationCount()/std::max((double)rig_.freedom(), 1.));
    scale_ = truncatedScale(all, median(scales), 3)*inflation;
}

//! Sum of squares, each cut off.
double RobustFit::cutSum(const std::vector<double>& errors) const
{
    double sum = 0;
    for (double r : errors)
        sum += std::pow(std::min(r, CUT*scale_), 2);
    return sum;
}

//! The pose, object -> camera 1, that one image alone tells.
Pose ownPose(const Rig& rig, const RigImage& image)
{
    Camera camera(rig.cameras[image.camera]);
    if (!image.refracted)
        camera.setWindow(GlassWindow());
    double rms;
    const std::vector<Point2d> agreeing = pointsOfOnePose(camera, image.points.object, image.points.pixel);
    const Pose pose = solvePose(camera, image.points.object, agreeing, Pose(), rms);
    return pose.found ? inCamera1(pose, rig.extrinsics[image.camera]) : pose;
}

//! How much smaller the sum of squares of a view is, in variances, if every image has its own pose.
double RobustFit::gainOfOwnPoses(const Rig& rig, const std::vector<int>& ofView, std::vector<Pose>& own) const
{
    double gain = 0;
    for (int i : ofView)
    {
        const RigImage& image = images()[i];
        own.push_back(ownPose(rig, image));
        if (own.back().found)
            gain += cutSum(rig_.pixelErrors(image, rig_.pose(image.view))) - cutSum(rig_.pixelErrors(image, own.back()));
    }
    return gain/(scale_*scale_);
}

void RobustFit::dropMovedImages()
{
    std::vector<std::vector<int> > ofView(rig_.viewCount());
    for (int i = 0; i < (int)images().size(); i++)
        ofView[images()[i].view].push_back(i);
    const Rig rig = rig_.rig();
    std::vector<int> views;
    std::vector<double> gains, perFreedom;
    std::vector<std::vector<Pose> > own;
    for (int view = 0; view < rig_.viewCount(); view++)
    {
        if (ofView[view].size() < 2)
            continue;
        views.push_back(view);
        own.push_back(std::vector<Pose>());
        gains.push_back(gainOfOwnPoses(rig, ofView[view], own.back()));
        perFreedom.push_back(gains.back()/(6*(double)(ofView[view].size() - 1)));
    }
    const size_t FEWEST = 3;        // views, to tell what is usual
    if (views.size() < FEWEST)
        return;
    const double usual = std::max(1., median(perFreedom)), quantile = 4.5;      // of the normal: 3e-6
    for (size_t i = 0; i < views.size(); i++)
        if (gains[i] > usual*chiSquareQuantile(quantile, 6*((int)ofView[views[i]].size() - 1)))
            dropMinority(ofView[views[i]], own[i]);
}

//! How many images of the view the pose of one of them fits, but for what its own uncertainty does.
int RobustFit::agreement(const std::vector<int>& ofView, const Pose& pose, std::vector<bool>& agrees) const
{
    const double LENIENT = 8;
    agrees.clear();
    for (int i : ofView)
        agrees.push_back(pose.found && median(rig_.pixelErrors(images()[i], pose)) < LENIENT*scale_);
    return (int)std::count(agrees.begin(), agrees.end(), true);
}

/** Keeps the largest group of images that agree; of two equal ones that with more images through the window, as only these
tell of it. If no group stands out, the direct images go. */
void RobustFit::dropMinority(const std::vector<int>& ofView, const std::vector<Pose>& own)
{
    std::vector<bool> kept(ofView.size(), true);
    double best = 0;
    for (const Pose& pose : own)
    {
        std::vector<bool> agrees;
        double support = agreement(ofView, pose, agrees);
        for (size_t k = 0; k < ofView.size(); k++)
            support += agrees[k] && images()[ofView[k]].refracted ? 0.01 : 0;
        if (support <= best)
            continue;
        best = support;
        kept = agrees;
        rig_.setPose(images()[ofView[0]].view, pose);
    }
    const bool tellsApart = std::count(kept.begin(), kept.end(), true) < (int)ofView.size();
    for (size_t k = 0; k < ofView.size(); k++)
        if (tellsApart ? !kept[k] : !images()[ofView[k]].refracted)
            status_[ofView[k]] = GLASS_IMAGE_MOVED;
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
            const std::vector<double> errors = rig_.pixelErrors(image, rig_.pose(image.view));
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
        rig_.setRootWeights(i, rootWeights);
    }
    return changed;
}

void RobustFit::checkMajority(int count) const
{
    if (2*count < seenCount_)
        CV_Error_(Error::StsNoConv, ("only %d of %d points fit; are the target's size, its square and the order of its points "
                                     "right?", count, seenCount_));
}

bool RobustFit::decide()
{
    const int ROUNDS = 10;
    bool converged = false;
    for (int round = 0; round < ROUNDS && chooseInliers(); round++)
    {
        checkMajority(rig_.pointCount());
        converged = rig_.solve(criteria_);
        if (rig_.freedom() > 0)
            scale_ = std::max(std::sqrt(rig_.squaredError()/(rig_.freedom()*truncationFactor(CUT))), LEAST_SCALE);
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
        Camera bare(rig.cameras[c]);
        bare.setWindow(GlassWindow());
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
