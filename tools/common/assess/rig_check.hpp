// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RIG_CHECK_HPP
#define REFRACT_TOOLS_RIG_CHECK_HPP

#include "assess/changed_value.hpp"
#include "assess/check_problem.hpp"
#include "assess/check_level.hpp"
#include "calibrate/rig_data.hpp"
#include "measure/view_observations.hpp"

/* Has anything changed since the calibration, and what? From a few new images of the target, or of a scene. Each hypothesis of the table
(change.hpp) is freed alone; under "nothing changed" its gain in chi^2 follows F. If one of them is less probable than all of them
together ever are at the rate of false alarms, something has changed. What it is, Schwarz's criterion tells (hypothesis_tests.hpp). */
namespace tools {

//! A window, freed alone.
struct WindowCheck
{
    int camera;
    cv::Vec3d normal;           //!< as it is now
    cv::Vec3d center;           //!< of a dome or tube, as it is now
    /** Between the calibrated normal and this; NaN: it is not what changed. Of a dome or tube the motion of its centre, as an angle: as
    large as it is seen from a radius away. */
    double tiltDeg;
    double stdDeg[2];           //!< of the tilt, two principal ones, larger first
    double lengthPerDegree;     //!< of a centre; 0: it is a tilt
    int parameters;             //!< of the change
    double probability;         //!< of so large a tilt or a larger one if nothing moved
    bool moved;                 //!< this explains the images, and nothing that is not a window does so better
};

//! Of a camera against the others.
struct TurnCheck
{
    std::string name;           //!< of the change
    int camera;
    double stdDeg;              //!< of the turn, about the axis about which it is known least
    int parameters;             //!< of the change
    double probability;         //!< of so large a turn or a larger one if nothing changed
};

//! A change that explains the new images.
struct NamedChange
{
    std::string name, sentence;     //!< the name alone, and with its values
    int camera;                     //!< from 0; negative: of the rig as a whole
    std::vector<ChangedValue> values;
    double probability;             //!< of so large a gain or a larger one if nothing changed
};

struct CheckResult
{
    bool changed = false;
    //! The best and those about as good, one or the other: first those for which no pane need be another, each kind the best first.
    std::vector<NamedChange> changes;
    bool explained = true;              //!< the best leaves no more than noise
    std::vector<WindowCheck> windows;   //!< of the cameras that have a glass image; of a shared window the first
    std::vector<TurnCheck> turns;       //!< of all cameras whose turns the images tell
    double sigma;                       //!< of a pixel coordinate that the test took
    double sigmaSeen;                   //!< of the new images, the best change made
    double dof;                         //!< of sigma
    double critical;                    //!< probability below which one hypothesis is a change
    double noiseHere;                   //!< of the images by themselves; 0: too few points tell
    ChartedScore charted;
    std::vector<UnseenError> unseen;    //!< of a target's images
    //! From 0: of a scene, cameras of which each alone explains it by its turn as well as the best does. Their changes are the first.
    std::vector<int> mayHaveTurned;
    bool isMixup = false;               //!< the best are images that are not what they are given for
};

const double CERTAIN_POWER = 0.95;      //!< probability with which a change must show for its absence to be said

//! Throws Failure if no view has an image through a window, or a target's pose cannot be found. @param unit of lengths, for the texts
CheckResult checkRig(const CheckInput& input, const std::vector<View>& views, double falseAlarm, const std::string& unit = "");

/** The same by points of a scene. How noisy their pixels are, they tell themselves: by what no change of the table explains.
@param scene of which the points are unknown */
CheckResult checkScene(const CheckInput& input, const ViewObservations& scene, double falseAlarm, const std::string& unit);

//! "a; or b", the best three.
std::string causesIn(const CheckResult& result);

/** Probability that a tilt of this size, in the direction in which it shows least, is found.
@param share of the covariance: 1/2 for twice as many images */
double powerOf(const WindowCheck& window, const CheckResult& result, double tiltDeg, double share = 1.);
double powerOf(const TurnCheck& turn, const CheckResult& result, double turnDeg, double share = 1.);

} // namespace tools

#endif // REFRACT_TOOLS_RIG_CHECK_HPP
