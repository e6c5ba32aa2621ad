// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Whether lengths and positions contradict each other or the images (data snooping). A robust fit believes them, and takes right pixels
// for wrong. So which pixels are right is told by a fit to which all measures say next to nothing; with these pixels, all of which count,
// the squares with the measures as given are larger by chi-square with as many degrees of freedom, if the measures are right. If it is
// more, each is set free, and what lessens the squares most is named.
#include "bundle/measures.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "measure/distributions.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;

namespace tools {

namespace {

const double MANY = 5., SOME = 2.;      // standard deviations: what is named, and what is looked into
const double INFINITE = std::numeric_limits<double>::infinity();

using Used = std::vector<std::vector<uchar>>;

//! What is set free: a length, a position, all of them, or the factor of all lengths.
struct Hypothesis
{
    enum Kind { FACTOR, LENGTH, POSITION, LENGTHS, POSITIONS } kind;
    int which;                          //!< object of GivenLengths, or view
    int count;                          //!< of numbers that are free
    double value = 0.;                  //!< of a factor where it is; of a single one how far off it is, in standard deviations
};

double spreadOf(const std::map<int, KnownPosition>& positions)
{
    Vec3d mean;
    double squares = 0.;
    for (const auto& position : positions)
        mean += position.second.center/(double)positions.size();
    for (const auto& position : positions)
        squares += std::pow(norm(position.second.center - mean), 2)/(double)positions.size();
    return std::sqrt(squares);
}

void setFree(const Hypothesis& freed, Measures& measures)
{
    const double ALONE = 10., TOGETHER = 20.;       // of a length; a twentieth of it is its own
    const double spread = spreadOf(measures.positions);
    if (freed.kind == Hypothesis::FACTOR)
        measures.lengths.factorStd = 1.;
    for (GivenLength& l : measures.lengths.list)
        if (freed.kind == Hypothesis::FACTOR)
        {
            l.length /= freed.value;
            l.std = std::max(l.std, l.std/freed.value);
        }
        else if (freed.kind == Hypothesis::LENGTHS)
            l.std = TOGETHER*l.length;
        else if (freed.kind == Hypothesis::LENGTH && l.object == freed.which)
            l.std = ALONE*l.length;
    for (auto& position : measures.positions)
        if (freed.kind == Hypothesis::POSITIONS)
            position.second.std = std::max(position.second.std, spread);
        else if (freed.kind == Hypothesis::POSITION && position.first == freed.which)
            position.second.std = std::max(position.second.std, ALONE*spread);
}

double foundLength(const GivenLength& length, const BundleAdjustment& adjustment)
{
    return norm(adjustment.points[length.a] - adjustment.points[length.b]);     // NaN: a point has no answer
}

//! What all lengths are too long by.
double factorOf(const GivenLengths& lengths, const BundleAdjustment& adjustment)
{
    std::vector<double> ratios;
    for (const GivenLength& length : lengths.list)
        if (std::isfinite(foundLength(length, adjustment)))
            ratios.push_back(length.length/foundLength(length, adjustment));
    return ratios.empty() ? 1. : median(ratios);
}

/** Pixels that are right whatever the measures are. A point of which fewer than three images are left, and one of an object that is seen
again and again, is wrong itself where the length contradicts it. */
Used rightPixels(const MeasuredBundle& bundle, const BundleAdjustment& given, const BundleAdjustment& vague)
{
    Used used = vague.used;
    std::vector<int> counts(vague.points.size(), 0);
    std::vector<char> isOfMany(vague.points.size(), 0);
    for (size_t c = 0; c < used.size(); c++)
        for (size_t i = 0; i < used[c].size(); i++)
            counts[bundle.points[c][i]] += used[c][i];
    const std::vector<int> times = bundle.measures.lengths.rowsOfObjects();
    for (const GivenLength& length : bundle.measures.lengths.list)
        isOfMany[length.a] = isOfMany[length.b] = isOfMany[length.a] || times[length.object] > 1;
    for (size_t c = 0; c < used.size(); c++)
        for (size_t i = 0; i < used[c].size(); i++)
        {
            const int point = bundle.points[c][i];
            const bool isLost = std::isnan(given.points[point].x);
            used[c][i] = used[c][i] && !(isLost && (counts[point] < 3 || isOfMany[point]));
        }
    return used;
}

//! Measures, and how well they fit pixels that are right.
class Comparison
{
public:
    Comparison(const MeasuredBundle& bundle, const BundleAdjustment& given) : bundle_(bundle)
    {
        vague_ = bundle.adjust(vagueMeasures(), nullptr);
        used_ = rightPixels(bundle, given, vague_);
        robust_ = vague_;
        if (used_ != vague_.used)
            vague_ = bundle.adjust(vagueMeasures(), &used_);
        given_ = used_ == given.used ? given : bundle.adjust(bundle.measures, &used_);
    }
    const BundleAdjustment& vague() const { return vague_; }
    const BundleAdjustment& robust() const { return robust_; }      //!< the same before all pixels that are left count
    const BundleAdjustment& given() const { return given_; }
    double costOf(const BundleAdjustment& adjustment) const { return adjustment.costAt(vague_.fit.sigma); }

    //! False: they have no fit.
    bool adjust(const Measures& measures, BundleAdjustment& adjustment) const
    {
        try
        {
            adjustment = bundle_.adjust(measures, &used_);
            return true;
        }
        catch (const Failure&)
        {
            return false;
        }
    }

private:
    Measures vagueMeasures() const
    {
        Measures measures = bundle_.measures;
        setFree({Hypothesis::LENGTHS, 0, 0}, measures);
        setFree({Hypothesis::POSITIONS, 0, 0}, measures);
        return measures;
    }

    const MeasuredBundle& bundle_;
    BundleAdjustment robust_, vague_, given_;
    Used used_;
};

/** Single lengths or positions that are far from a fit to which their kind says next to nothing, the farthest first. Objects that are seen
again and again are not among them: the same wrong length at all times is a factor. */
std::vector<Hypothesis> singlesOf(Hypothesis::Kind kind, const Measures& measures, const BundleAdjustment& adjustment)
{
    std::vector<Hypothesis> singles;
    const std::vector<int> times = measures.lengths.rowsOfObjects();
    const double factor = factorOf(measures.lengths, adjustment);
    for (const GivenLength& length : measures.lengths.list)
    {
        double variance = length.std*length.std;
        for (const int end : {length.a, length.b})
            variance += std::pow(norm(adjustment.sigma[end]), 2)/3.;
        const double off = std::abs(length.length - factor*foundLength(length, adjustment))/std::sqrt(variance);
        if (kind == Hypothesis::LENGTHS && times[length.object] == 1 && std::isfinite(off))
            singles.push_back({Hypothesis::LENGTH, length.object, 1, off});
    }
    for (const auto& place : adjustment.places)
        if (kind == Hypothesis::POSITIONS)
        {
            const KnownPosition& known = measures.positions.at(place.first);
            singles.push_back({Hypothesis::POSITION, place.first, 3, norm(place.second - known.center)/known.std});
        }
    std::stable_sort(singles.begin(), singles.end(), [](const Hypothesis& a, const Hypothesis& b) { return a.value > b.value; });
    return singles;
}

//! What a measure is, what everything else says in its place.
std::string textOf(const Hypothesis& freed, const MeasuredBundle& bundle, const BundleAdjustment& adjustment)
{
    const GivenLengths& lengths = bundle.measures.lengths;
    const std::string others = bundle.measures.positions.empty() ? "what the rig and its windows say" : "what the positions say";
    switch (freed.kind)
    {
    case Hypothesis::FACTOR:
        return format("the lengths of '%s' are %.4g times %s", bundle.lengthsPath.c_str(), factorOf(lengths, adjustment), others.c_str());
    case Hypothesis::LENGTHS:
        return "the lengths of '" + bundle.lengthsPath + "' contradict each other or the rest";
    case Hypothesis::POSITIONS:
        return "the positions of '" + bundle.positionsPath + "' contradict the rest (is each that of its image, and in one unit?)";
    case Hypothesis::POSITION:
    {
        const KnownPosition& known = bundle.measures.positions.at(freed.which);
        return format("line %d of '%s' is %.3g from where the rest says", known.line, bundle.positionsPath.c_str(),
                      norm(adjustment.places.at(freed.which) - known.center));
    }
    default:
        for (const GivenLength& length : lengths.list)
            if (length.object == freed.which && std::isfinite(foundLength(length, adjustment)))
                return format("line %d of '%s' says %g, and the rest %.5g", length.line, bundle.lengthsPath.c_str(), length.length,
                              foundLength(length, adjustment));
        return "";
    }
}

//! What is set free, and how well the rest fits then.
struct Freed
{
    std::vector<Hypothesis> what;
    BundleAdjustment adjustment;
    double cost = INFINITE;
};

//! Asks of what is contradicted, from the whole to single ones.
class Snooping
{
public:
    Snooping(const MeasuredBundle& bundle, const BundleAdjustment& adjustment)
        : bundle_(bundle), comparison_(bundle, adjustment), given_(comparison_.costOf(comparison_.given())),
          least_(comparison_.costOf(comparison_.vague())),
          count_((int)bundle.measures.lengths.list.size() + 3*(int)bundle.measures.positions.size()) {}

    const BundleAdjustment& rest() const { return comparison_.robust(); }
    bool isFactor() const { return isFactor_; }         //!< of text()

    std::string text()
    {
        if (isExplained(given_))
            return "";
        const GivenLengths& lengths = bundle_.measures.lengths;
        const std::vector<int> times = lengths.rowsOfObjects();
        const bool areRepeated = std::any_of(times.begin(), times.end(), [](int n) { return n > 1; });
        if (areRepeated)
        {
            const Freed factor = freedOf({{Hypothesis::FACTOR, 0, 1, factorOf(lengths, comparison_.vague())}});
            if (zScoreOfChiSquared(1, given_ - factor.cost) > MANY)
                return said(factor.what[0], factor.adjustment, given_ - factor.cost);
        }
        if (!lengths.list.empty() && !areRepeated)
        {
            const Freed freed = freedOf({{Hypothesis::LENGTHS, 0, (int)lengths.list.size()}});
            if (isExplained(freed.cost))
                return textOfLengths(freed);
        }
        if (bundle_.measures.positions.empty())
            return "";
        return textOfSingles(freedOf({{Hypothesis::POSITIONS, 0, 3*(int)bundle_.measures.positions.size()}}));
    }

private:
    bool isExplained(double cost) const { return std::isfinite(cost) && !(zScoreOfChiSquared(count_, cost - least_) > SOME); }

    Freed freedOf(const std::vector<Hypothesis>& what) const
    {
        Freed freed;
        freed.what = what;
        Measures measures = bundle_.measures;
        for (const Hypothesis& one : what)
            setFree(one, measures);
        if (comparison_.adjust(measures, freed.adjustment))
            freed.cost = comparison_.costOf(freed.adjustment);
        return freed;
    }

    std::string said(const Hypothesis& one, const BundleAdjustment& adjustment, double gain)
    {
        isFactor_ = isFactor_ || one.kind == Hypothesis::FACTOR;
        return textOf(one, bundle_, adjustment) + format(" (%.0f standard deviations)", zScoreOfChiSquared(one.count, gain));
    }

    std::string textOfLengths(const Freed& whole)
    {
        if (whole.what[0].count > 1 && suspectsOf(whole).empty())
        {
            const Freed factor = freedOf({{Hypothesis::FACTOR, 0, 1, factorOf(bundle_.measures.lengths, whole.adjustment)}});
            if (!(zScoreOfChiSquared(count_, factor.cost - least_) > MANY) && zScoreOfChiSquared(1, given_ - factor.cost) > MANY)
                return said(factor.what[0], factor.adjustment, given_ - factor.cost);
        }
        return textOfSingles(whole);
    }

    //! The single ones of a kind of which none is believed that are far off, farther than most; they share what the scale is off.
    std::vector<Hypothesis> suspectsOf(const Freed& whole) const
    {
        std::vector<Hypothesis> singles = singlesOf(whole.what[0].kind, bundle_.measures, whole.adjustment);
        std::vector<double> doubts;
        for (const Hypothesis& one : singles)
            doubts.push_back(one.value);
        const double limit = doubts.empty() ? 0. : MANY*std::max(1., median(doubts));
        singles.erase(std::remove_if(singles.begin(), singles.end(), [&](const Hypothesis& one) { return !(one.value > limit); }),
                      singles.end());
        return singles;
    }

    //! Of those that must be free for the rest to fit, tried with more until it does; of all of their kind, where these are many.
    std::string textOfSingles(const Freed& whole)
    {
        const size_t MORE = 2;
        const double gain = given_ - whole.cost;
        const std::string ofAll = zScoreOfChiSquared(whole.what[0].count, gain) > MANY ? said(whole.what[0], whole.adjustment, gain) : "";
        const std::vector<Hypothesis> singles = singlesOf(whole.what[0].kind, bundle_.measures, whole.adjustment);
        const size_t first = std::max<size_t>(1, suspectsOf(whole).size());
        for (size_t count = first; count <= first + MORE && (count == 1 || 2*count <= singles.size()); count++)
        {
            const Freed freed = freedOf({singles.begin(), singles.begin() + (long)std::min(count, singles.size())});
            if (isExplained(freed.cost))
                return textOfNeeded(freed);
        }
        return ofAll;
    }

    //! Each of them by itself: what it would cost to believe it.
    std::string textOfNeeded(Freed freed)
    {
        std::string text;
        for (const Hypothesis& one : std::vector<Hypothesis>(freed.what))
        {
            std::vector<Hypothesis> others;
            for (const Hypothesis& other : freed.what)
                if (other.which != one.which)
                    others.push_back(other);
            const double gain = (others.empty() ? given_ : freedOf(others).cost) - freed.cost;
            if (std::isinf(gain) || zScoreOfChiSquared(one.count, gain) > MANY)
                text += (text.empty() ? "" : "; ") + said(one, freed.adjustment, std::min(gain, 1e6));
        }
        return text;
    }

    const MeasuredBundle& bundle_;
    const Comparison comparison_;
    const double given_, least_;
    const int count_;
    bool isFactor_ = false;
};

} // namespace

ContradictedMeasures contradictedMeasures(const MeasuredBundle& bundle, const BundleAdjustment& adjustment)
{
    if (bundle.measures.lengths.list.empty() && bundle.measures.positions.empty())
        return {};
    try
    {
        Snooping snooping(bundle, adjustment);
        const std::string text = snooping.text();
        if (text.empty())
            return {};
        return {text + ": correct it or leave it out; until then pixels that are called wrong may be right, and windows are bent",
                snooping.isFactor(), snooping.rest()};
    }
    catch (const Failure&)              // nothing else tells what they say
    {
        return {};
    }
}

} // namespace tools
