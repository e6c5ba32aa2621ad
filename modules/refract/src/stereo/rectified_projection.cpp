// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "stereo/rectified_projection.hpp"
#include "points/map.hpp"

namespace cv { namespace refract {

RectifiedProjection::RectifiedProjection(InputArray P, const char* name)
{
    const std::vector<double> p = readNumbers(P, name);
    const Size size = P.size();
    if (p.size() != 12 || size != Size(4, 3))
        CV_Error_(Error::StsBadSize, ("%s is %dx%d; it must be 3x4, as refractiveStereoRectify gives it", name, size.height,
                                      size.width));
    const Matx34d matrix(p.data());
    K = matrix.get_minor<3, 3>(0, 0);
    inverseK = inverseCameraMatrix(K, name);
    centre = -(inverseK*Vec3d(matrix(0, 3), matrix(1, 3), matrix(2, 3)));
}

int axisOf(const RectifiedProjection& first, const RectifiedProjection& second)
{
    const Vec3d base = second.centre - first.centre;
    const int axis = std::abs(base[0]) >= std::abs(base[1]) ? 0 : 1;
    if (base[axis] == 0)
        CV_Error(Error::StsBadArg, "P1 and P2 have the same centre of projection");
    return axis;
}

}} // namespace
