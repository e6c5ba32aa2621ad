// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/map.hpp"
#include "points/plane.hpp"

namespace cv { namespace refract {

Vec4d scenePlane(InputArray depth, bool isNeeded, const char* name)
{
    const double infinity = std::numeric_limits<double>::infinity();
    const DepthReader d(depth, name, 1, isNeeded);
    if (d.size() == 1)
        return planeOfDepth(d.at(0), name);
    if (d.size() != 4)
        CV_Error_(Error::StsBadSize, ("%s has %d values; it must have 1 (z) or 4 (a plane)", name, d.size()));
    const Vec4d plane(d.at(0), d.at(1), d.at(2), d.at(3));
    checkPlane(plane, name);
    return plane[3] == -infinity ? -plane : plane;
}

Matx33d inverseCameraMatrix(const Matx33d& K, const char* name)
{
    if (determinant(K) == 0)
        CV_Error_(Error::StsBadArg, ("%s is singular", name));
    return K.inv();
}

//! The pinhole at the camera's centre of projection.
static PinholeView centralView(const Camera& cam, const Vec4d& plane, InputArray R, InputArray newCameraMatrix)
{
    const Matx33d K = newCameraMatrix.empty() ? Matx33d(cam.cameraMatrix().ptr<double>())
                                              : readProjection(newCameraMatrix, "newCameraMatrix");
    return { cam, readRotationOrNone(R, "R").t()*inverseCameraMatrix(K, "newCameraMatrix"), Vec3d(), plane };
}

void initRefractiveUndistortRectifyMap(const Ptr<RefractiveCamera>& camera, InputArray depth, InputArray R,
                                       InputArray newCameraMatrix, Size size, int m1type, OutputArray map1, OutputArray map2)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    mapPlane(centralView(cam, scenePlane(depth, cam.refracts(), "depth"), R, newCameraMatrix), size, m1type, map1, map2);
}

void initRefractiveUndistortRectifyMap(InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
                                       InputArray depth, InputArray R, InputArray newCameraMatrix, Size size,
                                       int m1type, OutputArray map1, OutputArray map2)
{
    initRefractiveUndistortRectifyMap(RefractiveCamera::create(cameraMatrix, distCoeffs, window), depth, R,
                                      newCameraMatrix, size, m1type, map1, map2);
}

}} // namespace
