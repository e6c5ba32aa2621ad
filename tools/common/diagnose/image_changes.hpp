// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_IMAGE_CHANGES_HPP
#define REFRACT_TOOLS_IMAGE_CHANGES_HPP

#include "calibrate/rig_data.hpp"
#include <functional>

/* Images as they would be if they had been given otherwise: turned, exchanged, or some of them alone. */
namespace tools {

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

} // namespace tools

#endif // REFRACT_TOOLS_IMAGE_CHANGES_HPP
