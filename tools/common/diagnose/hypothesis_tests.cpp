// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/hypothesis_tests.hpp"
#include "console/progress.hpp"
#include "diagnose/causes.hpp"
#include "measure/distributions.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double VERY_STRONG = 10.;         // difference of two criteria
// Corners err a little together: two that remove nearly the same of a contradiction are as good.
const double AS_GOOD_SHARE = 0.05;
const double MORE_NOISE = 0.1;          // but leaves no more than this share beyond noise: of a gross contradiction 5 % is a lot

/* The likelihood ratio: twice the difference of the log likelihoods of a fit with a value free and of one within its prior is
distributed as chi^2 with as many degrees of freedom as numbers were freed, if the prior is right (Wilks, Annals of Mathematical
Statistics 9, 1938). It is so also where the value hardly shows, where the freed value's own standard deviation, which is of first
order, is that of the place to which noise has carried it. */

// Probabilities: told, and decided; those of four and six standard deviations. Corners err a little together, so that they seem more
// sure than they are, and there are some ten hypotheses.
const double TOLD = 6.3e-5, SURE = CERTAIN;
const double OTHER_NOISE = 1.05;        // so much more or less noise weighs priors otherwise
const int MOST_NAMED = 6;

struct Tested
{
    const Cause* cause;
    Relaxed found;
    double chiSquare;
    int parameters;
};

//! Whether the layers of all windows are of something that is transparent and solid; or were given otherwise.
bool canBe(const Relaxed& found, const Relaxed& given)
{
    const auto isUsual = [](double index) { return index > 1.2 && index < 2.5; };
    for (size_t c = 0; c < found.glass.cameras.size(); c++)
    {
        const std::vector<double> &now = found.glass.cameras[c]->window().index, &before = given.glass.cameras[c]->window().index;
        for (size_t i = 0; i < now.size(); i++)
            if (!isUsual(now[i]) && isUsual(before[i]))
                return false;
    }
    return true;
}

//! All that promise to explain something, fitted, for one assumption of the noise.
struct Trial
{
    Relaxed given;
    std::vector<Tested> tested;
    double noise = 0., dof = 0.;

    double leastNoise() const
    {
        double squares = given.chiSquare/dof;
        for (const Tested& t : tested)
            squares = std::min(squares, t.chiSquare/std::max(1., dof - t.parameters));
        return noise*std::sqrt(squares);
    }
};

//! @param before for another noise, which is near; null: none
Trial tried(const RigData& data, const RigOptions& options, const Fit& fit, const std::vector<Cause>& causes, double noise,
            const Trial* before = nullptr)
{
    const bool posesKnown = options.flags & GLASS_USE_POSES;
    const RelaxedFit relaxed(data, fit, posesKnown, noise);
    Trial trial{before ? relaxed.fit(before->given, {}) : relaxed.asGiven(), {}, noise, relaxed.dof()};
    const auto startOf = [&](const Cause& cause) {
        if (before)
            for (const Tested& t : before->tested)
                if (t.cause == &cause && std::isfinite(t.chiSquare))
                    return t.found;
        return trial.given; };
    std::vector<std::vector<Shift>> sets;
    for (const Cause& cause : causes)
        sets.push_back(cause.freed);
    const std::vector<double> gains = relaxed.gains(trial.given, sets);
    std::vector<Relaxed> found(causes.size());
    const auto isTried = [&](size_t i) {
        return causes[i].posesToo || upperTailChiSquared((int)causes[i].freed.size(), gains[i]) < PROMISING; };
    inParallel((int)causes.size(), [&](int i) {
        if (isTried(i))
            found[i] = causes[i].posesToo ? RelaxedFit(data, fit, false, noise).asGiven()
                                          : relaxed.fit(startOf(causes[i]), causes[i].freed); });
    for (size_t i = 0; i < causes.size(); i++)
    {
        if (!isTried(i) || !canBe(found[i], trial.given))
            continue;
        const int parameters = causes[i].posesToo ? 6*(int)found[i].views.size() : (int)causes[i].freed.size();
        trial.tested.push_back({&causes[i], found[i], found[i].chiSquare, parameters});
    }
    return trial;
}

//! All, for the noise that the best of them leaves. @param single px, the noise of images by themselves
Trial triedAll(const RigData& data, const RigOptions& options, const Fit& fit, const std::vector<Cause>& causes, double& single)
{
    single = RelaxedFit(data, fit, options.flags & GLASS_USE_POSES, fit.sigma).noiseOfSingleImages();
    const double noise = single > 0. ? std::min(single, fit.sigma) : fit.sigma;
    if (!(noise > 0.) || !(fit.dof > 0.))
        return {};
    const Trial trial = tried(data, options, fit, causes, noise);
    const double least = trial.leastNoise();
    return least > 0. && std::max(least/noise, noise/least) > OTHER_NOISE ? tried(data, options, fit, causes, least, &trial) : trial;
}

} // namespace

std::vector<size_t> rank(const Hypothesis& asGiven, const std::vector<Hypothesis>& tried, int observations, double noise)
{
    double variance = asGiven.squares/observations;
    for (const Hypothesis& h : tried)
        variance = std::min(variance, h.squares/std::max(1, observations - h.parameters));
    variance = std::max(variance, noise*noise);
    if (!(variance > 0.) || !std::isfinite(variance))
        return {};
    const auto criterion = [&](const Hypothesis& h) { return h.squares/variance + h.parameters*std::log((double)observations); };
    std::vector<size_t> ranked(tried.size());
    std::iota(ranked.begin(), ranked.end(), 0);
    std::stable_sort(ranked.begin(), ranked.end(), [&](size_t a, size_t b) { return criterion(tried[a]) < criterion(tried[b]); });
    const double gained = ranked.empty() ? 0. : criterion(asGiven) - criterion(tried[ranked[0]]);
    if (!(gained > VERY_STRONG))
        return {};
    const double margin = std::isfinite(gained) ? std::max(VERY_STRONG, std::min(AS_GOOD_SHARE*gained, MORE_NOISE*observations))
                                                 : VERY_STRONG;
    // What is as good needs no more than to explain as much: the penalty of its parameters says which is simpler, not which is true. A
    // motion of all boards has six, a thickness one, and along the axis images do not tell one from the other.
    const double most = tried[ranked[0]].squares/variance + margin, leastGain = criterion(asGiven) - VERY_STRONG,
                 best = criterion(tried[ranked[0]]);
    const auto isMuchWorse = [&](size_t i) {
        const Hypothesis& h = tried[i];
        return !(criterion(h) <= best + margin) && !(h.squares/variance <= most && criterion(h) < leastGain); };
    ranked.erase(std::remove_if(ranked.begin() + 1, ranked.end(), isMuchWorse), ranked.end());
    return ranked;
}

std::vector<CauseTest> testCauses(const RigData& data, const RigOptions& options, const Fit& fit)
{
    const std::vector<Cause> causes = causesOf(data, options, fit);
    double single;
    const Trial trial = triedAll(data, options, fit, causes, single);
    const double variance = std::pow(trial.leastNoise()/trial.noise, 2);
    std::vector<CauseTest> tests;
    for (const Tested& t : trial.tested)
        tests.push_back({t.cause->kind, (trial.given.chiSquare - t.chiSquare)/variance, t.parameters});
    return tests;
}

std::vector<Contradiction> testGivenValues(const RigData& data, const RigOptions& options, const Fit& fit)
{
    const std::vector<Cause> causes = causesOf(data, options, fit);
    double single = 0.;
    const Trial trial = triedAll(data, options, fit, causes, single);
    if (trial.tested.empty())
        return {};
    const double squares = trial.noise*trial.noise;
    std::vector<Hypothesis> hypotheses;
    for (const Tested& t : trial.tested)
        hypotheses.push_back({squares*t.chiSquare, t.parameters});
    const double variance = std::pow(trial.leastNoise()/trial.noise, 2);
    std::set<std::string> named;
    std::string text;
    bool isSure = false;
    double sigma = fit.sigma;
    for (size_t i : rank({squares*trial.given.chiSquare, 0}, hypotheses, (int)trial.dof, 0.))
    {
        const Tested& t = trial.tested[i];
        const double deviance = (trial.given.chiSquare - t.chiSquare)/variance;
        const double probability = upperTailChiSquared(t.parameters, deviance);
        if (!(probability < TOLD) || (int)named.size() >= MOST_NAMED || !named.insert(t.cause->kind).second)
            continue;
        if (text.empty())
        {
            isSure = probability < SURE;
            sigma = trial.noise*std::sqrt(t.chiSquare/std::max(1., trial.dof - t.parameters));
        }
        text += (text.empty() ? "" : "; or ") + t.cause->sentence(t.found, zScoreOfChiSquared(t.parameters, deviance));
    }
    if (text.empty())
        return {};
    return {{text, sigma, isSure, single}};
}

} // namespace tools
