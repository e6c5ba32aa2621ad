// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CALIBRATION_INPUT_HPP
#define REFRACT_TOOLS_CALIBRATION_INPUT_HPP

#include "calibrate/rig_data.hpp"
#include "calibrate/starting_model.hpp"
#include <functional>

namespace tools {

/* Images as they would be if they had been given otherwise: turned, exchanged, or some of them alone. */

//! Which images of a camera.
enum ImageState { DIRECT_IMAGES, GLASS_IMAGES, ALL_IMAGES };
bool hasImages(const std::vector<View>& views, int camera, ImageState state);

//! First rows and columns are exchanged, then columns or rows counted from the other side.
struct ImageTurn
{
    bool flipX, flipY, swap;
};
//! A pixel of an image that was turned or mirrored, where it would have been.
cv::Point2d undone(const ImageTurn& turn, cv::Point2d p, cv::Size size);
//! Where each point is in a board that is turned or mirrored about its middle; empty: it is not symmetrical.
std::vector<int> renumbered(const std::vector<cv::Point3d>& board, const ImageTurn& by);

//! Direct images and those through the window. @param camera negative: of all
void exchangeStates(std::vector<View>& views, int camera);
void exchangeCameras(std::vector<View>& views, int a, int b, ImageState state);

//! Some images of a view as a view of their own, if there are any. @param belong by camera, and whether through the window
void addPart(const View& view, const std::function<bool(int camera, bool glass)>& belong, std::vector<View>& views);

//! The input of a calibration, as the user gave it.
struct CalibrationInput
{
    RigData data;               //!< with its outliers
    RigOptions options;
    double square;
    std::vector<std::string> notices = {};      //!< of the checks before any fit
};

//! Of any camera.
bool hasPairs(const RigData& data);

//! The images of one camera, as a rig of its own.
CalibrationInput oneCamera(const CalibrationInput& input, int camera);

//! What the images fit if a mistake is undone.
struct Explanation
{
    std::string sentence;
    double px;                  //!< median error of the fit, see medianErrorOfFit
};

//! A mistake in the input of a calibration, which may explain why the images do not fit.
struct Mistake
{
    bool (*appliesTo)(const CalibrationInput& input);           //!< whether this input can have it
    Explanation (*undo)(const CalibrationInput& input);         //!< undoes it and fits the same images again
};
const double EXPLAINS_AS_WELL = 3.;         // times what the best of them leaves

//! Those that leave less than that, and are about as good as the best of them.
std::vector<Explanation> bestBelow(double most, const std::vector<Explanation>& tried);

//! Of mistakes in the order of what they leave free, those that leave less than any before.
std::vector<Explanation> withoutFreer(const std::vector<Explanation>& explaining);

} // namespace tools

#endif // REFRACT_TOOLS_CALIBRATION_INPUT_HPP
