// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "bundle/mistaken_matches.hpp"
#include "bundle/moments.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include <algorithm>

using namespace cv;

namespace tools {

namespace {

const int MOST_TRIED = 6;                                   // of four cameras all

struct Exchange
{
    int a, b;
    Matches matches;
    double miss;                    //!< of rays, with the start
};

Exchange exchangeOf(const BundleStart& start, const Matches& given, int a, int b)
{
    Exchange exchange = {a, b, given, 0.};
    std::swap(exchange.matches.pixels[a], exchange.matches.pixels[b]);
    if (!given.stds.empty())
        std::swap(exchange.matches.stds[a], exchange.matches.stds[b]);
    exchange.miss = missOf(start, exchange.matches.pixels, a);
    return exchange;
}

//! Those whose rays miss each other least first.
std::vector<Exchange> exchangesOf(const BundleStart& start, const Matches& matches)
{
    std::vector<Exchange> all;
    for (int b = 1; b < matches.cameraCount(); b++)
        for (int a = 0; a < b; a++)
            all.push_back(exchangeOf(start, matches, a, b));
    std::stable_sort(all.begin(), all.end(), [](const Exchange& p, const Exchange& q) { return p.miss < q.miss; });
    if (all.size() > MOST_TRIED)
        all.resize(MOST_TRIED);
    return all;
}

/** Whether there is a fit near the start, which contradicts nothing that is known of it.
@param adjustment written; where there is no fit it is no more than begun */
bool fits(const BundleStart& start, const GivenLengths& lengths, const Readjust& adjust, double knownSigma, BundleAdjustment& adjustment,
          const MeasuredBundle* measured = nullptr)
{
    try
    {
        adjustment = adjust(start);
        return findingsOf(start, lengths, adjustment, adjust, knownSigma, 0., measured).contradictions.empty();
    }
    catch (const Failure&)              // no fit, no explanation
    {
        return false;
    }
}

} // namespace

std::string exchangedCameras(const BundleStart& start, const Matches& matches, const GivenLengths& lengths, bool robust, double knownSigma)
{
    BundleAdjustment adjustment;
    for (const Exchange& exchange : exchangesOf(start, thinned(matches, lengths)))
    {
        const auto adjust = [&](const BundleStart& from) {
            return adjustBundle(from, exchange.matches, lengths, robust, ENOUGH_ITERATIONS); };
        if (fits(start, lengths, adjust, knownSigma, adjustment))
            return format("the observations of cameras %d and %d are exchanged: taken as each other's, they fit near the start with "
                          "%.3g px of noise; exchange their columns in the table (of --wand their images), or the two cameras of the "
                          "start", exchange.a + 1, exchange.b + 1, adjustment.fit.sigma);
    }
    return "";
}

std::string wrongMatches(const BundleStart& start, const GivenLengths& lengths, const Readjust& adjustRobustly,
                         const MeasuredBundle* measured, double sigma, double knownSigma,
                         const std::function<std::string(int point)>& nameOf)
{
    BundleAdjustment adjustment;
    if (!fits(start, lengths, adjustRobustly, knownSigma, adjustment, measured) || !(adjustment.fit.sigma < EXPLAINS*sigma)
        || adjustment.usedPixels == adjustment.seenPixels)
        return "";
    std::vector<std::string> names;
    for (const int i : adjustment.outliers())
        names.push_back(nameOf(i));
    return format("%d of %d pixels are wrong%s: all others fit to %.3g px; correct them, or leave out --no-robust",
                  adjustment.seenPixels - adjustment.usedPixels, adjustment.seenPixels,
                  names.empty() ? "" : (" (" + listed(names) + ")").c_str(), adjustment.fit.sigma);
}

} // namespace tools
