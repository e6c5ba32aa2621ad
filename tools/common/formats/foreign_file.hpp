// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FOREIGN_FILE_HPP
#define REFRACT_TOOLS_FOREIGN_FILE_HPP

#include "formats/foreign_rig.hpp"

namespace tools {

//! A file of another program, as its reader takes it.
struct ForeignFile
{
    std::string name, bytes;

    //! The text's first line with something on it that is no comment of '#'; empty: there is none.
    std::string firstLine() const;
};

/* The readers of files that are not made of names and values. Each throws Failure that says what is wrong, without the file's name.
is...() says whether a file looks like one, be it cut short or damaged. */

//! COLMAP's list of cameras, cameras.txt and cameras.bin, also with the ports of its fork for cameras under water.
bool isColmapText(const ForeignFile& file);
ForeignRig readColmapText(const ForeignFile& file);
bool isColmapBinary(const ForeignFile& file);
ForeignRig readColmapBinary(const ForeignFile& file);

/** OpenPTV's NAME.ori, with NAME.addpar and ptv.par beside it, or ptv.par in ../parameters: only this has the size of the image and of a
pixel, and the window's indices. */
bool isOpenPtv(const ForeignFile& file);
ForeignRig readOpenPtv(const ForeignFile& file);

//! OpenLPT's camera, a pinhole (PINHOLE) or one behind plates (PINPLATE). Where its y axis points up, so does that of the frame here.
bool isOpenLpt(const ForeignFile& file);
ForeignRig readOpenLpt(const ForeignFile& file);

//! All numbers of a text, whatever is between them; a word that is none ends them. @param whole receives whether all was numbers
std::vector<double> leadingNumbers(const std::string& text, bool* whole = nullptr);

} // namespace tools

#endif // REFRACT_TOOLS_FOREIGN_FILE_HPP
