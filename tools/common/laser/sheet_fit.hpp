// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SHEET_FIT_HPP
#define REFRACT_TOOLS_SHEET_FIT_HPP

#include "laser/board_line.hpp"
#include "laser/emitter.hpp"
#include "laser/sheet.hpp"

/* The sheet of light from lines on boards. Which of each board's candidates is the line, the sheet decides on which most boards agree.
What each line tells is in sheet_line.hpp. Where the boards disagree by more than their poses' errors, these are taken to be larger (a
board that is not flat, corners that err together).

A sheet is a plane, or that of an emitter behind a window, which is not: then of maximum likelihood with what is known of the emitter. */
namespace tools {

//! A board's line with the sheet that the other boards make.
struct HeldOutLine
{
    double rms;             //!< of the points' distance from the sheet
    double stated;          //!< what their and the sheet's covariance expect
};

struct LineOnBoard
{
    int image;                          //!< index of the BoardImage
    std::vector<int> points;            //!< of it
    double rmsPx = 0.;                  //!< off a straight line on the board
    double noise = 0.;                  //!< px, of the points beyond white noise
    double bend = 0., bendSigma = 0.;   //!< distance of its middle from the line through its ends
    HeldOutLine heldOut = {};
};

struct SheetFit
{
    Sheet sheet;
    std::vector<LineOnBoard> lines;
    std::vector<int> without;           //!< images in which no line is on the sheet
    double sheetStd = 0.;               //!< of the sheet's distance where the lines are, RMS; camera and noise
    double poseNoise = 1.;              //!< errors of the boards' poses over those of the pixels' noise
    double planeExcess = 0.;            //!< chi-square of the nearest plane minus that of the emitter's sheet
    double moved = 0.;                  //!< standard deviations of the emitter's prior by which the lines move it, the largest
    double heldOutRms() const;
    double heldOutRatio() const;        //!< error over stated, RMS
};

/** Throws Failure if fewer than two boards agree, the lines do not determine a plane, or the emitter sends them no light.
@param pixelSigma of a corner's coordinate. @param scale px, at which the lines were found */
SheetFit fitSheet(const std::vector<BoardImage>& images, const Calibration& calibration, double pixelSigma, double scale,
                  const EmitterPrior* emitter = nullptr);

} // namespace tools

#endif // REFRACT_TOOLS_SHEET_FIT_HPP
