// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_STORAGE_HPP
#define OPENCV_REFRACT_STORAGE_HPP

#include "precomp.hpp"
#include <functional>

/* Files of FileStorage that others may have written: whatever is in them, they are read or refused. FileStorage itself
takes the memory that a matrix claims to need, and goes as deep as brackets do. */
namespace cv { namespace refract {

//! Opened for reading. Throws StsObjectNotFound or StsParseError.
FileStorage openStorage(const String& filename);

//! The matrix of one channel called `key`, CV_64F, a plain list is a column; empty if there is none. Throws StsParseError.
Mat readStoredMatrix(const FileNode& map, const char* key, const String& filename);

//! OpenCV's name of what files of other programs call a lens model ("plumb_bob"); empty: OpenCV has no such model.
String lensModelCalled(const String& name);

/** Writes a file as saveStorage does.
@param write to that path; false if it cannot */
void saveWhole(const String& filename, const std::function<bool(const String& path)>& write);

//! A new file of what `write` writes, complete, or as it was before; its extension chooses the format. Throws StsError.
void saveStorage(const String& filename, const std::function<void(FileStorage&)>& write);

}} // namespace

#endif // OPENCV_REFRACT_STORAGE_HPP
