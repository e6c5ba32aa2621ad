// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_INNER_HPP
#define OPENCV_REFRACT_INNER_HPP

#include "adjust/problem.hpp"

namespace cv { namespace refract {

/* The best values of all inner blocks, the outer ones staying: each by Levenberg and Marquardt's steps on its own observations,
from where it is. What inner iterations are to Ceres, and variable projection (Golub and Pereyra, 2003) to the rest. */

/** @param squaredError of the problem there
@return false where some point has no image, as the blocks are: there is no least squares near */
bool optimizeInner(Problem& problem, double& squaredError);

bool optimizePoses(Problem& problem, double& squaredError);         //!< of targets
bool optimizePoints(Problem& problem, double& squaredError);        //!< of a scene

/** A scene's clusters each by itself: the squares of each at its best, which is where it is then; infinite where one of its points has
no image to begin with, and stays there.
@param some if not empty, which clusters; the others stay where they are, with squares of 0 */
std::vector<double> optimizeClusters(Problem& problem, const std::vector<int>& some = std::vector<int>());
//! The information of the coordinates of some clusters where they are, the cameras staying; of the others nothing.
std::vector<Eigen::MatrixXd> informationOfClusters(const Problem& problem, const std::vector<int>& some);

//! All values of the inner blocks, one block after the other: to come back to.
Eigen::VectorXd innerValues(const Problem& problem);
void setInnerValues(Problem& problem, const Eigen::VectorXd& values);

//! Damping of one block's steps.
class StepControl
{
public:
    double damping() const { return damping_; }
    bool isHopeless() const { return damping_ > 1e8; }
    void accept() { damping_ = damping_ < 1e-5 ? 0 : 0.1*damping_; }
    void reject() { damping_ = std::max(1e-3, 10*damping_); }
    //! A gain that is below the rounding of what is summed.
    static bool isNegligible(double gain, double squaredError, double count)
    { return !(gain > 1e-12*squaredError + 1e-24*count); }

private:
    double damping_ = 0;
};

}} // namespace

#endif // OPENCV_REFRACT_INNER_HPP
