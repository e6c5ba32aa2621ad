// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_INFORMATION_HPP
#define OPENCV_REFRACT_INFORMATION_HPP

#include "calibrate/rig_problem.hpp"

namespace cv { namespace refract {

//! The free coordinates of each block, and where they stand among all.
struct FreeSpace
{
    explicit FreeSpace(const RigProblem& rig, bool withHeld = true) : count(0)
    {
        for (const RigBlock& block : rig.blocks())
        {
            bases.push_back(block.tangentBasis(withHeld));
            first.push_back(count);
            count += (int)bases.back().cols();
        }
    }
    std::vector<Eigen::MatrixXd> bases;
    std::vector<int> first;
    int count;
};

//! What a problem's residuals tell about the free parameters while the poses are unknown.
struct Information
{
    Eigen::MatrixXd root;       //!< upper triangular; root^T root = information for unit pixel noise
    Eigen::VectorXd effect;     //!< of each parameter alone: the norm of its derivatives
    Eigen::VectorXd residual;   //!< root * (change of the parameters) = -residual is the step to the least squares
    double ofPoses;             //!< sum of squares that the poses alone could still take up
};
//! @param withHeld also of parameters that are held on their bound
Information rigInformation(const RigProblem& rig, bool withHeld = true);

/** How far the least squares of the linearised problem are from where the parameters are, in pixels: divided by a pixel
coordinate's standard deviation, it is the length of the step in standard deviations of what it moves. */
double stepLeft(const RigProblem& rig);

/** Derivatives of all residuals, 2M x (P + 6 V): image by image in the order of images(); columns: the public parameters,
then the pose of each view; 0 where fixed. One camera. */
Eigen::MatrixXd rigJacobian(const RigProblem& rig);

}} // namespace

#endif // OPENCV_REFRACT_INFORMATION_HPP
