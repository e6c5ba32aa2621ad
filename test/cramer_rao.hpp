// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The Cramer-Rao bound of a scene from the calibrator's own jacobian, and how often intervals hold the truth.
#ifndef REFRACT_TEST_CRAMER_RAO_HPP
#define REFRACT_TEST_CRAMER_RAO_HPP

#include "calibration_scenes.hpp"

namespace scenes {

//! Two orthonormal vectors orthogonal to n, as columns.
inline cv::Matx<double, 3, 2> tangentsOf(const cv::Vec3d& n)
{
    const cv::Vec3d a = cv::normalize(n.cross(std::abs(n[0]) < 0.6 ? cv::Vec3d(1, 0, 0) : cv::Vec3d(0, 1, 0)));
    const cv::Vec3d b = n.cross(a);
    return cv::Matx<double, 3, 2>(a[0], b[0], a[1], b[1], a[2], b[2]);
}

/** Covariance bound of the normal (two tangents of tangentsOf) and, if it is free, the thickness, for pixels with a standard
deviation of 1, poses unknown. The scene is without noise; one camera of P = 16 parameters, one layer. */
inline cv::Mat cramerRaoBound(const CalibrationScene& perfect, bool paired, const cv::Ptr<RefractiveCamera>& camera,
                              int flags)
{
    const int P = 16, NORMAL = 8, THICKNESS = 12, views = (int)perfect.object.size();
    cv::Ptr<RefractiveCamera> found = makeCamera(lensNamed("the paper's"), camera->window());
    cv::Mat jacobian;
    cv::refract::calibrateGlass(perfect.object, paired ? perfect.direct : PixelViews(), perfect.refracted, found,
                                cv::noArray(), cv::noArray(), cv::noArray(), cv::noArray(), cv::noArray(), jacobian, flags);
    const bool thickness = (flags & cv::refract::GLASS_FREE_THICKNESS) != 0;
    cv::Mat basis = cv::Mat::zeros(P, thickness ? 3 : 2, CV_64F);
    cv::Mat(tangentsOf(camera->window().normal)).copyTo(basis(cv::Rect(0, NORMAL, 2, 3)));
    if (thickness)
        basis.at<double>(THICKNESS, 2) = 1;

    cv::Mat information = cv::Mat::zeros(basis.cols, basis.cols, CV_64F);
    int row = 0;
    for (int view = 0; view < views; view++)
    {
        int rows = 0;
        for (const PixelViews* images : { &perfect.refracted, &perfect.direct })
            if (images == &perfect.refracted || paired)
                rows += 2*(int)std::count_if((*images)[view].begin(), (*images)[view].end(),
                                             [](const cv::Point2d& p) { return !std::isnan(p.x); });
        const cv::Mat ofView = jacobian.rowRange(row, row + rows), J = ofView.colRange(0, P)*basis;
        const cv::Mat K = ofView.colRange(P + 6*view, P + 6*view + 6);
        cv::Mat fit;
        cv::solve(K, J, fit, cv::DECOMP_QR);
        information += J.t()*(J - K*fit);
        row += rows;
    }
    return information.inv(cv::DECOMP_SVD);
}

//! How often the truth lies within one and within 1.96 stated standard deviations.
class Coverage
{
public:
    void add(double error, double sigma)
    {
        count_++;
        within1_ += std::abs(error) < sigma;
        within2_ += std::abs(error) < 1.959964*sigma;
        sum_ += error*error/(sigma*sigma);
    }
    double one() const { return (double)within1_/count_; }
    double two() const { return (double)within2_/count_; }
    double rms() const { return std::sqrt(sum_/count_); }       //!< of error/sigma
    void print(const std::string& what) const
    {
        std::cout << "[numbers] " << what << ": 68 % interval holds the truth in " << 100*one() << " %, 95 % in " << 100*two()
                  << " % (" << count_ << " errors)" << std::endl;
    }
private:
    int count_ = 0, within1_ = 0, within2_ = 0;
    double sum_ = 0;
};

} // namespace scenes

#endif // REFRACT_TEST_CRAMER_RAO_HPP
