// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/pixel_block.hpp"

namespace cv { namespace refract {

uchar projectIntoAll(const PlacedCameras& cameras, const PixelBlock& block, int i, const Vec3d& X, PointImages& images,
                     std::vector<std::vector<double> >* parameters)
{
    images.errors.setZero();
    images.byPoint.setZero();
    for (int c = 0; c < (int)cameras.size(); c++)
    {
        if (!block.isSeen(c, i))
            continue;
        Vec2d pixel;
        Matx23d J;
        const uchar status = cameras[c].camera->projectJacobian(cameras[c].place.apply(X), pixel, J.val,
                                                                parameters ? (*parameters)[c].data() : NULL);
        if (status != REFRACT_OK)
            return status;
        J = J*cameras[c].place.R;
        for (int k = 0; k < 2; k++)
        {
            images.errors[2*c + k] = pixel[k] - block.pixel(2*c + k)[i];
            images.byPoint.row(2*c + k) << J(k, 0), J(k, 1), J(k, 2);
        }
    }
    return REFRACT_OK;
}

static bool isBeyondAll(const PlacedCameras& cameras, const PixelBlock& block, int i)
{
    const Vec3d X(block.x[i], block.y[i], block.z[i]);
    for (int c = 0; c < (int)cameras.size(); c++)
    {
        const Vec3d Y = c > 0 ? cameras[c].place.apply(X) : X;
        if (!cameras[c].camera->layers().isBeyond(Y[0], Y[1], Y[2]) && block.isSeen(c, i))
            return false;
    }
    return true;
}

void checkBeyond(const PlacedCameras& cameras, PixelBlock& block, int n)
{
    for (int i = 0; i < n; i++)
        if (block.status[i] == REFRACT_OK && !isBeyondAll(cameras, block, i))
            block.status[i] = REFRACT_BEHIND_WINDOW;
}

}} // namespace
