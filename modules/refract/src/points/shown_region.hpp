// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_SHOWN_REGION_HPP
#define OPENCV_REFRACT_SHOWN_REGION_HPP

#include "points/map.hpp"

namespace cv { namespace refract {

/** What of a plane a raw image shows, in the image of a pinhole of focal length 1: its places (x, y) at which a raw pixel is.

The region ends where the raw image ends, or before: where the lens folds back, where light is totally reflected, where the window
or the plane ends. For a new image all of which is valid a rectangle must be within it, whatever its shape. */
class ShownRegion
{
public:
    //! view: of focal length 1 (newToCamera is a rotation).
    ShownRegion(const PinholeView& view, Size imageSize);

    //! False: of some pixel on the border of the raw image nothing is shown.
    bool hasWholeBorder() const;

    /** A rectangle in which every place is shown: between the four sides of the raw image (as cv::getOptimalNewCameraMatrix has it)
    where that is all shown, else the largest part of it that is.
    @param size of the image that it is for: each pixel of its border is looked at
    @return false if there is none, or if nothing bounds it up to 89 degrees from the axis */
    bool findInner(Size size, Rect2d& inner) const;

    /** Round the places of all raw pixels that see a point of the plane.
    @return false if one of them is 89 degrees or more from the axis, where no pinhole shows anything, or if there is none */
    bool findOuter(Rect2d& outer) const;

private:
    enum Seen { SHOWN, NOTHING, BEHIND };
    struct Box;
    //! The places of raw pixels, at most a block.
    void placesOf(int n, const double* u, const double* v, Point2d* places, Seen* seen) const;
    std::vector<uchar> look(const std::vector<Point2d>& pixels, Box& box) const;
    std::vector<Point2d> pixelsAtEnds(Box& box) const;
    std::vector<uchar> areShown(const std::vector<Point2d>& places) const;
    bool isAllShown(const Rect2d& rectangle, Size size) const;
    bool findSeed(Point2d& seed) const;
    Rect2d betweenSides(const Point2d& seed) const;
    std::vector<Point2d> endsTowards(const Point2d& seed, const std::vector<Point2d>& targets) const;

    PinholeView view_;
    Matx33d cameraToNew_;
    Size size_;
    std::vector<Point2d> sides_[4];     //!< left, right, top, bottom: what is shown of them
};

/** By how much a rectangle round the principal point must grow until it covers the image or, if not, just fits; focal length in
px. NaN: the principal point is not in both. */
double scaleToImage(const Rect2d& r, const Vec2d& focal, const Point2d& principal, Size size, bool covers);

//! The pixels of an image within a rectangle of places.
Rect pixelsWithin(const Rect2d& r, const Vec2d& focal, const Point2d& principal, Size size);

}} // namespace

#endif // OPENCV_REFRACT_SHOWN_REGION_HPP
