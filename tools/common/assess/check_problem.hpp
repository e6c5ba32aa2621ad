// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHECK_PROBLEM_HPP
#define REFRACT_TOOLS_CHECK_PROBLEM_HPP

#include "assess/change.hpp"
#include "assess/check_input.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/view_observations.hpp"
#include <memory>

/* New images of a target, or of a scene, against a calibration:

    pixels - predicted = A dp + B delta + K dpose + noise,     B = A dp/ddelta

p are the calibrated parameters, whose error dp = L q has the calibration's covariance L L^T; delta is what changed since then; the
boards' poses are free, and so are all points of a scene. With these projected out, the least squares

    chi^2 = |pixels - predicted|^2 / sigma^2 + |q|^2

are the generalised ones with the covariance S = sigma^2 I + A L L^T A^T. */
namespace tools {

struct CheckRows;           // a linearisation

//! One change freed, or none.
struct CheckFit
{
    RigModel rig;                               //!< as it is now
    std::vector<ViewObservations> views;        //!< with their poses, or points
    VectorXd q, delta;
    MatrixXd covariance;                        //!< of delta
    double chiSquare = 0.;                      //!< infinity: no fit
    std::shared_ptr<const CheckRows> rows = {}; //!< there, where nothing is changed; null: not yet known
};

class CheckProblem
{
public:
    //! @param views with a first estimate of what is unknown of them @param sigma of a usual pixel coordinate
    CheckProblem(const CheckInput& input, const std::vector<ViewObservations>& views, double sigma);

    //! Of a target; throws Failure if its pose cannot be found.
    CheckProblem(const CheckInput& input, const std::vector<View>& views, double sigma);

    //! The calibration as it is. @param start its fit with another sigma
    CheckFit fitUnchanged() const;
    CheckFit fitUnchanged(const CheckFit& start) const;

    //! One change freed, from another fit. @param directions of its parameters that the images tell, a column each
    CheckFit fit(const Change& change, const MatrixXd& directions, const CheckFit& start) const;

    /** What the images tell about changes, to first order at a fit: G = B^T S^-1 B of all their parameters, which are in units of
    their ranges, and B^T S^-1 r. With no change that is a vector with the covariance G, of which D C D^T is due to the error dp of
    the calibration, the same in all checks: D = B^T S^-1 A. */
    struct Information
    {
        MatrixXd G;
        VectorXd score;
        MatrixXd byParameters;      //!< D
        double chiSquare;           //!< r^T S^-1 r, of no change
    };
    Information information(const std::vector<Change>& changes, const CheckFit& at) const;

    //! The boards' poses at their best for the calibrated values.
    CheckFit asCalibrated() const;

    //! The parameters that a change moves, in its ranges, a column each.
    MatrixXd directionsOf(const Change& change) const;

    int observations() const { return observations_; }  //!< without those that poses and points take

private:
    struct Normal;
    std::shared_ptr<const CheckRows> linearise(const RigModel& rig, const std::vector<ViewObservations>& views) const;
    Normal normalEquations(const CheckRows& rows, const MatrixXd& byDelta, const VectorXd& q) const;
    RigModel rigOf(const VectorXd& q, const Change* change, const VectorXd& delta) const;
    MatrixXd derivative(const Change& change, const VectorXd& q, const VectorXd& delta) const;
    CheckFit iterate(const Change* change, const MatrixXd& directions, const CheckFit& start) const;

    CheckInput input_;
    double sigma_;
    int observations_ = 0;
    VectorXd parameters_;           // the calibrated ones
    MatrixXd root_, inverseRoot_;   // L, and T of T^T L = 1
    std::vector<ViewObservations> views_;
};

} // namespace tools

#endif // REFRACT_TOOLS_CHECK_PROBLEM_HPP
