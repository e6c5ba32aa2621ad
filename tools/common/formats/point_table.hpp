// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_POINT_TABLE_HPP
#define REFRACT_TOOLS_POINT_TABLE_HPP

#include "console/csv.hpp"

namespace tools {

/** A table of points that several cameras saw: [image,]id,u1,v1,u2,v2,..., one row a point; or one row an observation, as OpenLPT and
others write them: frame,cam_id,pt_idx,x,y, cameras numbered from 0, told by its heading. The latter becomes the former: image is the
frame, and other columns are left out. Throws Failure as CsvTable does, and for the tables of programs whose pixels are not known to count
from the middle of the first.
@param required columns of the former; @param what the file is, for the text where one is missing */
CsvTable readPointTable(const std::string& path, const std::vector<std::string>& required, const std::string& what);

} // namespace tools

#endif // REFRACT_TOOLS_POINT_TABLE_HPP
