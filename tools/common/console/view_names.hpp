// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_VIEW_NAMES_HPP
#define REFRACT_TOOLS_VIEW_NAMES_HPP

#include <string>
#include <vector>

/* What images of one moment are found by, for all tools: equal names. */
namespace tools {

class Option;
class OptionParser;

//! The stems of files; where two are equal, their folders too, as far as these differ: 0001/left, 0002/left.
std::vector<std::string> viewNames(const std::vector<std::string>& paths);

/** Where no two cameras have a name in common, what is left of each when the camera's own part is taken off: the text that all names of
the camera begin or end with, but for digits that count moments. left01, right01; 201_02, 202_02; 0001/left, 0001/right. The names
stay as they are where some are equal already, or fewer than two would be: of counters that differ, IMG_041 ... IMG_058 and DSC_058 ...
DSC_075, one number may be the same. Of one moment are also the images of cameras that have one each.
@param names of the images of each camera, which are changed */
void takeOffCameras(std::vector<std::vector<std::string>>& names);

/** The moment of a file as --view-pattern says it: {} stands for it, * for anything, as in cam*_{}_raw; of the file's name without its
extension, and of as many folders as the pattern has. The first * take as little, and {} as much as there is. Empty: the name is not of
this form. */
std::string momentOf(const std::string& path, const std::string& pattern);

//! --view-pattern
Option addViewPattern(OptionParser& parser, std::string& pattern);

//! Of all images of a camera. Throws Failure where the pattern has no {}, or where a name is not of it or says a moment again.
std::vector<std::string> momentsByPattern(const std::vector<std::string>& paths, const std::string& pattern);

} // namespace tools

#endif // REFRACT_TOOLS_VIEW_NAMES_HPP
