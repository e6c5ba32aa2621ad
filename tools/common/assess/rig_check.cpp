// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/rig_check.hpp"
#include "assess/check_level.hpp"
#include "assess/check_problem.hpp"
#include "measure/image_noise.hpp"
#include "assess/swapped_images.hpp"
#include "calibrate/parameter_columns.hpp"
#include "measure/f_distribution.hpp"
#include "diagnose/ranking.hpp"
#include "console/failure.hpp"
#include "math/dense.hpp"
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double DEGREES = 180./CV_PI;
const double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN(), NO_FIT = std::numeric_limits<double>::infinity();
// Of probabilities: images noisier than those of the calibration; residuals that no single change explains.
const double NOISIER = 1e-4, UNEXPLAINED = 1e-4;
const double SHARE_OF_RESIDUALS = 0.01;         // of the false alarms: the test of all residuals, whatever caused them
const double TOLD = 0.3;                        // of its range: what is known less well the images do not tell
const double GROSS = 5.;                        // times the noise: images may have been exchanged, turned or mirrored

//! A hypothesis of the table, tested.
struct Tested
{
    const Change* change;
    TestedDirections at;
    double gain, probability;
    CheckFit fit;               //!< chiSquare infinite: none
};

//! One that competes for the name.
struct Candidate
{
    NamedChange named;
    double chiSquare;
    int parameters, observations;
    const Tested* tested;       //!< null: images that are not what they are given for
};

class RigCheck
{
public:
    RigCheck(const CheckInput& input, const std::vector<View>& views, double falseAlarm, const std::string& unit)
        : input_(withWedges(input)), views_(views), falseAlarm_(falseAlarm), unit_(unit)
    {
        requireGlass();
        takeNoise();
        fitUnchanged(std::make_unique<CheckProblem>(input_, views, result_.sigma));
        conclude();
    }

    RigCheck(const CheckInput& input, const ViewObservations& scene, double falseAlarm, const std::string& unit)
        : input_(withWedges(input)), falseAlarm_(falseAlarm), unit_(unit), isScene_(true)
    {
        result_.sigma = input.sigma;
        const int ROUNDS = 2;               // what is known weighs more or less, as the noise is
        for (int round = 0; round <= ROUNDS; round++)
        {
            fitUnchanged(std::make_unique<CheckProblem>(input_, std::vector<ViewObservations>{scene}, result_.sigma));
            if (round < ROUNDS)
                takeNoiseOfScene();
        }
        conclude();
    }

    const CheckResult& result() const { return result_; }

private:
    void fitUnchanged(std::unique_ptr<CheckProblem> problem)
    {
        problem_ = std::move(problem);
        unchanged_ = unchanged_.rows ? problem_->fitUnchanged(unchanged_) : problem_->fitUnchanged();
        changes_ = changesOf(input_.rig, unit_, middleOfPoints());
        if (!std::isfinite(unchanged_.chiSquare))
            return;
        // A scene's points and its noise follow the rig: where that is bent, they are far from straight.
        const bool isBent = isScene_ && isFar();
        if (isBent && !asCalibrated_.rows)
            asCalibrated_ = problem_->asCalibrated();
        information_ = problem_->information(changes_, isBent ? asCalibrated_ : unchanged_);
    }

    //! All else was bent far to explain a large change.
    bool isFar() const
    {
        const double FAR = 5.;          // standard deviations
        return unchanged_.q.squaredNorm() > FAR*FAR*unchanged_.q.size();
    }

    void conclude()
    {
        result_.critical = falseAlarm_;
        if (information_.G.size() > 0)
            testAll();
        decide();
        if (result_.changed)
            name();
        addWindows();
        addTurns();
    }

    void requireGlass() const
    {
        for (const View& view : views_)
            if (view.hasGlass())
                return;
        throw Failure("there is no image through the window to check: give --glass");
    }

    //! Images that are noisier than the calibration's tell less, but nothing of a change.
    void takeNoise()
    {
        const ImageNoise here = imageNoise(input_.rig, views_);
        result_.noiseHere = here.sigma;
        const double ratio = here.dof > 0 ? std::pow(here.sigma/input_.sigma, 2) : 0.;
        const int even = 2*((int)here.dof/2);
        const bool isNoisier = even > 0 && upperTailAnyF(even, input_.dof, ratio) < NOISIER;
        result_.sigma = isNoisier ? here.sigma : input_.sigma;
        result_.dof = isNoisier ? here.dof : input_.dof;
    }

    /* What all changes of the table together leave, as far as the images tell of them: the F test of each has this noise, which none of
    them is in. */
    void takeNoiseOfScene()
    {
        if (information_.G.size() == 0)
            return;
        const double LEFT = 1e-6;       // at least: far from straight, a gain may be more than all
        const SymmetricEigen eigen(information_.G);
        const VectorXd along = transposeTimesVector(eigen.vectors, information_.score);
        double gain = 0.;
        int told = 0;
        for (Eigen::Index i = 0; i < along.size(); i++)
            if (eigen.values[i] > 1./(TOLD*TOLD))
            {
                gain += along[i]*along[i]/eigen.values[i];
                told++;
            }
        result_.dof = problem_->observations() - told;
        if (!(result_.dof > 0.))
            throw Failure(format("%d matches are too few to tell %d numbers of what may have changed", problem_->observations(), told));
        const double left = std::max(information_.chiSquare - gain, LEFT*information_.chiSquare);
        result_.sigma *= std::sqrt(left/result_.dof);
        result_.noiseHere = result_.sigma;
    }

    Vec3d middleOfPoints() const
    {
        Vec3d sum;
        int count = 0;
        for (const ViewObservations& view : unchanged_.views)
            for (const Point3d& X : view.objectPoints)
            {
                sum += rotationMatrix(view.rvec)*Vec3d(X) + view.tvec;
                count++;
            }
        return sum/(double)std::max(1, count);
    }

    void testAll()
    {
        std::vector<TestedDirections> all;
        int first = 0;
        for (const Change& change : changes_)
        {
            const TestedDirections at{first, toldDirections(first, change.size())};
            first += change.size();
            if (!at.count())
                continue;
            const double gain = gainOf(at, information_.G, information_.score);
            tested_.push_back({&change, at, gain, probabilityOf(gain, at.count(), result_.dof), {}});
            tested_.back().fit.chiSquare = NO_FIT;
            all.push_back(at);
        }
        addCharted();
        result_.critical = criticalProbability(all, information_.G, result_.dof, (1. - SHARE_OF_RESIDUALS)*falseAlarm_);
    }

    void addCharted()
    {
        std::vector<int> rows;
        std::vector<double> ranges;
        ChartedScore& charted = result_.charted;
        // About the calibrated values: what a large change makes of the others is far from linear.
        if (!asCalibrated_.rows)
            asCalibrated_ = problem_->asCalibrated();
        const CheckProblem::Information information = problem_->information(changes_, asCalibrated_);
        if (information.G.size() == 0)
            return;
        for (const Tested& tested : tested_)
        {
            const Change& change = *tested.change;
            if (change.chart.empty() || tested.at.count() < change.size())
                continue;
            charted.changes.push_back(change);
            for (int i = 0; i < change.size(); i++)
            {
                rows.push_back(tested.at.first + i);
                ranges.push_back(change.ranges()[i]);
            }
        }
        const int count = (int)rows.size(), parameters = columnCount(input_.rig);
        charted.score.resize(count);
        charted.information.resize(count, count);
        charted.byParameters.resize(count, parameters);
        for (int i = 0; i < count; i++)
        {
            charted.score[i] = information.score[rows[i]]/ranges[i];
            charted.byParameters.row(i) = information.byParameters.row(rows[i]).head(parameters)/ranges[i];
            for (int j = 0; j < count; j++)
                charted.information(i, j) = information.G(rows[i], rows[j])/(ranges[i]*ranges[j]);
        }
    }

    //! In units of the ranges: eigenvectors whose standard deviation is well within them.
    MatrixXd toldDirections(int first, int size) const
    {
        const SymmetricEigen eigen(information_.G.block(first, first, size, size));
        const Eigen::Index told = (eigen.values.array() > 1./(TOLD*TOLD)).count();
        return eigen.vectors.rightCols(told);
    }

    double probabilityOfResiduals(double chiSquare, int parameters) const
    {
        const int count = problem_->observations() - parameters;
        return std::isfinite(chiSquare) ? upperTailAnyF(count, result_.dof, chiSquare/count) : 0.;
    }

    void decide()
    {
        const double residuals = probabilityOfResiduals(unchanged_.chiSquare, 0);
        result_.sigmaSeen = result_.sigma*std::sqrt(unchanged_.chiSquare/problem_->observations());
        result_.changed = !isScene_ && residuals < SHARE_OF_RESIDUALS*falseAlarm_;
        for (const Tested& tested : tested_)
            result_.changed |= tested.probability < result_.critical;
    }

    void fitOf(Tested& tested)
    {
        if (std::isfinite(tested.fit.chiSquare))
            return;
        const MatrixXd directions = tested.change->ranges().asDiagonal()*tested.at.directions;
        // From where all else was bent far to explain a large change, the way back is long, and may be barred.
        tested.fit = problem_->fit(*tested.change, directions, isFar() ? asCalibrated_ : unchanged_);
        // With more free the best is not worse: else this is another minimum. Of boards, of which images may be exchanged, there are many.
        if (!isFar() || (isScene_ && tested.fit.chiSquare <= unchanged_.chiSquare))
            return;
        const CheckFit other = problem_->fit(*tested.change, directions, unchanged_);
        if (other.chiSquare < tested.fit.chiSquare)
            tested.fit = other;
    }

    //! Each by itself, on all processors.
    void fitThose(const std::function<bool(const Tested&)>& isWanted)
    {
        std::vector<Tested*> those;
        for (Tested& tested : tested_)
            if (isWanted(tested))
                those.push_back(&tested);
        parallel_for_(Range(0, (int)those.size()), [&](const Range& range) {
            for (int i = range.start; i < range.end; i++)
                fitOf(*those[i]); }, (double)those.size());
    }

    void addCandidate(const Tested& tested)
    {
        if (!std::isfinite(tested.fit.chiSquare))
            return;
        const Change& change = *tested.change;
        const std::vector<ChangedValue> values = valuesOf(change, tested.fit.delta, tested.fit.covariance);
        NamedChange named{change.name, sentenceOf(change, values), change.camera, values, tested.probability};
        candidates_.push_back({named, tested.fit.chiSquare, tested.at.count(), problem_->observations(), &tested});
    }

    void addUndone(const std::vector<Undone>& all)
    {
        for (const Undone& undone : all)
        {
            try
            {
                const CheckProblem problem(input_, undone.views, result_.sigma);
                const CheckFit fit = problem.fitUnchanged();
                if (!std::isfinite(fit.chiSquare))
                    continue;
                const int parameters = std::max(1, 6*undone.poses);
                const double probability = probabilityOf(std::max(0., unchanged_.chiSquare - fit.chiSquare), parameters, result_.dof);
                candidates_.push_back({{undone.name, undone.name, undone.camera, {}, probability}, fit.chiSquare, parameters,
                                       problem.observations(), nullptr});
            }
            catch (const Failure&) {}           // no pose
            catch (const cv::Exception&) {}
        }
    }

    double noiseOf(const Candidate& c) const { return c.chiSquare/std::max(1, problem_->observations() - c.parameters); }

    //! One candidate's parameters contain those of another: it is no other explanation.
    bool contains(const Tested& large, const Tested& small) const
    {
        if (large.at.count() <= small.at.count())
            return false;
        const MatrixXd outer = problem_->directionsOf(*large.change), inner = problem_->directionsOf(*small.change);
        const double NOTHING = 1e-4;
        const MatrixXd rest = inner - product(outer, PivotedQR(outer).solve(inner));
        return rest.norm() < NOTHING*inner.norm();
    }

    //! Of two of which one contains the other, the one that has no more parameters than it is worth.
    void dropNested()
    {
        double variance = NO_FIT;
        for (const Candidate& c : candidates_)
            variance = std::min(variance, noiseOf(c));
        variance = std::max(1., variance);
        const double penalty = std::log((double)problem_->observations());
        const auto criterion = [&](const Candidate& c) { return c.chiSquare/variance + penalty*c.parameters; };
        std::vector<Candidate> kept;
        for (const Candidate& large : candidates_)
            if (std::none_of(candidates_.begin(), candidates_.end(), [&](const Candidate& small) {
                    return large.tested && small.tested && criterion(small) <= criterion(large)
                           && contains(*large.tested, *small.tested); }))
                kept.push_back(large);
        candidates_ = kept;
    }

    void name()
    {
        double largest = 0.;
        for (const Tested& tested : tested_)
            largest = std::max(largest, tested.gain);
        // A scene has thousands of points: what gains far less, to first order, is not fitted.
        const double FAR_LESS = 0.5;
        fitThose([&](const Tested& tested) { return !isScene_ || tested.gain > FAR_LESS*largest; });
        for (const Tested& tested : tested_)
            addCandidate(tested);
        addUndone(isScene_ ? std::vector<Undone>() : unrelatedImages(input_.rig, views_));
        // Also where a change explains all: of a camera in the middle of its images, mirrored ones look like a window mirrored.
        if (!isScene_ && !(unchanged_.chiSquare < GROSS*GROSS*problem_->observations()))
            addUndone(swappedImages(input_.rig, views_));
        dropNested();
        rankThem();
    }

    void rankThem()
    {
        const double pixels2 = result_.sigma*result_.sigma;
        std::vector<Hypothesis> tried;
        for (size_t i = 0; i < candidates_.size(); i++)
            tried.push_back({std::to_string(i), pixels2*candidates_[i].chiSquare, candidates_[i].parameters});
        const double asGiven = std::isfinite(unchanged_.chiSquare) ? pixels2*unchanged_.chiSquare : NO_FIT;
        std::vector<Hypothesis> ranked = rank({"", asGiven, 0}, tried, problem_->observations(), result_.sigma);
        if (ranked.empty())                     // too small a change to tell
            ranked = rank({"", NO_FIT, 0}, tried, problem_->observations(), result_.sigma);
        for (const Hypothesis& h : ranked)
            named_.push_back(candidates_[std::stoul(h.sentence)]);
        const auto isExplained = [this](const Candidate& c) { return probabilityOfResiduals(c.chiSquare, c.parameters) > UNEXPLAINED; };
        result_.isMixup = !named_.empty() && !named_[0].tested;
        result_.explained = !named_.empty() && isExplained(named_[0]);
        // Of a large contradiction a small share is much: where one explains it all, what the noise refutes is no other explanation.
        if (result_.explained)
            named_.erase(std::remove_if(named_.begin(), named_.end(), [&](const Candidate& c) { return !isExplained(c); }), named_.end());
        tellWhatCanHappenFirst();
        std::vector<NamedChange>& changes = result_.changes;
        for (const Candidate& c : named_)           // a board that looks the same turned by half can be numbered in two ways
            if (std::none_of(changes.begin(), changes.end(), [&](const NamedChange& n) { return n.sentence == c.named.sentence; }))
                changes.push_back(c.named);
        if (named_.empty())
            return;
        result_.sigmaSeen = result_.sigma*std::sqrt(named_[0].chiSquare/(problem_->observations() - named_[0].parameters));
    }

    /* What explains as much is told in the order of what can happen. Nobody said that the pane is another. And of a scene: a camera turns
    in its mount before a window moves, and both before a sensor does in its camera, which a scene hardly tells from a turn. About the base
    line a turn of one of two cameras is one of the other: both are told first. */
    void tellWhatCanHappenFirst()
    {
        const auto end = std::stable_partition(named_.begin(), named_.end(), [](const Candidate& c) {
            return !c.tested || !c.tested->change->isOfAnotherPane; });
        if (!isScene_ || end == named_.begin())
            return;
        const double AS_LIKELY = 10., best = named_[0].chiSquare;       // difference of two chi^2
        const auto less = std::stable_partition(named_.begin(), end, [=](const Candidate& c) { return c.chiSquare < best + AS_LIKELY; });
        std::stable_sort(named_.begin(), less, [](const Candidate& a, const Candidate& b) {
            return a.tested->change->ease < b.tested->change->ease; });
        for (auto c = named_.begin(); c != less && c->tested->change->isTurn(); ++c)
            result_.mayHaveTurned.push_back(c->tested->change->turnedCamera());
    }

    bool isNamed(const Tested& tested) const
    {
        return std::any_of(named_.begin(), named_.end(), [&](const Candidate& c) { return c.tested == &tested; });
    }

    void addWindows()
    {
        const auto isTold = [](const Tested& t) {
            return (t.change->isTilt || t.change->isShift) && t.at.count() == t.change->size(); };
        fitThose(isTold);
        for (const Tested& tested : tested_)
            if (isTold(tested))
                result_.windows.push_back(windowOf(tested));
    }

    //! The covariance of the linear test, which holds whatever was found.
    MatrixXd covarianceOf(const Tested& tested) const
    {
        const MatrixXd ranges = tested.change->ranges().asDiagonal();
        const int n = tested.at.count();
        return product(product(ranges, inverse(information_.G.block(tested.at.first, tested.at.first, n, n))), ranges);
    }

    void addTurns()
    {
        for (const Tested& tested : tested_)
        {
            const Change& change = *tested.change;
            if (!change.isTurn() || tested.at.count() < change.size())
                continue;
            const double variance = SymmetricEigen(covarianceOf(tested)).values.maxCoeff();
            result_.turns.push_back({change.name, change.camera, std::sqrt(variance)*DEGREES, tested.at.count(), tested.probability});
        }
    }

    WindowCheck windowOf(const Tested& tested) const
    {
        const int c = tested.change->camera;
        const bool isSeen = !result_.changed || isNamed(tested);
        WindowCheck check;
        check.camera = c;
        check.probability = tested.probability;
        check.moved = result_.changed && isNamed(tested);
        check.tiltDeg = NOT_KNOWN;
        const GlassWindow window = input_.rig.cameras[c]->window();
        check.normal = window.normal;
        check.center = window.center;
        check.parameters = tested.at.count();
        check.lengthPerDegree = tested.change->isShift ? window.radius/DEGREES : 0.;
        check.chart = tested.change->chart;
        const double degrees = tested.change->isShift ? DEGREES/window.radius : DEGREES;
        const int n = check.parameters;
        const VectorXd variances = SymmetricEigen(covarianceOf(tested)).values;
        check.stdDeg[0] = std::sqrt(variances[n - 1])*degrees;
        check.stdDeg[1] = std::sqrt(variances[n - 2])*degrees;
        if (!isSeen || !std::isfinite(tested.fit.chiSquare))
            return check;
        check.normal = tested.fit.rig.cameras[c]->window().normal;
        check.center = tested.fit.rig.cameras[c]->window().center;
        check.tiltDeg = tested.change->isShift ? tested.fit.delta.norm()*degrees : std::atan(tested.fit.delta.norm())*DEGREES;
        return check;
    }

    CheckInput input_;
    const std::vector<View> views_ = {};        // of boards
    const double falseAlarm_;
    const std::string unit_;
    const bool isScene_ = false;
    CheckResult result_;
    std::unique_ptr<CheckProblem> problem_;
    CheckFit unchanged_, asCalibrated_;
    std::vector<Change> changes_;
    CheckProblem::Information information_;
    std::vector<Tested> tested_;
    std::vector<Candidate> candidates_, named_;
};

} // namespace

CheckResult checkRig(const CheckInput& input, const std::vector<View>& views, double falseAlarm, const std::string& unit)
{
    return RigCheck(input, views, falseAlarm, unit).result();
}

CheckResult checkScene(const CheckInput& input, const ViewObservations& scene, double falseAlarm, const std::string& unit)
{
    return RigCheck(input, scene, falseAlarm, unit).result();
}

std::string causesIn(const CheckResult& result)
{
    const size_t MOST = 3;
    std::string text;
    if (result.mayHaveTurned.size() > 1)
    {
        std::vector<int> cameras = result.mayHaveTurned;
        std::sort(cameras.begin(), cameras.end());
        for (int camera : cameras)
            text += (text.empty() ? "" : " or ") + cv::format("camera %d", camera + 1);
        text += " turned, and these images do not tell which: ";
    }
    for (size_t i = 0; i < std::min(MOST, result.changes.size()); i++)
        text += (i ? "; or " : "") + result.changes[i].sentence;
    if (result.changes.size() > MOST)
        text += cv::format("; or one of %zu others", result.changes.size() - MOST);
    return text;
}

std::string causesOf(const Calibration& calibration, const std::vector<View>& views, double pixelSigma)
{
    const size_t MOST = 6;
    const double FALSE_ALARM = 1e-4;
    std::vector<View> some;
    for (size_t i = 0; i < std::min(MOST, views.size()); i++)
        some.push_back(views[i*views.size()/std::min(MOST, views.size())]);
    try
    {
        return causesIn(checkRig(checkInputOf(calibration, "", pixelSigma), some, FALSE_ALARM, calibration.unit));
    }
    catch (const Failure&)          // no pose, no noise
    {
        return "";
    }
}

static double powerOf(double degrees, double variance, int parameters, const CheckResult& result)
{
    return upperTailNoncentralF(parameters, result.dof, degrees*degrees/variance, quantileF(parameters, result.dof, result.critical));
}

double powerOf(const WindowCheck& window, const CheckResult& result, double tiltDeg, double share)
{
    return powerOf(tiltDeg, share*window.stdDeg[0]*window.stdDeg[0], window.parameters, result);
}

double powerOf(const TurnCheck& turn, const CheckResult& result, double turnDeg, double share)
{
    return powerOf(turnDeg, share*turn.stdDeg*turn.stdDeg, turn.parameters, result);
}

} // namespace tools
