// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/outer_covariance.hpp"
#include "math/dense.hpp"

namespace cv { namespace refract {

using Eigen::MatrixXd;
static const int SIZE = BlockCholesky::SIZE;

OuterCovariance::OuterCovariance(const Information& information, const MatrixXd& ofCameras)
    : cameras_((int)ofCameras.rows())
{
    const ScenePoses& poses = information.poses;
    const int ofPoses = SIZE*poses.factor.count();
    MatrixXd half = MatrixXd::Zero(cameras_ + ofPoses, ofCameras.cols());
    half.topRows(cameras_) = ofCameras;
    if (ofPoses > 0 && ofCameras.size() > 0)        // Eigen has no products of nothing
    {
        half.bottomRows(ofPoses) = -product(poses.byCameras, ofCameras);
        poses.factor.solveTranspose(half.bottomRows(ofPoses));
    }
    setHalf(half);
}

void OuterCovariance::setHalf(const MatrixXd& half)
{
    half_ = half;
    byCameras_ = MatrixXd::Zero(half.rows(), cameras_);
    if (half.size() > 0 && cameras_ > 0)
        byCameras_ = timesTranspose(half, half.topRows(cameras_));
}

MatrixXd OuterCovariance::of(const std::vector<int>& columns) const
{
    const int count = (int)columns.size();
    const int cameras = (int)(std::lower_bound(columns.begin(), columns.end(), cameras_) - columns.begin());
    MatrixXd S(count, count);
    for (int c = 0; c < cameras; c++)
        for (int r = 0; r < count; r++)
            S(r, c) = byCameras_(columns[r], columns[c]);
    for (int c = cameras; c < count; c += SIZE)
        for (int r = c; r < count; r += SIZE)
        {
            S.block<SIZE, SIZE>(r, c) = ofPoses_((columns[r] - cameras_)/SIZE, (columns[c] - cameras_)/SIZE);
            if (half_.cols() > 0)       // Eigen has no parts of nothing
                S.block<SIZE, SIZE>(r, c) +=
                    half_.middleRows<SIZE>(columns[r]).lazyProduct(half_.middleRows<SIZE>(columns[c]).transpose());
        }
    S.triangularView<Eigen::StrictlyUpper>() = S.transpose();
    return S;
}

}} // namespace
