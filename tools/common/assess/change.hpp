// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHANGE_HPP
#define REFRACT_TOOLS_CHANGE_HPP

#include "measure/eigen_matrix.hpp"
#include "calibrate/rig_model.hpp"
#include <functional>

/* What may have changed on a rig since its calibration: one hypothesis a row of a table. */
namespace tools {

//! Some of a change's parameters, told as one number: their length, or their value if there is one.
struct ChangedQuantity
{
    std::string unit;           //!< "degrees"; empty: the number has none
    double factor;              //!< from the parameter to that unit
    int count;                  //!< parameters
    double range;               //!< of each, by how much it may at most have changed
};

struct Change
{
    std::string name;           //!< "window of camera 1 tilted by"
    int camera;                 //!< from 0; negative: of the rig as a whole
    std::vector<ChangedQuantity> quantities;
    //! Changes the rig by these parameters; 0: not at all.
    std::function<void(RigModel& rig, const VectorXd& delta)> apply;
    bool isTilt = false;        //!< of the window of that camera
    bool isAxis = false;        //!< a turn of its tube's axis
    bool isShift = false;       //!< of the centre of its dome or tube
    bool isOfAnotherPane = false;       //!< thickness, index, wedge: one that stays where it is keeps them
    //! Of what explains a scene as well as others, the lesser is told first: what moves most easily.
    enum Ease { CAMERA_TURNS, FIRST_CAMERA_TURNS, MOVES, UNLIKELY } ease = MOVES;
    //! What may also come slowly, of heat, load or age, has a control chart (history/): its name; empty: none.
    std::string chart = "";
    std::vector<std::string> axes = {};     //!< of its parameters, in that chart and in sentences
    double chartFactor = 1.;                //!< from the parameter to the chart's unit

    bool isTurn() const { return ease <= FIRST_CAMERA_TURNS; }     //!< of a camera about its own centre
    int turnedCamera() const { return ease == FIRST_CAMERA_TURNS ? 0 : camera; }
    int size() const;
    VectorXd ranges() const;
};

//! Of all targets alike.
Change changeOfSquare();

/** The table. Each row frees one thing alone.
@param unit of lengths, for the sentences; may be empty
@param middle of the boards, in camera 1: about which they turn */
std::vector<Change> changesOf(const RigModel& rig, const std::string& unit, const cv::Vec3d& middle);

} // namespace tools

#endif // REFRACT_TOOLS_CHANGE_HPP
