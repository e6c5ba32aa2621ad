// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_GIVEN_RIG_HPP
#define REFRACT_TOOLS_GIVEN_RIG_HPP

#include "calibrate/given_places.hpp"
#include "calibrate/given_window.hpp"
#include "calibrate/starting_model.hpp"

namespace tools {

//! What the options of refract_calib say of the windows of all cameras: what is known, how well, and what is to be found.
struct GivenRigOptions
{
    GivenWindowOptions window;
    GivenStdOptions std;
    GivenPlaces places;
    std::vector<std::string> free;          //!< names of freeFlags()
    std::string windowOfCamera;             //!< "1,1,2,2"; empty: each has its own
    bool sharedWindow = false;
    std::string unit = "mm";

    /** Throws Failure where options do not go together, or ask for what no image can tell.
    @param knowsPoses of the target. @param square of a board; 0: there is none */
    RigOptions of(int cameras, Channel channel, bool knowsPoses, double square) const;
    //! Of a liquid that was given as a layer, which stays where it is only between two others; empty: there is none.
    std::string noticeOfLiquid(const cv::refract::GlassWindow& given) const;

private:
    bool isDistanceKnown() const;
    std::vector<int> windowsOf(int cameras) const;
    void takePlaces(int cameras, RigOptions& rig) const;
    void takeStd(double square, RigOptions& rig) const;
};

} // namespace tools

#endif // REFRACT_TOOLS_GIVEN_RIG_HPP
