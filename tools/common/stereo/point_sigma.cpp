// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/point_sigma.hpp"
#include "console/progress.hpp"

#include <cmath>

namespace tools {

using cv::Mat;
using cv::Matx33d;
using cv::Vec3d;
using cv::Vec3f;

namespace {

/* What the calibration is worth at a point changes slowly all over the view: its variances are found at the nodes of a grid of
pixels of the new image 1 and of disparities, and between them interpolated. */
class CalibrationVariance
{
public:
    explicit CalibrationVariance(const RectifiedRig& rig) : rig_(rig)
    {
        if (rig.calibration().covariance.empty())
            return;
        step_ = Vec3d((rig.size().width - 1)/(double)(COLUMNS - 1), (rig.size().height - 1)/(double)(ROWS - 1),
                      (rig.disparities() - 1)/(double)(DEPTHS - 1));
        variances_.resize(COLUMNS*ROWS*DEPTHS);
        std::vector<cv::Point2d> pixels[2];
        for (int i = 0; i < (int)variances_.size(); i++)
        {
            const Vec3d X = pointAt(i);
            for (int c = 0; c < 2; c++)
            {
                std::vector<cv::Point2d> pixel;
                const Vec3d T = c ? rig.calibration().extrinsics[c].T : Vec3d();
                const Matx33d R = c ? rig.calibration().extrinsics[c].R : Matx33d::eye();
                cv::refract::refractiveProjectPoints(std::vector<Vec3d>{X}, R, T, rig.calibration().cameras[c].camera, pixel);
                pixels[c].push_back(pixel[0]);
            }
        }
        Mat points, status, covariance;
        const Calibration& calibration = rig.calibration();
        cv::refract::triangulateRefractive(calibration.cameras[0].camera, calibration.cameras[1].camera, calibration.extrinsics[1].R,
                                           calibration.extrinsics[1].T, pixels[0], pixels[1], points, status, 0, 0.,
                                           calibration.covariance, covariance);
        for (int i = 0; i < (int)variances_.size(); i++)
        {
            const double* C = covariance.ptr<double>(i);
            variances_[i] = Vec3d(C[0], C[4], C[8]);
        }
    }

    //! Of x, y, z; a node without an answer, behind a window say, gives its part to the others.
    Vec3d at(double x, double y, double disparity) const
    {
        if (variances_.empty())
            return Vec3d();
        const double place[] = {x/step_[0], y/step_[1], (disparity - rig_.minDisparity())/step_[2]};
        const int counts[] = {COLUMNS, ROWS, DEPTHS};
        int first[3];
        double part[3];
        for (int k = 0; k < 3; k++)
        {
            first[k] = std::clamp(cvFloor(place[k]), 0, counts[k] - 2);
            part[k] = std::clamp(place[k] - first[k], 0., 1.);
        }
        Vec3d sum;
        double weights = 0;
        for (int corner = 0; corner < 8; corner++)
        {
            double weight = 1;
            int index[3];
            for (int k = 0; k < 3; k++)
            {
                const int bit = corner >> k & 1;
                index[k] = first[k] + bit;
                weight *= bit ? part[k] : 1 - part[k];
            }
            const Vec3d& v = variances_[(index[2]*ROWS + index[1])*COLUMNS + index[0]];
            if (v == v && weight > 0)
            {
                sum += weight*v;
                weights += weight;
            }
        }
        return sum*(1/weights);     // NaN if no node has an answer
    }

private:
    enum { COLUMNS = 9, ROWS = 7, DEPTHS = 7 };

    //! Of a node, camera-1 frame.
    Vec3d pointAt(int i) const
    {
        const double x = i % COLUMNS*step_[0], y = i/COLUMNS % ROWS*step_[1], d = rig_.minDisparity() + i/(COLUMNS*ROWS)*step_[2];
        const cv::Vec4d X = cv::Matx44d(rig_.Q.ptr<double>())*cv::Vec4d(x, y, std::max(d, rig_.shift() + 0.5), 1);
        return Matx33d(rig_.R1.ptr<double>()).t()*(Vec3d(X.val)*(1/X[3]));
    }

    const RectifiedRig& rig_;
    Vec3d step_;
    std::vector<Vec3d> variances_;
};

} // namespace

Mat pointSigma(const RectifiedRig& rig, const DenseStereo& stereo, double contradiction)
{
    const CalibrationVariance calibration(rig);
    const Vec3d centre = Matx33d(rig.R1.ptr<double>()).t()*rig.centre();
    Mat result(stereo.points.size(), CV_32FC3, cv::Scalar::all(NAN));
    inParallel(result.rows, [&](int y) {
        for (int x = 0; x < result.cols; x++)
        {
            const Vec3f& X = stereo.points.at<Vec3f>(y, x);
            if (!(X[2] == X[2]))
                continue;
            const double d = stereo.disparity.at<float>(y, x);
            // a pinhole's point is its centre + something/(d - shift)
            const double byMatch = stereo.disparitySigmas.at<float>(y, x)/(d - rig.shift());
            const Vec3d along = (Vec3d(X) - centre)*std::sqrt(byMatch*byMatch + contradiction*contradiction);
            const Vec3d variance = along.mul(along) + calibration.at(x, y, d);
            result.at<Vec3f>(y, x) = Vec3f((float)std::sqrt(variance[0]), (float)std::sqrt(variance[1]), (float)std::sqrt(variance[2]));
        }
    });
    return result;
}

} // namespace tools
