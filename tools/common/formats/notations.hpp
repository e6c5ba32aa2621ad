// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_NOTATIONS_HPP
#define REFRACT_TOOLS_NOTATIONS_HPP

#include "console/json.hpp"

/* Names and values as other programs write them, as a tree. */
namespace tools {

/** MATLAB's file of variables (level 5, as save -v6 and -v7 write it): numbers by name, matrices as lists of rows, structs as
objects. In place of an object of a class stands the text "object"; cells are passed over. Throws Failure. */
Json readMat(const std::string& bytes);

/** NumPy's archive of arrays, as savez and savez_compressed write it: its numbers by name, each array as lists of rows; arrays
of objects and texts are passed over. Throws Failure. */
Json readNpz(const std::string& bytes);

/** YAML as programs write numbers with it: maps, lists, both in either style, numbers and texts. cv::FileStorage takes only what OpenCV
writes: a heading, and lists that are indented. Tags are passed over; anchors, and texts of several lines, are refused.
Throws Json::Error that names the line. */
Json readYaml(const std::string& text);

} // namespace tools

#endif // REFRACT_TOOLS_NOTATIONS_HPP
