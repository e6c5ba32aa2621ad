// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_OUTER_COVARIANCE_HPP
#define OPENCV_REFRACT_OUTER_COVARIANCE_HPP

#include "adjust/eliminate.hpp"

namespace cv { namespace refract {

/** The covariance of all outer parameters for unit pixel noise, as parts of it are asked for: of thousands of poses it is never made as
a whole. With the halves H of the cameras' and G = -L^-T W H,

    S = [ H H^T      H G^T       ]
        [ G H^T   G G^T + A^-1   ],     A = L L^T, W: ScenePoses */
class OuterCovariance
{
public:
    OuterCovariance() {}
    //! @param ofCameras H
    OuterCovariance(const Information& information, const Eigen::MatrixXd& ofCameras);
    //! For of(). @param factor L; its memory is used
    void invertPoses(BlockCholesky factor) { ofPoses_ = BlockInverse(std::move(factor)); }

    //! H, and below it G.
    const Eigen::MatrixXd& half() const { return half_; }
    void setHalf(const Eigen::MatrixXd& half);
    /** Once poses are inverted: S of some columns of the free space, which ascend; of a pose all six. Any two poses must be of views that
    show a point of one cluster. */
    Eigen::MatrixXd of(const std::vector<int>& columns) const;

private:
    int cameras_ = 0;
    Eigen::MatrixXd half_;
    Eigen::MatrixXd byCameras_;         //!< S of all, by the cameras
    BlockInverse ofPoses_;              //!< A^-1
};

}} // namespace

#endif // OPENCV_REFRACT_OUTER_COVARIANCE_HPP
