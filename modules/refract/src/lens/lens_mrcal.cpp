// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens/lens.hpp"

/* mrcal's lens models by name. PINHOLE and OPENCV4, 5, 8, 12 are OpenCV's model with that many coefficients; the
intrinsics are fx, fy, cx, cy and the coefficients in OpenCV's order. */

namespace cv { namespace refract {

Ptr<Lens> makeMrcalLens(const String& model, const std::vector<double>& intrinsics)
{
    const struct { const char* name; size_t coefficients; } models[] = {
        { "LENSMODEL_PINHOLE", 0 }, { "LENSMODEL_OPENCV4", 4 }, { "LENSMODEL_OPENCV5", 5 },
        { "LENSMODEL_OPENCV8", 8 }, { "LENSMODEL_OPENCV12", 12 } };
    for (const auto& m : models)
    {
        if (model != m.name)
            continue;
        if (intrinsics.size() != 4 + m.coefficients)
            CV_Error_(Error::StsBadArg, ("intrinsics has %d values; %s has %d", (int)intrinsics.size(), m.name,
                                         (int)(4 + m.coefficients)));
        for (size_t i = 0; i < intrinsics.size(); i++)
            if (!std::isfinite(intrinsics[i]) || (i < 2 && !(intrinsics[i] > 0)))
                CV_Error_(Error::StsBadArg, ("intrinsics[%d] is %g; focal lengths must be positive, all finite",
                                             (int)i, intrinsics[i]));
        const double* p = intrinsics.data();
        return makeOpenCVLens(Matx33d(p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1),
                              std::vector<double>(intrinsics.begin() + 4, intrinsics.end()), model);
    }
    CV_Error_(Error::StsBadArg, ("lensModel is %s; known are LENSMODEL_PINHOLE and LENSMODEL_OPENCV4, 5, 8, 12",
                                 model.c_str()));
}

}} // namespace
