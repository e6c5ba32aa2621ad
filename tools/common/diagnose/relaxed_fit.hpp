// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RELAXED_FIT_HPP
#define REFRACT_TOOLS_RELAXED_FIT_HPP

#include "calibrate/fit.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/view_observations.hpp"
#include <cmath>

/* A calibration fitted again to the same images, with more free than it had. Gauss-Newton from where the calibration is, which is near:
tens of milliseconds, where the library's fit, which searches and tests, takes seconds. It also frees what the library cannot, as what is
different between the direct images and those through the windows. All that the calibration knew (priors) it still knows, weighted by a
noise that is given: a noise that a wrong value has made large would make the prior of that value as weak. */
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

//! A number that is freed: it moves some numbers of the rig (as toVector has them) together.
struct Shift
{
    std::vector<std::pair<int, double>> numbers;    //!< which, and by how much for a shift of 1
    bool glassOnly = false;                         //!< only in the images through the windows
};

struct Relaxed
{
    RigModel direct, glass;             //!< equal but for shifts that are glassOnly
    std::vector<ViewObservations> views;
    VectorXd before;                    //!< numbers of the rig without the shifts
    VectorXd shifts;
    double chiSquare = INFINITY;        //!< squared residuals over noise^2, and what the priors add
    MatrixXd covariance;                //!< of the numbers with the shifts, in images through the windows; then of the shifts
};

class RelaxedFit
{
public:
    //! @param noise px, standard deviation of a coordinate
    RelaxedFit(const RigData& data, const Fit& fit, bool posesKnown, double noise);

    const RigModel& rig() const { return problem_.rig; }
    double noise() const { return noise_; }
    //! Coordinates and priors, less what the calibration estimated.
    double dof() const { return dof_; }

    //! The calibration itself, for this noise.
    Relaxed asGiven() const { return fit(start_, {}); }
    //! @param start of the same shifts, or without any
    Relaxed fit(const Relaxed& start, const std::vector<Shift>& freed) const;
    //! By how much chi^2 would fall, to first order, for each of some sets of shifts.
    std::vector<double> gains(const Relaxed& at, const std::vector<std::vector<Shift>>& sets) const;
    //! RMS, px, of what is left of each image by a pose of its own: what no error of the rig's windows and places makes much larger.
    double noiseOfSingleImages() const;

private:
    struct Normal;
    struct Rows;
    Rows rowsOf(const Relaxed& at, size_t view, const std::vector<MatrixXd>& changes) const;
    Normal linearize(const Relaxed& at, const std::vector<Shift>& freed) const;
    bool setRigs(const std::vector<Shift>& freed, Relaxed& at) const;
    bool move(const Normal& normal, const std::vector<Shift>& freed, const VectorXd& step, Relaxed& at) const;
    VectorXd stepFrom(const Relaxed& at, const Normal& normal, double damping) const;

    RelaxedProblem problem_;
    Relaxed start_;
    double noise_, dof_;
};

} // namespace tools

#endif // REFRACT_TOOLS_RELAXED_FIT_HPP
