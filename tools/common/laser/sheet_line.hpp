// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SHEET_LINE_HPP
#define REFRACT_TOOLS_SHEET_LINE_HPP

#include "laser/board_line.hpp"
#include "laser/sheet.hpp"

/* The line on one board, as a sheet's estimate sees it. Few numbers of it tell of the sheet: how far from it its middle is, how it turns,
and, of a sheet that may be bent, how it bends. Their errors are those of the line's points, of the board's pose and of the calibration. */
namespace tools {

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

} // namespace tools

#endif // REFRACT_TOOLS_SHEET_LINE_HPP
