// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SHEET_FIT_HPP
#define REFRACT_TOOLS_SHEET_FIT_HPP

#include "laser/board_line.hpp"
#include "laser/sheet.hpp"

/* The sheet of light from lines on boards. Which of each board's candidates is the line, the sheet decides on which most boards agree.
What each line tells is in sheet_line.cpp. Where the boards disagree by more than their poses' errors, these are taken to be larger (a
board that is not flat, corners that err together).

A sheet is a plane, or that of an emitter behind a window, which is not: then of maximum likelihood with what is known of the emitter. */
namespace tools {

/* The line on one board, as a sheet's estimate sees it. Few numbers of it tell of the sheet: how far from it its middle is, how it turns,
and, of a sheet that may be bent, how it bends. Their errors are those of the line's points, of the board's pose and of the calibration. */

/** The plane on which candidates of most images lie, by all pairs of candidates of two images (RANSAC's score, without chance).
@return a unit normal and d; zeros if no two images agree */
cv::Vec4d planeOfMostLines(const std::vector<BoardImage>& images);

//! The points of a line, by what their distances e from the sheet depend on.
struct LineRows
{
    VectorXd e, sigma;          //!< sigma: of e, by the line's own noise
    VectorXd along;             //!< position on the line, from its middle, -1 ... 1 or less
    MatrixXd byState;           //!< of the sheet, what is free
    MatrixXd byPose, byParameters;      //!< byPose: by errors of the board's corners; byParameters with the pose
    MatrixXd ofPose;            //!< 6x6, covariance of the pose
};

//! @param lineNoise px, of points beyond white noise. @param pixelSigma of a corner's coordinate
LineRows rowsOf(const Calibration& calibration, const BoardImage& image, const std::vector<int>& points, const SheetSurface& sheet,
                double lineNoise, double pixelSigma);

//! Coefficients of a line, of least squares.
struct ReducedLine
{
    VectorXd e;
    MatrixXd byState, byParameters, ofNoise, ofPose;

    ReducedLine(const LineRows& rows, int coefficients);
    MatrixXd weight(double poseNoise) const;
};

/** What lies where the sheet puts the line; empty: too little.
@param scale px, of the line's profile. @param near px from the sheet */
std::vector<int> pointsOnSheet(const BoardImage& image, const SheetSurface& sheet, double scale, double near);

//! Where points are off the straight line through them, px across.
std::vector<double> straightResiduals(const BoardImage& image, const std::vector<int>& points, const SheetSurface& sheet);

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
    static constexpr double LARGE_POSE_NOISE = 10.;
    std::vector<int> without;           //!< images in which no line is on the sheet
    std::vector<int> disagreeing;       //!< images left out, as their lines contradict those of the others
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
