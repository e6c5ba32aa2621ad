// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/rig_check.hpp"
#include "assess/change_naming.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/failure.hpp"
#include "console/progress.hpp"
#include "console/table.hpp"
#include "math/dense.hpp"
#include "measure/distributions.hpp"
#include "measure/view_observations.hpp"
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
const double NOISIER = 1e-4;                    // probability of images noisier than those of the calibration
const double SHARE_OF_RESIDUALS = 0.01;         // of the false alarms: the test of all residuals, whatever caused them
const double TOLD = 0.3;                        // of its range: what is known less well the images do not tell
const double GROSS = 5.;                        // times the noise: images may have been exchanged, turned or mirrored

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
            fitAndName();
        addWindows();
        addTurns();
        if (!isScene_ && asCalibrated_.rows)
            result_.unseen = unseenErrors(input_, *problem_, asCalibrated_, result_.dof, result_.critical, CERTAIN_POWER);
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

    //! About the calibrated values: what a large change makes of the others is far from linear.
    void addCharted()
    {
        if (!asCalibrated_.rows)
            asCalibrated_ = problem_->asCalibrated();
        const CheckProblem::Information information = problem_->information(changes_, asCalibrated_);
        if (information.G.size() > 0)
            result_.charted = chartedScoreOf(tested_, information, columnCount(input_.rig));
    }

    //! In units of the ranges: eigenvectors whose standard deviation is well within them.
    MatrixXd toldDirections(int first, int size) const
    {
        const SymmetricEigen eigen(information_.G.block(first, first, size, size));
        const Eigen::Index told = (eigen.values.array() > 1./(TOLD*TOLD)).count();
        return eigen.vectors.rightCols(told);
    }

    void decide()
    {
        const double residuals = probabilityOfResiduals(*problem_, unchanged_.chiSquare, 0, result_.dof);
        result_.sigmaSeen = result_.sigma*std::sqrt(unchanged_.chiSquare/problem_->observations());
        result_.changed = !isScene_ && residuals < SHARE_OF_RESIDUALS*falseAlarm_;
        for (const TestedChange& tested : tested_)
            result_.changed |= tested.probability < result_.critical;
    }

    void fitOf(TestedChange& tested)
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
    void fitThose(const std::function<bool(const TestedChange&)>& isWanted)
    {
        std::vector<TestedChange*> those;
        for (TestedChange& tested : tested_)
            if (isWanted(tested))
                those.push_back(&tested);
        inParallel((int)those.size(), [&](int i) { fitOf(*those[i]); });
    }

    void fitAndName()
    {
        double largest = 0.;
        for (const TestedChange& tested : tested_)
            largest = std::max(largest, tested.gain);
        // A scene has thousands of points: what gains far less, to first order, is not fitted.
        const double FAR_LESS = 0.5;
        fitThose([&](const TestedChange& tested) { return !isScene_ || tested.gain > FAR_LESS*largest; });
        ChangeNaming naming(*problem_, unchanged_, isScene_, result_);
        for (const TestedChange& tested : tested_)
            naming.add(tested);
        naming.addUndone(input_, imagesWithoutWindows(input_.rig, unchanged_.views));
        naming.addUndone(input_, isScene_ ? std::vector<Undone>() : unrelatedImages(input_.rig, views_));
        naming.addUndone(input_, isScene_ ? std::vector<Undone>() : boardOfOtherSize(input_.rig, views_, unit_));
        // Also where a change explains all: of a camera in the middle of its images, mirrored ones look like a window mirrored.
        if (!isScene_ && !(unchanged_.chiSquare < GROSS*GROSS*problem_->observations()))
            naming.addUndone(input_, swappedImages(input_.rig, views_));
        named_ = naming.name();
    }

    bool isNamed(const TestedChange& tested) const { return std::find(named_.begin(), named_.end(), &tested) != named_.end(); }

    void addWindows()
    {
        const auto isTold = [](const TestedChange& t) {
            return (t.change->isTilt || t.change->isShift) && t.at.count() == t.change->size(); };
        fitThose(isTold);
        for (const TestedChange& tested : tested_)
            if (isTold(tested))
                result_.windows.push_back(windowOf(tested));
    }

    //! The covariance of the linear test, which holds whatever was found.
    MatrixXd covarianceOf(const TestedChange& tested) const
    {
        const MatrixXd ranges = tested.change->ranges().asDiagonal();
        const int n = tested.at.count();
        return product(product(ranges, inverse(information_.G.block(tested.at.first, tested.at.first, n, n))), ranges);
    }

    void addTurns()
    {
        for (const TestedChange& tested : tested_)
        {
            const Change& change = *tested.change;
            if (!change.isTurn() || tested.at.count() < change.size())
                continue;
            const double variance = SymmetricEigen(covarianceOf(tested)).values.maxCoeff();
            result_.turns.push_back({change.name, change.camera, std::sqrt(variance)*DEGREES, tested.at.count(), tested.probability});
        }
    }

    WindowCheck windowOf(const TestedChange& tested) const
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
    std::vector<TestedChange> tested_;
    std::vector<const TestedChange*> named_;
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
    std::vector<std::string> sentences;
    for (const NamedChange& change : result.changes)
        sentences.push_back(change.sentence);
    return text + alternatives(sentences, MOST);
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
