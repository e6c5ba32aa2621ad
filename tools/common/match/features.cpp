// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/features.hpp"

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <cmath>

using namespace cv;

namespace tools {

namespace {

//! Where the detector says that a blob is, from where it is: versions of OpenCV that double the image by cv::resize are a quarter of a
//! pixel off, at all scales.
Point2d offsetOfDetector()
{
    const double SIZE = 64., SIGMA = 4.;
    const Point2d truth(31.3, 32.4);
    Mat grey((int)SIZE, (int)SIZE, CV_8U);
    for (int v = 0; v < grey.rows; v++)
        for (int u = 0; u < grey.cols; u++)
        {
            const Point2d d = Point2d(u, v) - truth;
            grey.at<uchar>(v, u) = saturate_cast<uchar>(40. + 180.*std::exp(-0.5*d.dot(d)/(SIGMA*SIGMA)));
        }
    std::vector<KeyPoint> found;
    SIFT::create()->detect(grey, found);
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

} // namespace

Features featuresOf(const Mat& grey, int most)
{
    static const Point2d offset = offsetOfDetector();
    std::vector<KeyPoint> found;
    Features features;
    SIFT::create(most)->detectAndCompute(grey, noArray(), found, features.descriptors);
    for (const KeyPoint& point : found)
    {
        features.pixels.push_back(Point2d(point.pt) - offset);
        features.scales.push_back(0.5*point.size);
    }
    return features;
}

} // namespace tools
