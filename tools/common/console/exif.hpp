// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_EXIF_HPP
#define REFRACT_TOOLS_EXIF_HPP

#include <string>
#include <vector>

/* Many cameras store their orientation in the EXIF data, and viewers rotate the picture by it. The lens does not rotate: the tools use
the pixels as they are stored, and warn the user. */
namespace tools {

/** Whether the EXIF data of a JPEG or PNG file rotate the picture: OpenCV's reader decides, with and without them. (A picture that is the
same when rotated counts as not rotated.) */
bool hasExifRotation(const std::vector<unsigned char>& bytes);

//! The file is read as stored; one warning at the end of the tool names all such files.
void noteRotatedImage(const std::string& path);

//! The sentence, once; empty if no file was noted.
std::string takeRotationNotice();

} // namespace tools

#endif // REFRACT_TOOLS_EXIF_HPP
