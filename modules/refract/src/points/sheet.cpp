// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/sheet.hpp"

namespace cv { namespace refract {

namespace {

//! The coordinate that is missing, some way from the principal point.
void complete(const Camera& camera, double side, int n, const double* u, const double* v, double* fullU, double* fullV)
{
    const double BESIDE = 1./16;            // of the focal length
    const std::vector<double> lens = camera.lens().parameters();        // fx, fy, cx, cy, ...
    for (int i = 0; i < n; i++)
    {
        fullU[i] = std::isnan(u[i]) && !std::isnan(v[i]) ? lens[2] + side*BESIDE*lens[0] : u[i];
        fullV[i] = std::isnan(v[i]) && !std::isnan(u[i]) ? lens[3] + side*BESIDE*lens[1] : v[i];
    }
}

} // namespace

void unprojectSheets(const Camera& camera, int n, const double* u, const double* v, Sheets& sheets, uchar* status)
{
    const double NaN = std::numeric_limits<double>::quiet_NaN();
    double fullU[BLOCK], fullV[BLOCK];
    complete(camera, -1, n, u, v, fullU, fullV);
    camera.unproject(n, fullU, fullV, sheets, status);
    Rays other;
    uchar ofOther[BLOCK];
    for (int i = 0; i < n; i++)             // what counts as failed is not asked for its reason
        ofOther[i] = std::isnan(u[i]) == std::isnan(v[i]) ? (uchar)REFRACT_TOO_FEW_VIEWS : status[i];
    complete(camera, 1, n, u, v, fullU, fullV);
    camera.unproject(n, fullU, fullV, other, ofOther);
    double* const normal = sheets.normal;
    pointKernels().normals(n, sheets.dx, sheets.dy, sheets.dz, other.dx, other.dy, other.dz, normal, normal + BLOCK, normal + 2*BLOCK);
    for (int i = 0; i < n; i++)
    {
        if (ofOther[i] == REFRACT_OK)
            continue;
        normal[i] = normal[BLOCK + i] = normal[2*BLOCK + i] = NaN;
        if (std::isnan(u[i]) != std::isnan(v[i]) && status[i] == REFRACT_OK)
            status[i] = ofOther[i];
    }
}

namespace {

//! Which coordinate the camera sees of the block's halves; -1: not the same of all.
int knownCoordinate(const PixelBlock& block, int c, int n)
{
    int known = -1;
    for (int i = 0; i < n; i++)
    {
        if (!block.isHalf(c, i))
            continue;
        const int own = std::isnan(block.pixel(2*c)[i]);
        if (known == 1 - own)
            return -1;
        known = own;
    }
    return known;
}

} // namespace

void slideToSheet(const PlacedCamera& camera, int c, const CameraRays& rays, int n, PixelBlock& block, double* off)
{
    const int STEPS = 3;
    const double DONE = 1e-11, SHRINK = 0.1, LEAST = 0.01;      // pixels; of what a step moves
    const double SINE = 1e-16;                                  // squared, of a ray that is not in the sheet
    const int known = knownCoordinate(block, c, n);
    if (known < 0)
        return;
    const Vec3d none;
    double dx[BLOCK], dy[BLOCK], dz[BLOCK], x[BLOCK], y[BLOCK], z[BLOCK], s[BLOCK] = {}, error[STEPS][BLOCK], sine[BLOCK];
    double pixels[2*BLOCK], derivatives[6*BLOCK];
    const Columns byPoint = { derivatives, 3, BLOCK }, unwanted = { NULL, 0, 0 }, gradient = { byPoint.at(known, 0), 3, BLOCK };
    std::copy(rays.dx, rays.dx + n, dx); std::copy(rays.dy, rays.dy + n, dy); std::copy(rays.dz, rays.dz + n, dz);
    pointKernels().transform(camera.place.R.val, none.val, n, dx, dy, dz);
    std::copy(block.x, block.x + n, x); std::copy(block.y, block.y + n, y); std::copy(block.z, block.z + n, z);
    pointKernels().transform(camera.place.R.val, camera.place.t.val, n, x, y, z);
    uchar status[BLOCK];
    for (int i = 0; i < n; i++)
        status[i] = block.isHalf(c, i) ? block.status[i] : (uchar)REFRACT_TOO_FEW_VIEWS;
    for (int k = 0; k < STEPS; k++)
    {
        double hereX[BLOCK], hereY[BLOCK], hereZ[BLOCK];
        for (int i = 0; i < n; i++)
        {
            hereX[i] = x[i] + s[i]*dx[i]; hereY[i] = y[i] + s[i]*dy[i]; hereZ[i] = z[i] + s[i]*dz[i];
        }
        camera.camera->projectJacobian(n, hereX, hereY, hereZ, pixels, pixels + BLOCK, byPoint, unwanted, status);
        pointKernels().slide(n, block.pixel(2*c + known), pixels + known*BLOCK, gradient, dx, dy, dz, s, error[k], sine);
    }
    for (int i = 0; i < n; i++)
    {
        const double first = error[0][i], second = error[1][i], third = error[2][i];        // squared
        if (status[i] != REFRACT_OK || !(third <= DONE*DONE || third <= SHRINK*SHRINK*second) || !(second <= first) || !(sine[i] > SINE))
            continue;
        block.x[i] += s[i]*rays.dx[i]; block.y[i] += s[i]*rays.dy[i]; block.z[i] += s[i]*rays.dz[i];
        // What the last step leaves is the square of what it moved, over that of the step before, which left it.
        const double left = second > 0 ? std::sqrt(third)*(third/second) : 0;
        off[i] = left <= DONE || third <= DONE*DONE ? 0 : std::max(SHRINK*std::sqrt(third), LEAST);
    }
}

}} // namespace
