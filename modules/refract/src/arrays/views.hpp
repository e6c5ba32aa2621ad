// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_VIEWS_HPP
#define OPENCV_REFRACT_VIEWS_HPP

#include "arrays/whitening.hpp"

namespace cv { namespace refract {

//! One array of pixels per view; NaN = not seen, empty = no image. One coordinate NaN: half a pixel.
typedef std::vector<std::vector<Point2d> > PixelViews;
//! The same of their covariances; empty as a whole: all are usual ones.
typedef std::vector<PixelCovariances> CovarianceViews;

//! What one camera saw. Both have one entry per view.
struct CameraViews
{
    PixelViews direct, refracted;
    CovarianceViews directCovariances = {}, refractedCovariances = {};
};

//! A calibrator's input: views of targets by one or more cameras.
struct RigViews
{
    std::vector<std::vector<Point3d> > object;
    std::vector<CameraViews> cameras;
    double variance = 1;            //!< the median of all pixels' coordinates: what covariances are taken in units of
    int count() const { return (int)object.size(); }
};

//! Whether a call takes half pixels, or one NaN coordinate means that a point was not seen.
enum class HalfPixels { TAKEN, NOT_SEEN };

//! An array of arrays of pixels; noArray() or an empty array gives no views.
PixelViews readPixelViews(InputArrayOfArrays a, const char* name, HalfPixels halves = HalfPixels::NOT_SEEN);
//! Covariances of such pixels, a list as long as theirs or none.
CovarianceViews readCovarianceViews(const std::vector<Mat>& a, const PixelViews& pixels, const String& name);
//! An array of arrays of finite 3-D points.
std::vector<std::vector<Point3d> > readObjectViews(InputArrayOfArrays a, const char* name);

/** What one camera saw. An optional argument that is absent becomes one empty view per target; every view's size is checked
against its target's. Throws with the argument's name. */
CameraViews readCameraViews(InputArrayOfArrays direct, const char* directName,
                            InputArrayOfArrays refracted, const char* refractedName,
                            const std::vector<std::vector<Point3d> >& object, HalfPixels halves = HalfPixels::NOT_SEEN);

//! How many points of one image were seen.
int countSeen(const std::vector<Point2d>& pixels);
//! How many of them with both coordinates, so that they have rays.
int countWhole(const std::vector<Point2d>& pixels);

//! True if any view has a point that was seen.
bool seesAnything(const PixelViews& views);

//! What one camera saw of one target in one image.
struct ImagePoints
{
    std::vector<Point3d> object;    //!< object coordinates
    std::vector<Point2d> pixel;
    std::vector<int> index;         //!< in the target
    std::vector<Whitening> whitening;   //!< empty: all are whole, with usual covariances

    //! Of a point: predicted - observed, whitened.
    Vec2d error(size_t i, double u, double v) const
    {
        Vec2d e(u - pixel[i].x, v - pixel[i].y);
        if (!whitening.empty())
            whitening[i].apply(e[0], e[1]);
        return e;
    }
    int rowsOf(size_t i) const { return whitening.empty() ? 2 : whitening[i].rows(); }
    int rows() const;               //!< of all points: observed coordinates
};

//! Drops the points that were not seen (NaN). @param variance of a usual coordinate, in units of the covariances'
ImagePoints observed(const std::vector<Point3d>& object, const std::vector<Point2d>& pixels,
                     const PixelCovariances& covariances = PixelCovariances(), double variance = 1);

}} // namespace

#endif // OPENCV_REFRACT_VIEWS_HPP
