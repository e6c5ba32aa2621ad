// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RELAXED_PROBLEM_HPP
#define REFRACT_TOOLS_RELAXED_PROBLEM_HPP

#include "calibrate/fit.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/view_observations.hpp"

namespace tools {

//! What a calibration estimated and what it knew, on the numbers of its rig as toVector() has them.
struct RelaxedProblem
{
    //! Of a distance that the calibration held: where it is among the numbers and in `free`, and how large it may be.
    struct Bound
    {
        int number, column;
        double most;
    };

    RelaxedProblem(const RigData& data, const Fit& fit, bool posesKnown);
    //! What is known adds this to chi^2.
    double priorOf(const VectorXd& numbers) const;

    RigModel rig;                               //!< where a fit begins, with its poses
    std::vector<ViewObservations> views;
    MatrixXd free;                              //!< columns: changes of the numbers that the calibration estimated
    MatrixXd information;                       //!< of priors
    VectorXd known;                             //!< their means
    std::vector<MatrixXd> poseInformation;      //!< of each view; empty: nothing is known; infinite: exact
    std::vector<VectorXd> knownPoses;
    std::vector<Bound> bounds;

private:
    void addKnownCamera(int c);
    void freeDistance(const Fit& fit, int c);
};

//! rvec, then tvec.
VectorXd toVector(const cv::Vec3d& rvec, const cv::Vec3d& tvec);

} // namespace tools

#endif // REFRACT_TOOLS_RELAXED_PROBLEM_HPP
