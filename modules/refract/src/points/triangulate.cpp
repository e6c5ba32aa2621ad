// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/triangulate.hpp"
#include "points/image_reader.hpp"
#include "points/point_kernels.hpp"
#include "points/sheet.hpp"

/* Refracted rays of two or more cameras -> a point. The point nearest to all rays is the start; the maximum-likelihood point
minimises the sum of squared pixel errors in all raw images, by Gauss-Newton with exact derivatives. */

namespace cv { namespace refract {

namespace {

//! Brings rays from the frame of their camera to that of camera 1.
CameraRays inFrame1(const PlacedCamera& placed, bool isFirst, const double* seen, int n, Rays& r)
{
    const RigidTransform& place = placed.place;
    const Matx33d back = place.R.t();
    const Vec3d axis = back*placed.camera->layers().normal(), centre = -(back*place.t), none;
    if (!isFirst)
        pointKernels().transform(back.val, none.val, n, r.dx, r.dy, r.dz);
    if (!isFirst && r.hasOffset)
        pointKernels().transform(back.val, none.val, n, r.offset, r.offset + BLOCK, r.offset + 2*BLOCK);
    return { seen, r.tau, r.dx, r.dy, r.dz, { axis[0], axis[1], axis[2] }, { centre[0], centre[1], centre[2] }, r.offsets(),
             { NULL, 0, 0 } };
}

CameraRays raysOf(const PlacedCameras& cameras, int c, PixelBlock& block, int n, Rays& r)
{
    forSeen(block, c, n, block.status, [&](uchar* status)
    { cameras[c].camera->unproject(n, block.pixel(2*c), block.pixel(2*c + 1), r, status); });
    return inFrame1(cameras[c], c == 0, block.pixel(2*c), n, r);
}

//! Rays of a camera that sees halves of some points.
struct SheetRays
{
    Sheets sheets;
    double seen[BLOCK];
};

CameraRays raysOf(const PlacedCameras& cameras, int c, PixelBlock& block, int n, SheetRays& r)
{
    forSeen(block, c, n, block.status, [&](uchar* status)
    { unprojectSheets(*cameras[c].camera, n, block.pixel(2*c), block.pixel(2*c + 1), r.sheets, status); });
    for (int i = 0; i < n; i++)
        r.seen[i] = block.isSeen(c, i) ? 0 : std::numeric_limits<double>::quiet_NaN();
    CameraRays rays = inFrame1(cameras[c], c == 0, r.seen, n, r.sheets);
    rays.sheet = { r.sheets.normal, 3, BLOCK };
    const Matx33d back = cameras[c].place.R.t();
    if (c > 0)
        pointKernels().transform(back.val, Vec3d().val, n, r.sheets.normal, r.sheets.normal + BLOCK, r.sheets.normal + 2*BLOCK);
    return rays;
}

//! Lines of rays that leave a round window have come in through its far side: a point there is none that is seen.
void checkWayOut(const PlacedCamera& placed, int c, const Rays& rays, int n, PixelBlock& block)
{
    const Surface& own = placed.camera->layers().lastSurface();
    if (!(own.curvature > 0))
        return;
    const Surface last = inFrame(own, placed.place.R.val, placed.place.t.val);
    for (int i = 0; i < n; i++)
        if (block.status[i] == REFRACT_OK && block.isSeen(c, i) &&
            !isBeyondAlong(last, block.x[i], block.y[i], block.z[i], 1., rays.dx[i], rays.dy[i], rays.dz[i]))
            block.status[i] = REFRACT_BEHIND_WINDOW;
}

//! The points nearest to all rays. @param off by how many pixels they are off at most; 0: they are the most likely ones
void meet(const PlacedCameras& cameras, PixelBlock& block, int n, double* off)
{
    const double OFF_WHOLE = 1, OFF_HALVES = 300;       // pixels that see one point; sheets are no planes, but taken for such
    const double PARALLEL = 0.5e-24;
    AutoBuffer<Rays, 4> buffers(cameras.size());
    AutoBuffer<CameraRays, 16> rays(cameras.size());
    std::vector<SheetRays> sheets;      // few cameras have any
    sheets.reserve(std::count(block.hasHalves.data(), block.hasHalves.data() + cameras.size(), (uchar)true));
    double apart[BLOCK], nearest[BLOCK];
    int count = 0, half = -1, whole = -1;
    for (int c = 0; c < (int)cameras.size(); c++)
    {
        if (block.sees[c] == PixelBlock::NONE)
            continue;
        if (block.hasHalves[c])
            sheets.push_back(SheetRays());
        (block.hasHalves[c] ? half : whole) = c;
        rays[count++] = block.hasHalves[c] ? raysOf(cameras, c, block, n, sheets.back()) : raysOf(cameras, c, block, n, buffers[c]);
    }
    for (int i = 0; i < n; i++)
        off[i] = half >= 0 && block.hasHalf(i) ? OFF_HALVES : OFF_WHOLE;
    if (count == 0)
        return;
    pointKernels().meetRays(n, count, rays.data(), block.x, block.y, block.z, apart, nearest);
    for (int i = 0; i < n; i++)
        if (block.status[i] == REFRACT_OK)
            block.status[i] = !(apart[i] > PARALLEL) ? REFRACT_PARALLEL_RAYS
                              : !(nearest[i] > 0) ? REFRACT_NO_INTERSECTION : REFRACT_OK;
    for (int c = 0; c < (int)cameras.size(); c++)
        if (block.sees[c] != PixelBlock::NONE && !block.hasHalves[c])
            checkWayOut(cameras[c], c, buffers[c], n, block);
    if (count == 2 && half >= 0 && whole >= 0)
        slideToSheet(cameras[half], half, rays[whole < half ? 0 : 1], n, block, off);
}

} // namespace

void checkSigma(double sigma, const char* name)
{
    if (!(sigma >= 0) || !std::isfinite(sigma))
        CV_Error_(Error::StsOutOfRange, ("%s is %g; it must be 0 or more", name, sigma));
}

void triangulateBlock(const PlacedCameras& cameras, PixelBlock& block, int n, int flags)
{
    double off[BLOCK];
    meet(cameras, block, n, off);
    if (flags == TRIANGULATE_MIDPOINT)
        checkBeyond(cameras, block, n);
    else
        refineBlock(cameras, block, n, off, 0);
}

namespace {

//! What the Extended forms tell of each point; what nobody asks for is not computed.
struct PointQuality
{
    PointQuality(const PlacedCameras& cameras, double pixelSigma, InputArray calibrationCovariance, OutputArray covariance,
                 OutputArray errors)
        : variance_(pixelSigma*pixelSigma), pointCovariance_(cameras, calibrationCovariance), covarianceOut_(covariance),
          errorsOut_(errors) { checkSigma(pixelSigma, "pixelSigma"); }
    void create(int points, int cameras)
    {
        if (covarianceOut_.needed())
            covariance_.create(points, 9, CV_64F);
        if (errorsOut_.needed())
            errors_.create(points, cameras, CV_64F);
    }
    void evaluate(const PlacedCameras& cameras, const PixelBlock& block, int begin, int n)
    {
        const Columns none = { NULL, 0, 0 };
        if (!covariance_.empty())
            pointCovariance_.evaluate(block, n, variance_, none, (Matx33d*)covariance_.ptr<double>(begin));
        if (!errors_.empty())
            reprojectionErrors(cameras, block, n, errors_.ptr<double>(begin));
    }
    void store() const
    {
        if (covarianceOut_.needed())
            covariance_.copyTo(covarianceOut_);
        if (errorsOut_.needed())
            errors_.copyTo(errorsOut_);
    }
private:
    double variance_;
    PointCovariance pointCovariance_;
    OutputArray covarianceOut_, errorsOut_;
    Mat covariance_, errors_;       //!< one row a point
};

/** @param mayMiss NaN: not seen, rather than no number
@param quality may be null */
void triangulate(const PlacedCameras& cameras, const ImageReader& images, bool mayMiss, OutputArray points3D,
                 OutputArray status, int flags, PointQuality* quality)
{
    const double cost = (quality ? 25 : 8)*POINT_COST;
    if (flags != TRIANGULATE_OPTIMAL && flags != TRIANGULATE_MIDPOINT)
        CV_Error_(Error::StsBadFlag, ("flags is %d; it must be TRIANGULATE_OPTIMAL or TRIANGULATE_MIDPOINT", flags));
    if (quality)
        quality->create(images.size(), images.cameras());
    PointWriter out(points3D, images.size(), 3, images.depth());
    StatusWriter outStatus(status, images.size());
    forEachBlock(images.size(), cost, [&](int begin, int n)
    {
        PixelBlock block(images.cameras());
        if (mayMiss)
            images.loadSeen(begin, n, flags == TRIANGULATE_OPTIMAL, block);
        else
            images.load(begin, n, block);
        out.prepare(begin, n);
        triangulateBlock(cameras, block, n, flags);
        if (quality)
            quality->evaluate(cameras, block, begin, n);
        out.store(begin, n, block.x, block.y, block.z, block.status);
        outStatus.store(begin, n, block.status);
    });
}

ImageReader readPair(InputArray points1, InputArray points2)
{
    ImageReader images;
    images.add(points1, "points1");
    images.add(points2, "points2");
    return images;
}

ImageReader readImages(InputArrayOfArrays imagePoints, size_t cameras)
{
    std::vector<Mat> lists;
    ImageReader images;
    if (!imagePoints.empty())
        imagePoints.getMatVector(lists);
    if (lists.size() != cameras)
        CV_Error_(Error::StsUnmatchedSizes, ("imagePoints has %d elements; cameras has %d", (int)lists.size(), (int)cameras));
    for (size_t c = 0; c < cameras; c++)
        images.add(lists[c], numbered("imagePoints", (int)c));
    return images;
}

PlacedCameras readCameras(const std::vector<Ptr<RefractiveCamera> >& handles, InputArrayOfArrays Rs, InputArrayOfArrays Ts)
{
    if (handles.empty())
        CV_Error(Error::StsBadArg, "cameras is empty; two are needed to see a point");
    const std::vector<RigidTransform> places = readExtrinsics(Rs, Ts, (int)handles.size());
    PlacedCameras cameras;
    for (int c = 0; c < (int)handles.size(); c++)
        cameras.push_back(PlacedCamera(cameraOf(handles[c], numbered("cameras", c).c_str()), places[c]));
    return cameras;
}

} // namespace

void triangulateRefractive(const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
                           InputArray R, InputArray T, InputArray points1, InputArray points2,
                           OutputArray points3D, OutputArray status, int flags)
{
    CV_INSTRUMENT_REGION();

    const PlacedCameras cameras = StereoPair(cameraOf(camera1, "camera1"), cameraOf(camera2, "camera2"), R, T).cameras();
    triangulate(cameras, readPair(points1, points2), false, points3D, status, flags, NULL);
}

void triangulateRefractive(InputArray cameraMatrix1, InputArray distCoeffs1, const GlassWindow& window1,
                           InputArray cameraMatrix2, InputArray distCoeffs2, const GlassWindow& window2,
                           InputArray R, InputArray T, InputArray points1, InputArray points2,
                           OutputArray points3D, OutputArray status, int flags)
{
    triangulateRefractive(RefractiveCamera::create(cameraMatrix1, distCoeffs1, window1),
                          RefractiveCamera::create(cameraMatrix2, distCoeffs2, window2),
                          R, T, points1, points2, points3D, status, flags);
}

void triangulateRefractive(const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
                           InputArray R, InputArray T, InputArray points1, InputArray points2,
                           OutputArray points3D, OutputArray status, int flags,
                           double pixelSigma, InputArray calibrationCovariance, OutputArray covariance,
                           OutputArray reprojectionErrors)
{
    CV_INSTRUMENT_REGION();

    const PlacedCameras cameras = StereoPair(cameraOf(camera1, "camera1"), cameraOf(camera2, "camera2"), R, T).cameras();
    PointQuality quality(cameras, pixelSigma, calibrationCovariance, covariance, reprojectionErrors);
    triangulate(cameras, readPair(points1, points2), false, points3D, status, flags, &quality);
    quality.store();
}

void triangulateRefractive(const std::vector<Ptr<RefractiveCamera> >& handles, InputArrayOfArrays Rs, InputArrayOfArrays Ts,
                           InputArrayOfArrays imagePoints, OutputArray points3D, OutputArray status, int flags)
{
    CV_INSTRUMENT_REGION();

    const PlacedCameras cameras = readCameras(handles, Rs, Ts);
    triangulate(cameras, readImages(imagePoints, cameras.size()), true, points3D, status, flags, NULL);
}

void triangulateRefractive(const std::vector<Ptr<RefractiveCamera> >& handles, InputArrayOfArrays Rs, InputArrayOfArrays Ts,
                           InputArrayOfArrays imagePoints, OutputArray points3D, OutputArray status, int flags,
                           double pixelSigma, InputArray calibrationCovariance, OutputArray covariance,
                           OutputArray reprojectionErrors, InputArrayOfArrays pixelCovariances)
{
    CV_INSTRUMENT_REGION();

    const PlacedCameras cameras = readCameras(handles, Rs, Ts);
    PointQuality quality(cameras, pixelSigma, calibrationCovariance, covariance, reprojectionErrors);
    ImageReader images = readImages(imagePoints, cameras.size());
    images.readCovariances(pixelCovariances, imagePoints);
    triangulate(cameras, images, true, points3D, status, flags, &quality);
    quality.store();
}

}} // namespace
