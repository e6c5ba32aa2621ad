// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LAYOUT_HPP
#define OPENCV_REFRACT_LAYOUT_HPP

namespace cv { namespace refract {

/** Where each kind of a window's parameters begins, wherever they are a vector, columns of derivatives or a part of a
covariance. Made by windowLayout(), which alone decides on the order; read by kernels, so without OpenCV and functions. */
struct WindowLayout
{
    int shape;                  //!< a WindowShape
    int layers;
    int normal;                 //!< three; the distance follows, so that the first surface is in one piece; a dome's or tube's center
    int axis;                   //!< a tube's, three after its center; others: media
    int media;                  //!< all others
    int distance;               //!< a dome's or tube's radius
    int thickness, index;       //!< one per layer
    int innerIndex, outerIndex;
    int wedge;                  //!< two per layer, if the window has a wedge
    int curvature;              //!< one, if the window is bent
    int count;
};

}} // namespace

#endif // OPENCV_REFRACT_LAYOUT_HPP
