// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/change_naming.hpp"
#include "console/failure.hpp"
#include "diagnose/hypothesis_tests.hpp"
#include "math/dense.hpp"
#include "measure/distributions.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv::refract;

namespace tools {

static const double NO_FIT = std::numeric_limits<double>::infinity();

double probabilityOfResiduals(const CheckProblem& problem, double chiSquare, int parameters, double dof)
{
    const int count = problem.observations() - parameters;
    return std::isfinite(chiSquare) ? upperTailAnyF(count, dof, chiSquare/count) : 0.;
}

void ChangeNaming::add(const TestedChange& tested)
{
    if (!std::isfinite(tested.fit.chiSquare))
        return;
    const Change& change = *tested.change;
    const std::vector<ChangedValue> values = valuesOf(change, tested.fit.delta, tested.fit.covariance);
    NamedChange named{change.name, sentenceOf(change, values), change.camera, values, tested.probability};
    candidates_.push_back({named, tested.fit.chiSquare, tested.at.count(), &tested});
}

/* Wrong matches of a scene that are left are those that fit what their rig was bent to. A mistake undone has it straight: few that are far
off then are wrong, and count as just not. */
static CheckFit fitOfScene(const CheckInput& input, std::vector<ViewObservations> views, double sigma)
{
    const double MOST = 0.02, FAR = 5.;         // share of the matches; standard deviations
    double ofWrong = 0.;
    for (int round = 0;; round++)
    {
        CheckFit fit = CheckProblem(input, views, sigma).fitUnchanged();
        std::vector<ViewObservations> kept = views;
        size_t wrong = 0, all = 0;
        for (size_t v = 0; v < views.size() && std::isfinite(fit.chiSquare); v++)
        {
            wrong += giveUpFarOff(fit.rig, fit.views[v], FAR*sigma, kept[v]);
            all += views[v].objectPoints.size();
        }
        if (round > 0 || wrong == 0 || wrong > MOST*all)
        {
            fit.chiSquare += ofWrong;
            return fit;
        }
        ofWrong = FAR*FAR*wrong;
        views = kept;
    }
}

static CheckFit fitOf(const Undone& undone, const CheckInput& input, double sigma)
{
    if (!undone.observed.empty() && undone.observed[0].isScene)
        return fitOfScene(input, undone.observed, sigma);
    const CheckProblem problem = undone.observed.empty() ? CheckProblem(input, undone.views, sigma)
                                                         : CheckProblem(input, undone.observed, sigma);
    const CheckFit fit = problem.fitUnchanged();
    return undone.freed && std::isfinite(fit.chiSquare) ? problem.fit(*undone.freed, undone.freed->ranges().asDiagonal(), fit) : fit;
}

void ChangeNaming::addUndone(const CheckInput& input, const std::vector<Undone>& all)
{
    for (const Undone& undone : all)
    {
        try
        {
            const CheckFit fit = fitOf(undone, input, result_.sigma);
            if (!std::isfinite(fit.chiSquare))
                continue;
            const int parameters = std::max(1, 6*undone.poses);
            const double probability = probabilityOf(std::max(0., unchanged_.chiSquare - fit.chiSquare), parameters, result_.dof);
            candidates_.push_back({{undone.name, undone.name, undone.camera, {}, probability}, fit.chiSquare, parameters, nullptr});
        }
        catch (const Failure&) {}           // no pose
        catch (const cv::Exception&) {}
    }
}

bool ChangeNaming::isExplained(const Candidate& c) const
{
    const double UNEXPLAINED = 1e-4;        // probability of residuals that no single change explains
    return probabilityOfResiduals(problem_, c.chiSquare, c.parameters, result_.dof) > UNEXPLAINED;
}

//! One candidate's parameters contain those of another: it is no other explanation.
bool ChangeNaming::contains(const TestedChange& large, const TestedChange& small) const
{
    if (large.at.count() <= small.at.count())
        return false;
    const MatrixXd outer = problem_.directionsOf(*large.change), inner = problem_.directionsOf(*small.change);
    const double NOTHING = 1e-4;
    const MatrixXd rest = inner - product(outer, PivotedQR(outer).solve(inner));
    return rest.norm() < NOTHING*inner.norm();
}

//! Of two of which one contains the other, the one that has no more parameters than it is worth.
void ChangeNaming::dropNested()
{
    double variance = NO_FIT;
    for (const Candidate& c : candidates_)
        variance = std::min(variance, noiseOf(c));
    variance = std::max(1., variance);
    const double penalty = std::log((double)problem_.observations());
    const auto criterion = [&](const Candidate& c) { return c.chiSquare/variance + penalty*c.parameters; };
    std::vector<Candidate> kept;
    for (const Candidate& large : candidates_)
        if (std::none_of(candidates_.begin(), candidates_.end(), [&](const Candidate& small) {
                return large.tested && small.tested && criterion(small) <= criterion(large)
                       && contains(*large.tested, *small.tested); }))
            kept.push_back(large);
    candidates_ = kept;
}

std::vector<ChangeNaming::Candidate> ChangeNaming::ranked() const
{
    const double pixels2 = result_.sigma*result_.sigma;
    std::vector<Hypothesis> tried;
    for (const Candidate& c : candidates_)
        tried.push_back({pixels2*c.chiSquare, c.parameters});
    const double asGiven = std::isfinite(unchanged_.chiSquare) ? pixels2*unchanged_.chiSquare : NO_FIT;
    std::vector<size_t> ranked = rank({asGiven, 0}, tried, problem_.observations(), result_.sigma);
    if (ranked.empty())                     // too small a change to tell
        ranked = rank({NO_FIT, 0}, tried, problem_.observations(), result_.sigma);
    std::vector<Candidate> named;
    for (size_t i : ranked)
        named.push_back(candidates_[i]);
    return named;
}

/* What explains as much is told in the order of what can happen. Nobody said that the pane is another. And of a scene: a camera turns
in its mount before a window moves, and both before a sensor does in its camera, which a scene hardly tells from a turn. About the base
line a turn of one of two cameras is one of the other: both are told first. */
void ChangeNaming::tellWhatCanHappenFirst(std::vector<Candidate>& named) const
{
    const auto end = std::stable_partition(named.begin(), named.end(), [](const Candidate& c) {
        return !c.tested || !c.tested->change->isOfAnotherPane; });
    if (!isScene_ || end == named.begin())
        return;
    const double AS_LIKELY = 10., best = named[0].chiSquare;       // difference of two chi^2
    const auto less = std::stable_partition(named.begin(), end, [=](const Candidate& c) { return c.chiSquare < best + AS_LIKELY; });
    const auto easeOf = [](const Candidate& c) { return c.tested ? c.tested->change->ease : Change::CAMERA_TURNS; };
    std::stable_sort(named.begin(), less, [=](const Candidate& a, const Candidate& b) { return easeOf(a) < easeOf(b); });
    for (auto c = named.begin(); c != less && c->tested && c->tested->change->isTurn(); ++c)
        result_.mayHaveTurned.push_back(c->tested->change->turnedCamera());
}

std::vector<const TestedChange*> ChangeNaming::name()
{
    dropNested();
    std::vector<Candidate> named = ranked();
    result_.isMixup = !named.empty() && !named[0].tested;
    result_.explained = !named.empty() && isExplained(named[0]);
    // Of a large contradiction a small share is much: where one explains it all, what the noise refutes is no other explanation.
    if (result_.explained)
        named.erase(std::remove_if(named.begin(), named.end(), [&](const Candidate& c) { return !isExplained(c); }), named.end());
    tellWhatCanHappenFirst(named);
    std::vector<NamedChange>& changes = result_.changes;
    std::vector<const TestedChange*> tested;
    for (const Candidate& c : named)            // a board that looks the same turned by half can be numbered in two ways
    {
        tested.push_back(c.tested);
        if (std::none_of(changes.begin(), changes.end(), [&](const NamedChange& n) { return n.sentence == c.named.sentence; }))
            changes.push_back(c.named);
    }
    if (!named.empty())
        result_.sigmaSeen = result_.sigma*std::sqrt(named[0].chiSquare/(problem_.observations() - named[0].parameters));
    return tested;
}

} // namespace tools
