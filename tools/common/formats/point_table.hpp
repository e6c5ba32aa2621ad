// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_POINT_TABLE_HPP
#define REFRACT_TOOLS_POINT_TABLE_HPP

#include "console/csv.hpp"
#include "console/options.hpp"

namespace tools {

//! What tables of other programs leave open.
struct PixelOrigin
{
    std::string yFrom;                  //!< --y-from: "top" or "bottom"; empty: not said
    std::vector<cv::Size> images;       //!< of the cameras; y from the bottom needs their heights
};
Option addYFrom(OptionParser& parser, std::string& yFrom);

/** A table of points that several cameras saw: [image,]id,u1,v1,u2,v2,..., one row a point; or what other programs write, told by its
heading, which becomes the former (image is the frame; other columns are left out):
- OpenLPT, one row an observation: frame,cam_id,pt_idx,x,y, cameras numbered from 0;
- DLTdv and Argus, one row a frame: pt1_cam1_X,pt1_cam1_Y,pt1_cam2_X,...; pixels count from 1, y from where `origin` says;
- DeepLabCut, as AniPose takes it: a file for each camera, its name with %d in place of the number (from 0 or 1); below a likelihood of
  0.6 a point was not seen;
- OpenPTV's targets of one frame: a file for each camera, as before; points are those with a number of correspondence, pixels count from
  the corner of the first.
Throws Failure as CsvTable does, and where `origin` says from where y counts in a table of which that is known.
@param required columns of the former; @param what the file is, for the text where one is missing */
CsvTable readPointTable(const std::string& path, const std::vector<std::string>& required, const std::string& what,
                        const PixelOrigin& origin = PixelOrigin());

} // namespace tools

#endif // REFRACT_TOOLS_POINT_TABLE_HPP
