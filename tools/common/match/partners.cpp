// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/partners.hpp"
#include "match/features.hpp"

#include <opencv2/features2d.hpp>
#include <set>

namespace tools {

using cv::Mat;

namespace {

const double CLEARLY_NEARER = 0.8;      // than the second best, as Lowe has it

//! For each of `from` the one of `to` that is clearly the most alike; -1: none.
std::vector<int> bestOf(const Features& from, const Features& to)
{
    std::vector<std::vector<cv::DMatch>> matches;
    cv::BFMatcher(normOf(from)).knnMatch(from.descriptors, to.descriptors, matches, 2);
    std::vector<int> best(from.size(), -1);
    for (const auto& two : matches)
        if (two.size() == 2 && two[0].distance < CLEARLY_NEARER*two[1].distance)
            best[two[0].queryIdx] = two[0].trainIdx;
    return best;
}

} // namespace

Partners findPartners(const Mat& grey1, const Mat& grey2, int mostFeatures)
{
    Partners partners;
    const Features first = featuresOf(grey1, mostFeatures), second = featuresOf(grey2, mostFeatures);
    if (first.size() < 2 || second.size() < 2)
        return partners;
    const std::vector<int> forth = bestOf(first, second), back = bestOf(second, first);
    std::set<std::pair<double, double>> places;       // a corner of a chessboard is several features, one a direction, but one observation
    for (size_t i = 0; i < forth.size(); i++)
        if (forth[i] >= 0 && back[forth[i]] == (int)i && places.emplace(first.pixels[i].x, first.pixels[i].y).second)
        {
            partners.pixels1.push_back(first.pixels[i]);
            partners.pixels2.push_back(second.pixels[forth[i]]);
        }
    return partners;
}

} // namespace tools
