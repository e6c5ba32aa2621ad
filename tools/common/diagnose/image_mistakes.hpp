// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_IMAGE_MISTAKES_HPP
#define REFRACT_TOOLS_IMAGE_MISTAKES_HPP

#include "diagnose/calibration_input.hpp"

/* Images that are not what they are given for. Each function undoes one mix-up, and fits the same images again. */
namespace tools {

const int MAX_SWAPPED_CAMERAS = 4;      // each needs a fit of all

//! --direct and --glass exchanged, of all cameras.
Explanation swappedStates(const CalibrationInput& input);

//! The same of one camera of several: the one that explains most.
Explanation swappedStatesOfOneCamera(const CalibrationInput& input);

//! Equal names of different cameras are not of the same moment.
Explanation unrelatedViews(const CalibrationInput& input);

//! Equal names of the images of one option and of all others are not of the same moment.
Explanation imagesOfOtherMoments(const CalibrationInput& input);

//! Images of several cameras are given for those of one, which their names show: cam1_3, cam2_3.
Explanation camerasInOneFolder(const CalibrationInput& input);

//! The same of pairs, which show it whatever their names are.
Explanation pairsOfTwoCameras(const CalibrationInput& input);

//! Few pairs are off what most of them show: their images through the window are left out.
Explanation oddImages(const CalibrationInput& input);

//! Equal names of a direct and a glass image are not of one pose of the board.
Explanation unpairedImages(const CalibrationInput& input);

/** Points from files: one axis reversed or two exchanged, v counted from below, or the same in one camera's file. Each of these
makes a mirror image. A flat target cannot tell, unless only one camera has it. */
Explanation mirroredPoints(const CalibrationInput& input);

/* A target that is not as given, found without a fit through the window. Each returns a sentence; empty: no such mistake. */

/** The detector finds a part of the board in place of the board, and not the same part in each image.
@param fewest views, above 0, that show it: of one alone the board may have moved by about a square */
std::string partOfBoard(const CalibrationInput& input, size_t fewest);

//! px RMS that a lens leaves of a camera's direct images; 0: there are none, or they are not asked for the lens.
double errorOfDirect(const CalibrationInput& input, int camera);

//! Corners in the direct images that no lens explains.
std::string badCorners(const CalibrationInput& input);

} // namespace tools

#endif // REFRACT_TOOLS_IMAGE_MISTAKES_HPP
