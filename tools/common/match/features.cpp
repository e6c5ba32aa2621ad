// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/features.hpp"
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <set>

using namespace cv;

namespace tools {

namespace {

struct Kind
{
    const char* name;
    Ptr<Feature2D> (*create)(int most);
};

const Kind KINDS[] = {
    {"SIFT", [](int most) -> Ptr<Feature2D> { return SIFT::create(most); }},
    {"ORB", [](int most) -> Ptr<Feature2D> { return ORB::create(most); }},
    {"AKAZE", [](int) -> Ptr<Feature2D> { return AKAZE::create(); }},
    {"KAZE", [](int) -> Ptr<Feature2D> { return KAZE::create(); }},
    {"BRISK", [](int) -> Ptr<Feature2D> { return BRISK::create(); }},
};

const Kind& kindOf(const std::string& name)
{
    for (const Kind& kind : KINDS)
        if (name == kind.name)
            return kind;
    CV_Error(Error::StsBadArg, "no features are called '" + name + "'");
}

//! Where a detector says that a blob is, from where it is: versions of OpenCV that double the image of SIFT by cv::resize are a quarter of
//! a pixel off, at all scales. Of detectors of corners, which find no blob, 0.
Point2d offsetOf(const Kind& kind)
{
    const double SIZE = 64., SIGMA = 4.;
    const int ALL = 100;
    const Point2d truth(31.3, 32.4);
    Mat grey((int)SIZE, (int)SIZE, CV_8U);
    for (int v = 0; v < grey.rows; v++)
        for (int u = 0; u < grey.cols; u++)
        {
            const Point2d d = Point2d(u, v) - truth;
            grey.at<uchar>(v, u) = saturate_cast<uchar>(40. + 180.*std::exp(-0.5*d.dot(d)/(SIGMA*SIGMA)));
        }
    std::vector<KeyPoint> found;
    kind.create(ALL)->detect(grey, found);
    Point2d offset;
    double least = 1.;              // px; farther off it is another blob
    for (const KeyPoint& point : found)
        if (norm(Point2d(point.pt) - truth) < least)
        {
            offset = Point2d(point.pt) - truth;
            least = norm(offset);
        }
    const double QUARTERS = 4.;
    return Point2d(std::round(QUARTERS*offset.x), std::round(QUARTERS*offset.y))*(1./QUARTERS);
}

//! Measured once.
Point2d knownOffsetOf(const Kind& kind)
{
    static std::mutex mutex;
    static std::map<std::string, Point2d> offsets;
    const std::lock_guard<std::mutex> lock(mutex);
    const auto known = offsets.find(kind.name);
    return known != offsets.end() ? known->second : offsets[kind.name] = offsetOf(kind);
}

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

std::vector<std::string> featureNames()
{
    std::vector<std::string> names;
    for (const Kind& kind : KINDS)
        names.push_back(kind.name);
    return names;
}

Features featuresOf(const Mat& grey, int most, const std::string& name)
{
    const Kind& kind = kindOf(name);
    const Point2d offset = knownOffsetOf(kind);
    std::vector<KeyPoint> found;
    Mat descriptors;
    kind.create(most)->detectAndCompute(grey, noArray(), found, descriptors);
    std::vector<int> strongest;         // not all detectors take a number
    for (int i = 0; i < (int)found.size(); i++)
        strongest.push_back(i);
    if ((int)found.size() > most)
    {
        std::stable_sort(strongest.begin(), strongest.end(), [&](int a, int b) { return found[a].response > found[b].response; });
        strongest.resize(most);
    }
    Features features;
    features.descriptors.create((int)strongest.size(), descriptors.cols, descriptors.type());
    for (int i : strongest)
    {
        descriptors.row(i).copyTo(features.descriptors.row(features.size()));
        features.pixels.push_back(Point2d(found[i].pt) - offset);
        features.scales.push_back(0.5*found[i].size);
    }
    return features;
}

int normOf(const Features& features) { return features.descriptors.depth() == CV_8U ? NORM_HAMMING : NORM_L2; }

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
