// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_NORMAL_EQUATIONS_HPP
#define OPENCV_REFRACT_NORMAL_EQUATIONS_HPP

#include "adjust/block_cholesky.hpp"

namespace cv { namespace refract {

//! Normal equations of cameras and of a scene's poses. Of matrices with a diagonal the lower half counts.
struct NormalEquations
{
    NormalEquations(int cameras, const BlockGraph& graph);
    Eigen::MatrixXd ofCameras;
    BlockCholesky ofPoses;
    Eigen::MatrixXd ofBoth;     //!< by the poses, by the cameras
    Eigen::VectorXd gradient;   //!< of half the squared error

    //! @param columns of cameras, and of one pose
    void add(const Eigen::MatrixXd& products, const Eigen::VectorXd& ownGradient, const std::vector<int>& columns);
    Eigen::VectorXd diagonal() const;
    void addToDiagonal(const Eigen::VectorXd& damping);

private:
    double& at(int row, int column);
};

/** What is eliminated of a scene's views, once its points are: their poses. Those that are adjusted are its blocks, in the order of the
views; the free space has their columns after those of the cameras. With the factor L of their information, the root of all is

    [ L^T  W ]
    [ 0    R ],     R: Information::root */
struct ScenePoses
{
    BlockCholesky factor;
    Eigen::MatrixXd byCameras;      //!< W
    Eigen::VectorXd residual;       //!< above that of the cameras
};

//! The root of normal equations: root * (change of the parameters) = -residual is the step to the least squares.
struct RootOfEquations
{
    /** @param effect of each parameter alone, to which columns are scaled
    @param rounding what is left of a squared scaled column below this is 0 */
    RootOfEquations(NormalEquations equations, const Eigen::VectorXd& effect, double rounding);
    ScenePoses poses;
    Eigen::MatrixXd ofCameras;      //!< R
    Eigen::VectorXd residual;       //!< of R
    //! The step. What is not determined does not move.
    Eigen::VectorXd step(const Eigen::VectorXd& effect, double rounding) const;
};

}} // namespace

#endif // OPENCV_REFRACT_NORMAL_EQUATIONS_HPP
