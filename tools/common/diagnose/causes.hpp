// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CAUSES_HPP
#define REFRACT_TOOLS_CAUSES_HPP

#include "calibrate/starting_model.hpp"
#include "diagnose/relaxed_fit.hpp"
#include <functional>

/* What may be wrong with a calibration that was fitted: a given value, or what is taken to be the same in direct images and in those
through the windows. Each is set free alone. */
namespace tools {

struct Cause
{
    std::string kind;                   //!< two of one kind are named once: the better
    std::vector<Shift> freed;
    std::function<std::string(const Relaxed&, double deviations)> sentence;
    bool posesToo = false;              //!< known poses are given up, nothing else
};

//! Those that this calibration can have.
std::vector<Cause> causesOf(const RigData& data, const RigOptions& options, const Fit& fit);

/* A fitted rig as the causes of a contradiction look at it, and the words that they share. */

struct FittedRig
{
    const RigData& data;
    const RigOptions& options;
    const Fit& fit;

    std::vector<int> windowOwners() const
    {
        std::vector<int> owners;
        for (int c = 0; c < data.cameraCount; c++)
            if (fit.rig.ownsWindow(c))
                owners.push_back(c);
        return owners;
    }
    //! Of all cameras, or of one.
    bool hasBothStates(int camera = -1) const
    {
        bool direct = false, glass = false;
        for (int m : fit.views)
            for (int c = 0; c < data.cameraCount; c++)
                if (camera < 0 || c == camera)
                {
                    direct = direct || data.views[m].hasDirect(c);
                    glass = glass || data.views[m].hasGlass(c);
                }
        return direct && glass;
    }
};

//! " of camera 2's window"; nothing where there is one.
std::string ofWindow(const FittedRig& rig, int camera);

//! By the ratio of likelihoods, of all that is freed: no distance from the given value in units of the freed one's +-.
std::string howSure(double deviations);

std::string unitHint(double ratio);

//! The standard deviation of a sum of numbers of the rig.
double stdOfSum(const Relaxed& found, const std::vector<int>& numbers);

//! The side of a board's square, as it is given; 0: there is no board.
double squareOf(const RigData& data);

//! Thickness, index, distance, radius, medium: all windows together, as one option gives them; and each alone.
void addValues(const FittedRig& rig, std::vector<Cause>& causes);

//! What is known of where a flat window is: its normal, and its distance if markers tell it.
void addKnownPlaces(const FittedRig& rig, std::vector<Cause>& causes);

//! The faces of all layers of one window; images tell the sum, which the first layer stands for.
void addWedges(const FittedRig& rig, std::vector<Cause>& causes);

//! The curvature of a window that is taken to be flat within --bow-std.
void addBows(const FittedRig& rig, std::vector<Cause>& causes);

} // namespace tools

#endif // REFRACT_TOOLS_CAUSES_HPP
