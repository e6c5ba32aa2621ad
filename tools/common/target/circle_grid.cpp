// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/circle_grid.hpp"
#include "target/limited_search.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <algorithm>

using namespace cv;

namespace tools {

namespace {

const int SECONDS = 20;     // of processor time: the detector may take minutes for nothing

//! The largest dot that can fit decides the blob detector's limits.
std::vector<Point2f> findDots(const Mat& grey, Size size, bool asymmetric)
{
    SimpleBlobDetector::Params limits;
    limits.maxArea = std::max(limits.maxArea, (float)(grey.total()/size.area()));
    const int flags = asymmetric ? CALIB_CB_ASYMMETRIC_GRID : CALIB_CB_SYMMETRIC_GRID;
    for (const uchar colour : {0, 255})
    {
        limits.blobColor = colour;
        const auto detector = SimpleBlobDetector::create(limits);
        for (const int extra : {0, (int)CALIB_CB_CLUSTERING})
        {
            std::vector<Point2f> centres;
            if (findCirclesGrid(grey, size, centres, flags | extra, detector))
                return centres;
        }
    }
    return {};
}

} // namespace

std::vector<Point2d> detectCircleGrid(const Mat& grey, Size size, bool asymmetric)
{
    const std::vector<Point2f> centres = searchLimited(SECONDS, size.area(), [&] { return findDots(grey, size, asymmetric); });
    return std::vector<Point2d>(centres.begin(), centres.end());
}

} // namespace tools
