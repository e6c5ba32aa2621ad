// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MEASURED_VIEWS_HPP
#define REFRACT_TOOLS_MEASURED_VIEWS_HPP

#include "calibrate/calib_file.hpp"
#include "calibrate/rig_data.hpp"
#include "console/cli.hpp"
#include "formats/point_table.hpp"

/* What refract_measure measures: targets in images, or points of a table. */
namespace tools {

struct MeasuredFiles
{
    std::string calibration;            //!< for errors
    std::vector<std::string> images;    //!< of each camera; empty: it took none
    std::string points;                 //!< of a table, in place of images
    std::string viewPattern;
    PixelOrigin origin;
};

//! A view, and the names of its points.
struct MeasuredView : View
{
    std::vector<std::string> ids;
};

//! In the light that the calibration is of. @param triangulates single images of all cameras are of one moment, whatever their names
RigImages readGlassImages(const MeasuredFiles& files, bool triangulates, const Calibration& calibration, const Target* target, bool quiet);

/** Throws Failure if there is none.
@param triangulates what fewer than two cameras see is left out
@param target null: points.csv are images. @param command warns of what is skipped */
std::vector<MeasuredView> readMeasuredViews(const MeasuredFiles& files, bool triangulates, const Calibration& calibration,
                                            const Target* target, const Command& command);

} // namespace tools

#endif // REFRACT_TOOLS_MEASURED_VIEWS_HPP
