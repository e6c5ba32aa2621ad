// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_VIEWS_HPP
#define OPENCV_REFRACT_VIEWS_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

//! One array of pixels per view; NaN = not seen, empty = no image.
typedef std::vector<std::vector<Point2d> > PixelViews;

//! What one camera saw. Both have one entry per view.
struct CameraViews
{
    PixelViews direct, refracted;
};

//! A calibrator's input: views of targets by one or more cameras.
struct RigViews
{
    std::vector<std::vector<Point3d> > object;
    std::vector<CameraViews> cameras;
    int count() const { return (int)object.size(); }
};

//! An array of arrays of pixels; noArray() or an empty array gives no views.
PixelViews readPixelViews(InputArrayOfArrays a, const char* name);
//! An array of arrays of finite 3-D points.
std::vector<std::vector<Point3d> > readObjectViews(InputArrayOfArrays a, const char* name);

/** What one camera saw. An optional argument that is absent becomes one empty view per target; every view's size is checked
against its target's. Throws with the argument's name. */
CameraViews readCameraViews(InputArrayOfArrays direct, const char* directName,
                            InputArrayOfArrays refracted, const char* refractedName,
                            const std::vector<std::vector<Point3d> >& object);

inline bool isSeen(const Point2d& pixel) { return std::isfinite(pixel.x) && std::isfinite(pixel.y); }

//! How many points of one image were seen.
int countSeen(const std::vector<Point2d>& pixels);

//! True if any view has a point that was seen.
bool seesAnything(const PixelViews& views);

//! What one camera saw of one target in one image.
struct ImagePoints
{
    std::vector<Point3d> object;    //!< object coordinates
    std::vector<Point2d> pixel;
    std::vector<int> index;         //!< in the target
};

//! Drops the points that were not seen (NaN).
ImagePoints observed(const std::vector<Point3d>& object, const std::vector<Point2d>& pixels);

}} // namespace

#endif // OPENCV_REFRACT_VIEWS_HPP
