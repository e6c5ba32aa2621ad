// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* How many coefficients of a lens the images can carry. The candidates are nested; each is fitted from the one before it and judged by
its errors on parts of the observations that are held out in turn (adjust/held_out.hpp). More coefficients always fit better what
they are fitted to; held out they are worse from the number on that the data do not determine.

The best of them is chosen. The simplest that is not proven to be worse (by one standard error, as Breiman et al., Classification and
Regression Trees, 1984, prune) would fit about as well, but what it leaves out is then in the images, and in no standard deviation. It is
chosen where parts of targets are held out: these are seen with what is around them, and do not tell what a lens does farther out. The step
to a rational lens, which bends without limit what no image shows, has to be proven, too. What one of its coefficients leaves out another
takes up, nearly, and at other depths not: of rational lenses the richest is chosen that is not proven to be worse. */

#include "adjust/covariance.hpp"
#include "adjust/held_out.hpp"
#include "adjust/minimize.hpp"
#include "arrays/arrays.hpp"
#include "calibrate/fit_arguments.hpp"
#include "calibrate/failure.hpp"
#include "calibrate/left_out_lens.hpp"
#include "calibrate/lens_candidate.hpp"
#include "calibrate/near_task.hpp"
#include "calibrate/rig_fit.hpp"
#include "math/robust_scale.hpp"
#include "start/inliers.hpp"

namespace cv { namespace refract {

namespace {

const double MOST_ABOVE_BEST = 1.02;    // held-out RMS of what is chosen by parts of targets
const int START_POINTS = 150;           // of a target, to find where windows and cameras are
const int ROUNDS = 3;                   // of leaving outliers out
const double OUTLIER = 5;               // in standard deviations

const int FIRST = 2;                    // the search for windows and cameras begins with k1 and k2

//! Some points of large targets, evenly.
RigViews sampled(const RigViews& views)
{
    const double NaN = std::numeric_limits<double>::quiet_NaN();
    const Point2d notSeen(NaN, NaN);
    RigViews some = views;
    for (int view = 0; view < views.count(); view++)
    {
        const int count = (int)views.object[view].size(), step = (count + START_POINTS - 1)/START_POINTS;
        for (CameraViews& camera : some.cameras)
            for (std::vector<Point2d>* pixels : { &camera.direct[view], &camera.refracted[view] })
                for (int i = 0; i < (int)pixels->size(); i++)
                    if (i % step)
                        (*pixels)[i] = notSeen;
    }
    return some;
}

class LensSelection
{
public:
    LensSelection(const Rig& given, const RigTask& task, bool isRobust)
        : given_(given), task_(task), isRobust_(isRobust), candidates_(candidatesOf(given, task.flags))
    {}

    FitOutcome run()
    {
        const size_t first = std::min<size_t>(FIRST, candidates_.size() - 1);
        RigStart start;
        FitOutcome outcome = startOf(candidates_[first], start);
        if (!outcome.converged())
            return outcome;
        outcome = fitAll(start, first);
        for (int round = 0; round < ROUNDS && isRobust_ && outcome.converged(); round++)
            if (leaveOutliersOut())
                outcome = fitAll(RigStart(candidates_[first].fitted), first);
        if (!outcome.converged())
            return outcome;
        return choice().determined;
    }
    const std::vector<LensCandidate>& candidates() const { return candidates_; }
    const LensCandidate& choice() const
    {
        const LensCandidate* const polynomial = least(false), * const rational = least(true);
        if (!polynomial || (rational && isWorse(*polynomial, *rational)))
            return richest(*rational);
        return tellsBeyond() ? *polynomial : simplest(*polynomial);
    }

    //! Of each camera; see selectLensCoefficients.
    std::vector<Mat> priorsOfLeftOut() const
    {
        const LensCandidate& choice = this->choice(), * widest = &choice;
        for (const LensCandidate& c : candidates_)
            if (c.coefficients > choice.coefficients && (!c.isRational || widest == &choice))
                widest = &c;
        Problem problem(choice.fitted.rig, task_.views, choice.fitted.poses, std::vector<PosePrior>(), std::vector<CameraPrior>(),
                        flagsOf(*widest));
        weigh(problem);
        std::vector<std::vector<bool> > isLeftOut;
        for (const Camera& camera : given_.cameras)
        {
            isLeftOut.push_back(freeLens(camera, flagsOf(*widest)));
            const std::vector<bool> isChosen = freeLens(camera, flagsOf(choice));
            for (size_t i = 0; i < isChosen.size(); i++)
                isLeftOut.back()[i] = isLeftOut.back()[i] && !isChosen[i];
        }
        return cv::refract::priorsOfLeftOut(problem, isLeftOut);
    }

private:
    //! What parts of one target tell of a lens is not held out of where there was no part.
    bool tellsBeyond() const { return task_.views.count() >= MIN_HELD_OUT_VIEWS; }

    //! Nothing if none was fitted.
    const LensCandidate* least(bool isRational) const
    {
        const LensCandidate* least = nullptr;
        for (const LensCandidate& c : candidates_)
            if (c.isFitted && c.isRational == isRational && (!least || c.squares < least->squares - unseen(c)))
                least = &c;
        return least;
    }
    const LensCandidate& richest(const LensCandidate& rational) const
    {
        const int PRISM = GLASS_FIX_TAUX_TAUY | GLASS_FIX_S1_S2_S3_S4;
        const auto isAsGood = [&](const LensCandidate& c)
        {
            const bool isOfK6 = c.isRational && (c.flags & PRISM) == PRISM;
            return isOfK6 && c.isFitted && c.isConverged && c.determined.converged() && !isWorse(c, rational);
        };
        const auto found = std::find_if(candidates_.rbegin(), candidates_.rend(), isAsGood);
        return found != candidates_.rend() && found->coefficients > rational.coefficients ? *found : rational;
    }
    const LensCandidate& simplest(const LensCandidate& polynomial) const
    {
        const double most = std::pow(MOST_ABOVE_BEST, 2)*polynomial.squares + unseen(polynomial);
        const LensCandidate& enough = *std::find_if(candidates_.begin(), candidates_.end(), [&](const LensCandidate& c)
                                                { return c.isFitted && !c.isRational && !isWorse(c, polynomial) && c.squares <= most; });
        // One that is simpler may miss that by a hair and be better.
        return *std::find_if(candidates_.begin(), candidates_.end(), [&](const LensCandidate& c)
                             { return c.isFitted && !c.isRational && c.squares <= enough.squares; });
    }

    int flagsOf(const LensCandidate& candidate) const
    {
        return task_.flags | candidate.flags | (hasWindow() ? 0 : GLASS_FIX_NORMAL);
    }

    FitOutcome startOf(const LensCandidate& candidate, RigStart& start)
    {
        RigTask task = task_;
        task.flags |= candidate.flags;
        if (!hasWindow())
        {
            const RigViews views = isRobust_ ? inlierViews(given_, task.views, task.flags) : task.views;
            start = { given_, posesWithoutWindow(given_, views, task.knownPoses) };
            if (isRobust_)
                dropUnusable(start.poses);
            return checkPoses(task_.views, start.poses);
        }
        task.views = sampled(task_.views);
        std::vector<OtherMinimum> minima;
        return findStart(given_, task, start, minima);
    }

    //! Views that outliers give no pose, or one with points behind the camera.
    void dropUnusable(const std::vector<Pose>& poses)
    {
        const Problem problem(given_, task_.views, poses, std::vector<PosePrior>(), std::vector<CameraPrior>(),
                              task_.flags | GLASS_FIX_NORMAL);
        for (const Image& image : problem.images())
        {
            const std::vector<double> errors = problem.pixelErrors(image);
            if (!poses[image.view].found || !std::all_of(errors.begin(), errors.end(), [](double e) { return std::isfinite(e); }))
                task_.views.cameras[image.camera].direct[image.view].clear();
        }
    }

    bool hasWindow() const
    {
        return std::any_of(task_.views.cameras.begin(), task_.views.cameras.end(),
                           [](const CameraViews& camera) { return seesAnything(camera.refracted); });
    }

    //! Whether images without windows tell all lenses, and nothing but these is asked for.
    bool isOfDirectImages() const
    {
        const int OF_WINDOWS = GLASS_FREE_THICKNESS | GLASS_FREE_INDEX | GLASS_FREE_DISTANCE | GLASS_FREE_OUTER_INDEX | GLASS_FREE_WEDGE |
            GLASS_FREE_RADIUS | GLASS_FREE_CURVATURE;
        return !hasWindow() && !(task_.flags & (OF_WINDOWS | GLASS_FREE_EXTRINSICS)) &&
               std::all_of(task_.views.cameras.begin(), task_.views.cameras.end(),
                           [](const CameraViews& camera) { return seesAnything(camera.direct); });
    }

    //! Down from the first to the simplest, up to the richest, each from its neighbour.
    FitOutcome fitAll(const RigStart& start, size_t first)
    {
        FitOutcome outcome = fit(candidates_[first], start);
        if (!outcome.isUsable())
            return outcome;
        RigStart from = candidates_[first].fitted;
        for (size_t i = first; i-- > 0;)
            if (fit(candidates_[i], from).converged())
                from = candidates_[i].fitted;
        from = candidates_[first].fitted;
        for (size_t i = first + 1; i < candidates_.size(); i++)
            if (fit(candidates_[i], from).converged())
                from = candidates_[i].fitted;
        if (std::any_of(candidates_.begin(), candidates_.end(), [](const LensCandidate& c) { return c.isFitted; }))
            return FitOutcome();
        return outcome.converged() ? notHeldOut() : outcome;
    }

    static FitOutcome notHeldOut()
    {
        const double NaN = std::numeric_limits<double>::quiet_NaN();
        FitOutcome outcome(FitOutcome::UNDETERMINED);
        outcome.parameters = { { "a lens when one of them is left out", NaN, NaN } };
        outcome.dimension = 1;
        return outcome;
    }

    FitOutcome fit(LensCandidate& candidate, const RigStart& from)
    {
        const TermCriteria criteria(TermCriteria::COUNT + TermCriteria::EPS, 200, 1e-9);
        const int flags = flagsOf(candidate);
        RigStart start = from;
        for (int c = 0; c < start.rig.count(); c++)
        {
            const std::vector<bool> isFree = freeLens(given_.cameras[c], flags);
            const std::vector<bool> mayBeFree = freeLens(given_.cameras[c], task_.flags);
            std::vector<double> lens = start.rig.cameras[c].lens().parameters();
            for (size_t i = 0; i < lens.size(); i++)
                if (mayBeFree[i] && !isFree[i])
                    lens[i] = 0;
            start.rig.cameras[c].setLensParameters(Mat(lens));
        }
        Problem problem(start.rig, task_.views, start.poses, std::vector<PosePrior>(), std::vector<CameraPrior>(), flags);
        weigh(problem);
        FitOutcome outcome = checkFreedom(problem);
        if (outcome.converged())
            outcome = minimize(problem, criteria);
        candidate.isFitted = false;
        candidate.isConverged = outcome.converged();
        if (!outcome.isUsable())
            return outcome;
        candidate.fitted = { problem.rig(), problem.poses() };
        candidate.parts = heldOutErrors(problem);
        candidate.squares = 0;
        for (const HeldOutPart& part : candidate.parts)
            candidate.squares += part.squares;
        candidate.isFitted = std::isfinite(candidate.squares);
        if (isOfDirectImages())         // else what is known of windows and places has a say, in the calibration
            candidate.determined = Covariance().compute(problem, problem.squaredError()/problem.freedom(), GLASS_REQUIRE_INTRINSICS);
        candidate.errors.clear();
        for (const Image& image : problem.images())
            candidate.errors.push_back(problem.pixelErrors(image));
        return outcome;
    }

    void weigh(Problem& problem) const
    {
        for (size_t i = 0; i < weights_.size(); i++)
            problem.setRootWeights((int)i, weights_[i]);
    }

    //! Of the richest lens that was fitted. False: there are no more.
    bool leaveOutliersOut()
    {
        const auto richest = std::find_if(candidates_.rbegin(), candidates_.rend(), [](const LensCandidate& c) { return c.isFitted; });
        const std::vector<std::vector<double> >& errors = richest->errors;
        std::vector<double> all;
        for (const std::vector<double>& image : errors)
            for (double error : image)
                if (std::isfinite(error))
                    all.push_back(error);
        const double sigma = median(all)/std::sqrt(2*std::log(2.));
        std::vector<std::vector<double> > weights;
        for (const std::vector<double>& image : errors)
        {
            weights.push_back(std::vector<double>());
            for (double error : image)
                weights.back().push_back(error <= OUTLIER*sigma ? 1 : 0);
        }
        const bool changed = weights != weights_;
        weights_ = weights;
        return changed;
    }

    const Rig& given_;
    RigTask task_;
    const bool isRobust_;
    std::vector<LensCandidate> candidates_;
    std::vector<std::vector<double> > weights_;
};

Mat scoresOf(const std::vector<LensCandidate>& candidates)
{
    const auto best = std::min_element(candidates.begin(), candidates.end(), [](const LensCandidate& a, const LensCandidate& b)
                                       { return a.isFitted && (!b.isFitted || a.squares < b.squares); });
    Mat_<double> scores((int)candidates.size(), 4, std::numeric_limits<double>::quiet_NaN());
    for (int i = 0; i < scores.rows; i++)
    {
        const LensCandidate& c = candidates[i];
        scores(i, 0) = c.flags;
        scores(i, 1) = c.coefficients;
        if (!c.isFitted)
            continue;
        const double points = pointsOf(c.parts);
        scores(i, 2) = std::sqrt(c.squares/points);
        scores(i, 3) = standardError(c, *best)/points/(2*std::max(scores(i, 2), DBL_MIN));
    }
    return scores;
}

} // namespace

int selectLensCoefficients(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
                           const std::vector<std::vector<Mat> >& imagePointsRefracted,
                           const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
                           InputArrayOfArrays Rs, InputArrayOfArrays Ts, int flags, OutputArray scores)
{
    return selectLensCoefficients(objectPoints, imagePointsDirect, imagePointsRefracted, cameras, windowOfCamera, Rs, Ts, flags, scores,
                                  noArray());
}

int selectLensCoefficients(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
                           const std::vector<std::vector<Mat> >& imagePointsRefracted,
                           const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
                           InputArrayOfArrays Rs, InputArrayOfArrays Ts, int flags, OutputArray scores,
                           OutputArrayOfArrays lensCovariances)
{
    CV_INSTRUMENT_REGION();

    checkFlags(flags, MONO_FLAGS | GLASS_FREE_EXTRINSICS | GLASS_FIX_NORMAL);
    const int count = (int)cameras.size();
    std::vector<String> names, refractedNames;
    for (int c = 0; c < count; c++)
    {
        names.push_back(numbered("cameras", c));
        refractedNames.push_back(numbered("imagePointsRefracted", c));
    }
    RigTask task;
    task.views = readRigViews(objectPoints, imagePointsDirect, imagePointsRefracted, count);
    checkCount(windowOfCamera.size(), count, "windowOfCamera", true);
    task.flags = (flags & ~GLASS_ROBUST) | GLASS_FREE_INTRINSICS;
    task.criteria = TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 1000, 1e-12);
    Rig rig;
    rig.cameras = camerasOf(cameras, names);
    addParameters(rig.cameras, flags);
    setOwners(rig, windowOfCamera);
    if (!imagePointsRefracted.empty())
        checkWindows(rig, task.views, flags, refractedNames);
    const bool placesFollow = task.isIncremental(rig) && Rs.empty() && Ts.empty();
    rig.extrinsics = placesFollow ? std::vector<Pose>(count) : readExtrinsicPoses(Rs, Ts, count);

    std::vector<int> seen;
    const NearTask moved(task);
    LensSelection selection(rig, onlySeen(moved.task(), seen), (flags & GLASS_ROBUST) != 0);
    FitOutcome outcome = selection.run();
    if (outcome.view >= 0)
        outcome.view = seen[outcome.view];
    moved.moveBack(outcome);
    throwUnlessConverged(outcome, FitKind::CALIBRATION);
    const LensCandidate& chosen = selection.choice();
    for (int c = 0; c < count; c++)         // the windows stay as they were given
        cameraOf(cameras[c]).setLensParameters(chosen.fitted.rig.cameras[c].lensParameters());
    writeMat(scoresOf(selection.candidates()), scores);
    if (lensCovariances.needed())
        writeMatrices(selection.priorsOfLeftOut(), lensCovariances);
    return chosen.flags;
}

}} // namespace
