// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MESH_FILE_HPP
#define REFRACT_TOOLS_MESH_FILE_HPP

#include "simulate/mesh.hpp"

#include <string>

namespace tools {

/** The triangles of a PLY or OBJ file; polygons become triangles, points and lines are left out. Coordinates are float32, as the
library that reads them has them.
@param name how errors call it: the file and the key that named it
Throws Failure if it cannot be read or holds no triangle. */
std::vector<Triangle> readTriangles(const std::string& path, const std::string& name);

} // namespace tools

#endif // REFRACT_TOOLS_MESH_FILE_HPP
