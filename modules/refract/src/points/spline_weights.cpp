// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/arrays.hpp"
#include "camera/camera.hpp"
#include "points/point_kernels.hpp"

namespace cv { namespace refract {

void refractiveSplineWeights(InputArray objectPoints, InputArray rvec, InputArray tvec, const Ptr<RefractiveCamera>& camera,
                             OutputArray controls, OutputArray weights, OutputArray status)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    const Lens& lens = cam.lens();
    const int count = lens.controlsPerPixel();
    if (count == 0)
        CV_Error(Error::StsBadArg, "camera has the lens " + lens.model() + ", which has no control points: only "
                                   "LENSMODEL_SPLINED_STEREOGRAPHIC_... has them");
    const PointReader in(objectPoints, 3, "objectPoints");
    const Matx33d R = readRotation(rvec, "rvec");
    const Vec3d t = readVec3(tvec, "tvec");
    controls.create(in.size(), count, CV_32S);
    weights.create(in.size(), count, CV_64F);
    Mat which = controls.getMat(), weight = weights.getMat();
    StatusWriter outStatus(status, in.size());
    forEachBlock(in.size(), 4*POINT_COST, [&](int begin, int n)
    {
        double x[BLOCK], y[BLOCK], z[BLOCK], u[BLOCK], v[BLOCK];
        uchar st[BLOCK];
        in.load(begin, n, x, y, z, st);
        pointKernels().transform(R.val, t.val, n, x, y, z);
        cam.project(n, x, y, z, NULL, u, v, st);
        lens.unproject(n, u, v, x, y, z, st);       // the direction at the lens
        for (int i = 0; i < n; i++)
        {
            int* const row = which.ptr<int>(begin + i);
            if (st[i] == REFRACT_OK)
                lens.controlsOf(Vec3d(x[i], y[i], z[i]), row, weight.ptr<double>(begin + i));
            else
            {
                std::fill(row, row + count, -1);
                weight.row(begin + i).setTo(std::numeric_limits<double>::quiet_NaN());
            }
        }
        outStatus.store(begin, n, st);
    });
}

}} // namespace
