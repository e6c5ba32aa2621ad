// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_MAP_HPP
#define OPENCV_REFRACT_MAP_HPP

#include "arrays/arrays.hpp"
#include "camera/camera.hpp"
#include <functional>

namespace cv { namespace refract {

//! The image that a pinhole at a place of its own would take of a plane.
struct PinholeView
{
    const Camera& camera;       //!< behind its window, which really took the image
    Matx33d newToCamera;        //!< new pixels -> directions, camera frame
    Vec3d centre;               //!< of the pinhole, camera frame
    Vec4d plane;                //!< what it sees, camera frame

    /** New pixel -> homogeneous point on the plane -> raw pixel; at most a block.
    @param planeD plane[3] of each pixel, or null */
    void toRaw(int n, const double* column, const double* row, const double* planeD, double* u, double* v, uchar* status) const;
};

//! Maps for cv::remap, as initRefractiveUndistortRectifyMap.
void mapPlane(const PinholeView& view, Size size, int m1type, OutputArray map1, OutputArray map2);

/** The same where each pixel has a plane of its own.
@param planeD one row of them: (row, first column, how many, where to) */
typedef std::function<void(int, int, int, double*)> PlaneReader;
void mapSurface(const PinholeView& view, const PlaneReader& planeD, Size size, int m1type, OutputArray map1, OutputArray map2);

//! The scene of a map: one number z, or four numbers of a plane.
Vec4d scenePlane(InputArray depth, bool isNeeded, const char* name);

//! No window and a lens of OpenCV: calib3d's own case.
inline bool isPlainOpenCV(const Camera& camera) { return !camera.refracts() && camera.lensModel() == "opencv"; }

Matx33d inverseCameraMatrix(const Matx33d& K, const char* name);

}} // namespace

#endif // OPENCV_REFRACT_MAP_HPP
