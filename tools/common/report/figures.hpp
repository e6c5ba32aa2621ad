// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FIGURES_HPP
#define REFRACT_TOOLS_FIGURES_HPP

#include "assess/findings.hpp"
#include "assess/rig_calibration.hpp"
#include "report/page_template.hpp"

/* The report's pictures, one function each, as SVG text. A picture whose scale needs words returns them beside it. */
namespace tools {

struct Figure
{
    std::string svg;
    std::string note;       //!< scale and exaggeration, half a sentence
};

//! Section through camera, window and boards: axis 0 = seen from above (x-z), 1 = from the side (y-z). To scale.
Figure drawSideView(const RigCalibration& calibration, int camera, int axis);

//! All cameras, windows and points from one side, obliquely from above. @param azimuthDeg 0: from behind the cameras, 90: from the right
Figure drawRig(const RigCalibration& calibration, double azimuthDeg);

//! Expected error of a measured point over the image of camera 1. @param scale of the colours, that all maps of a report share
Figure drawErrorMap(const RigCalibration& calibration, const ErrorMap& map, cv::Vec2d scale);

//! From the best point of all maps to what 95 % of the worst map's points are within; NaN where nothing is seen.
cv::Vec2d commonScale(const std::vector<ErrorMap>& maps);

//! The same over the range: worst, typical, of pixel noise alone, and the limits.
Figure drawErrorOverRange(const RigCalibration& calibration, const Assessment& assessment);

/* The figures of the report as its template takes them: each with a title, and how to read it. Each makes a step of progress. */

class Progress;

//! Of one camera.
std::vector<Json> figuresOf(const RigCalibration& calibration, int camera, Progress& progress);

//! The rig from two sides.
std::vector<Json> rigFigures(const RigCalibration& calibration, Progress& progress);

Json errorOverRange(const RigCalibration& calibration, const Assessment& assessment, Progress& progress);

//! Over the image, at each range.
void addErrorMaps(std::vector<Json>& list, const RigCalibration& calibration, const Assessment& assessment, Progress& progress);

/* Small copies of the images with the detected points, as some mistakes are seen at once in an image and in no number. */

//! A small JPEG of an image with dots on its points, for the src of an <img>.
struct Thumbnail
{
    std::string uri;            //!< "data:image/jpeg;base64,..."
    std::string caption;
    bool suspect;               //!< no target found, or points left out
};

//! Colours of points in CSS, and how far these lie from where the calibration puts them, in words.
struct PhotoScale
{
    std::string colour, name;
};
std::vector<PhotoScale> photoScale(const RigCalibration& calibration);

/** The images for the page, in their order: all of them, or of very many those to look at first, which are
images without target or with points left out, then those whose points lie farthest off. */
std::vector<Photo> photosToShow(const RigCalibration& calibration);

//! Throws Failure if the image cannot be read any more.
Thumbnail makeThumbnail(const RigCalibration& calibration, const Photo& photo);

} // namespace tools

#endif // REFRACT_TOOLS_FIGURES_HPP
