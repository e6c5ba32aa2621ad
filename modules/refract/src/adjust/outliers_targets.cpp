// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/outliers.hpp"
#include "adjust/moved_images.hpp"

namespace cv { namespace refract {

double TargetOutliers::rootWeight(double ratio) const
{
    const double TUKEY = 4.685;     // 95 % as efficient as squares on clean data
    return std::max(0., 1 - std::pow(ratio/TUKEY, 2));
}

void TargetOutliers::leaveOutImages(double scale)
{
    for (int i : findMovedImages(problem_, scale))
        status_[i] = GLASS_IMAGE_MOVED;
}

FitOutcome TargetOutliers::setInliers(Masks& inliers)
{
    for (int i = 0; i < (int)inliers.size(); i++)
    {
        const double kept = (double)std::count(inliers[i].begin(), inliers[i].end(), 1);
        if (status_[i] == GLASS_IMAGE_USED && kept < LEAST_INLIER_RATIO*(double)inliers[i].size())
            status_[i] = GLASS_IMAGE_UNUSABLE;
        if (status_[i] != GLASS_IMAGE_USED)
            std::fill(inliers[i].begin(), inliers[i].end(), (uchar)0);
        problem_.setRootWeights(i, std::vector<double>(inliers[i].begin(), inliers[i].end()));
    }
    return FitOutcome();
}

Masks TargetOutliers::candidates() const
{
    Masks all;
    for (size_t i = 0; i < status_.size(); i++)
        all.push_back(std::vector<uchar>(problem_.images()[i].points.pixel.size(), status_[i] == GLASS_IMAGE_USED));
    return all;
}

}} // namespace
