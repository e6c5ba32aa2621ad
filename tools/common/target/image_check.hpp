// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_IMAGE_CHECK_HPP
#define REFRACT_TOOLS_IMAGE_CHECK_HPP

#include "console/images.hpp"

/* Whether files are the images of one camera: told within seconds, while the search for a board may take minutes. */
namespace tools {

//! Where the images of one camera in one state (direct or through the window) come from.
struct ImageSource
{
    std::string source;             //!< a glob, a corners.vnl or a points.csv
    cv::Size imageSize = {};        //!< that images must have, and point files mean; empty: not known
    int camera = 0;
    std::string name = "images";    //!< "direct images"
    std::string yFrom = {};         //!< of tables that leave it open, see PixelOrigin
};

/** Reads each image once. Throws Failure that names the files if some cannot be read, if they have not the size of their source, if those
of a camera differ in size, or if a colour is asked for and one is grey.
@param files of each source; none for point files
@return the size of the images of each source */
std::vector<cv::Size> checkImages(const std::vector<ImageSource>& sources, const std::vector<std::vector<std::string>>& files,
                                  Channel channel, bool quiet);

//! Throws Failure if one of the three colours is asked for and the image is grey.
void requireColour(const std::string& path, Channel channel);

} // namespace tools

#endif // REFRACT_TOOLS_IMAGE_CHECK_HPP
