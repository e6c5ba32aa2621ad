// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_EXIF_HPP
#define REFRACT_TOOLS_EXIF_HPP

#include <string>
#include <vector>

/* Cameras that know how they were held say so in the EXIF data, and viewers turn the picture. The lens does not turn: pixels are
used as they are stored, and users are told. */
namespace tools {

/** Whether the EXIF data of a JPEG or PNG file ask for another picture than the stored one: OpenCV's own reader says so, by what it
makes of the file with and without them. (A picture that looks the same when turned does not ask.) */
bool asksForTurn(const std::vector<unsigned char>& bytes);

//! The file is read as stored; one warning at the end of the tool names all such files.
void noteTurnedImage(const std::string& path);

//! The sentence, once; empty if no file was noted.
std::string takeTurnedImagesNotice();

} // namespace tools

#endif // REFRACT_TOOLS_EXIF_HPP
