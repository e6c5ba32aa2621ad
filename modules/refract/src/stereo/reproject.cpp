// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "stereo/disparity.hpp"
#include "stereo/rectified_view.hpp"
#include "points/point_kernels.hpp"
#include "points/triangulate.hpp"

/* Disparity -> points: rectified pixels -> the raw pixels that the maps took them from -> two rays -> the most likely point.
Whatever error the rectification leaves, it costs matches, not accuracy. */

namespace cv { namespace refract {

namespace {

//! A pair with its rectification.
struct RectifiedPair
{
    StereoPair pair;
    PlacedCameras cameras;
    RectifiedView first, second;
    int axis;               //!< of the disparity
    double enough;          //!< see refineBlock

    //! disparity = perInverse()/distance from the pinholes + shift()
    double perInverse() const
    { return first.projection().K(0, 0)*(second.projection().centre - first.projection().centre)[axis]; }
    double shift() const { return first.projection().K(axis, 2) - second.projection().K(axis, 2); }
};

//! A run of pixels of one row that have a disparity.
struct Run
{
    Run() : size(0), pixels(2) {}
    int size, column[BLOCK];
    double disparity[BLOCK], x1[BLOCK], y1[BLOCK], x2[BLOCK], y2[BLOCK];
    PixelBlock pixels;
    uchar status2[BLOCK];
};

//! Raw pixels of places in a rectified image.
void toRaw(const RectifiedView& view, int n, const double* x, const double* y, double* u, double* v, uchar* status)
{
    double planeD[BLOCK];
    view.interpolate(n, x, y, planeD);
    view.pinhole().toRaw(n, x, y, planeD, u, v, status);
}

class Reprojector
{
public:
    //! Without covariance, sigma plays no part.
    Reprojector(const RectifiedPair& rectified, const PointCovariance* covariance, const Mat& sigma)
        : rectified_(rectified), covariance_(covariance), sigma_(sigma) {}

    void row(int y, int columns, const float* disparity, Mat& points, Mat& status, Mat& covariance) const
    {
        Run run;
        for (int x = 0; x < columns; x++)
        {
            if (std::isfinite(disparity[x]))
                add(run, x, y, disparity[x]);
            else
                status.at<uchar>(y, x) = REFRACT_NOT_FINITE;
            if (run.size == BLOCK || (x == columns - 1 && run.size > 0))
            {
                solve(run);
                store(run, y, points, status, covariance);
                run.size = 0;
            }
        }
    }

private:
    void add(Run& run, int x, int y, double disparity) const
    {
        const int i = run.size++;
        run.column[i] = x;
        run.disparity[i] = disparity;
        run.x1[i] = x;
        run.y1[i] = y;
        run.x2[i] = x - (rectified_.axis == 0 ? disparity : 0);
        run.y2[i] = y - (rectified_.axis == 1 ? disparity : 0);
    }

    void solve(Run& run) const
    {
        PixelBlock& p = run.pixels;
        toRaw(rectified_.first, run.size, run.x1, run.y1, p.pixel(0), p.pixel(1), p.status);
        toRaw(rectified_.second, run.size, run.x2, run.y2, p.pixel(2), p.pixel(3), run.status2);
        for (int i = 0; i < run.size; i++)
            if (p.status[i] == REFRACT_OK)
                p.status[i] = run.status2[i];
        double pinholesOff[BLOCK];
        std::fill(pinholesOff, pinholesOff + BLOCK, 10.);
        if (startAsPinholes(run))
            refineBlock(rectified_.cameras, p, run.size, pinholesOff, rectified_.enough);
        else
            triangulateBlock(rectified_.cameras, p, run.size, TRIANGULATE_OPTIMAL);
    }

    //! Points as the pinholes have them; false if one is too far away to be near the true one.
    bool startAsPinholes(Run& run) const
    {
        const double LEAST = 2;     // pixels of disparity, beside which what pinholes leave is small
        const RectifiedView& first = rectified_.first;
        const double perInverse = rectified_.perInverse(), shift = rectified_.shift();
        const Matx33d turn = first.R().t(), toDirection = turn*first.projection().inverseK;
        const Vec3d centre = turn*first.projection().centre;
        double distance[BLOCK];
        double *x = run.pixels.x, *y = run.pixels.y, *z = run.pixels.z;
        for (int i = 0; i < run.size; i++)
        {
            distance[i] = perInverse/(run.disparity[i] - shift);
            if (!(distance[i] > 0 && distance[i]*LEAST < std::abs(perInverse)))
                return false;
            x[i] = run.x1[i]*distance[i];
            y[i] = run.y1[i]*distance[i];
            z[i] = distance[i];
        }
        pointKernels().transform(toDirection.val, centre.val, run.size, x, y, z);
        return true;
    }

    void store(const Run& run, int y, Mat& points, Mat& status, Mat& covariance) const
    {
        const PixelBlock& p = run.pixels;
        const Matx33d& R1 = rectified_.first.R();
        for (int i = 0; i < run.size; i++)
        {
            const int x = run.column[i];
            status.at<uchar>(y, x) = p.status[i];
            if (p.status[i] != REFRACT_OK)
                continue;
            const Vec3d X(p.x[i], p.y[i], p.z[i]), rectified = R1*X;
            if (points.depth() == CV_32F)
                points.at<Vec3f>(y, x) = rectified;
            else
                points.at<Vec3d>(y, x) = rectified;
        }
        if (covariance_)
            storeCovariances(run, y, covariance);
    }

    //! The pixel of image 1 is the one that was asked; its partner in image 2 is off by sigma pixels of disparity.
    void storeCovariances(const Run& run, int y, Mat& covariance) const
    {
        typedef Vec<double, 9> Vec9d;
        const RectifiedView& view = rectified_.second;
        const PixelBlock& p = run.pixels;
        double planeD[BLOCK], x[BLOCK], yNext[BLOCK], u[BLOCK], v[BLOCK], pixels[4*BLOCK];
        uchar status[BLOCK];
        Matx33d C[BLOCK];
        for (int i = 0; i < run.size; i++)
        {
            x[i] = run.x2[i] + (rectified_.axis == 0);
            yNext[i] = run.y2[i] + (rectified_.axis == 1);
        }
        view.interpolate(run.size, run.x2, run.y2, planeD);
        view.pinhole().toRaw(run.size, x, yNext, planeD, u, v, status);
        const Columns out = { pixels, 2, BLOCK };
        for (int i = 0; i < run.size; i++)
        {
            const double sigma = sigmaAt(y, run.column[i]), du = sigma*(u[i] - p.pixel(2)[i]), dv = sigma*(v[i] - p.pixel(3)[i]);
            out.at(0, 0)[i] = du*du;
            out.at(0, 1)[i] = out.at(1, 0)[i] = du*dv;
            out.at(1, 1)[i] = dv*dv;
        }
        covariance_->evaluate(p, run.size, 0, out, C);
        const Matx33d& R1 = rectified_.first.R();
        for (int i = 0; i < run.size; i++)
            if (p.status[i] == REFRACT_OK)
                covariance.at<Vec9d>(y, run.column[i]) = Vec9d((R1*C[i]*R1.t()).val);
    }

    double sigmaAt(int y, int x) const { return sigma_.total() == 1 ? sigma_.at<double>(0, 0) : sigma_.at<double>(y, x); }

    const RectifiedPair& rectified_;
    const PointCovariance* covariance_;
    Mat sigma_;
};

//! One number, which Python hands over as (sigma, 0, 0, 0), or one a pixel; CV_64F.
Mat readSigma(InputArray sigma, Size size)
{
    Mat values;
    sigma.getMat().convertTo(values, CV_64F);
    const bool isPython = values.total() == 4 && values.size() != size && values.reshape(1, 1).at<double>(1) == 0 &&
                          values.reshape(1, 1).at<double>(2) == 0 && values.reshape(1, 1).at<double>(3) == 0;
    if (values.channels() != 1 || !(values.total() == 1 || isPython || values.size() == size))
        CV_Error_(Error::StsBadSize, ("disparitySigma is %dx%d; it must be one number, or one for each pixel of disparity (%dx%d)",
                                      values.cols, values.rows, size.width, size.height));
    if (countNonZero(values < 0) > 0)
        CV_Error(Error::StsOutOfRange, "disparitySigma must not be negative anywhere");
    return values.size() == size ? values : values.reshape(1, (int)values.total()).row(0).clone();
}

void reproject(InputArray disparity_, OutputArray _3dImage, const Ptr<RefractiveCamera>& camera1,
               const Ptr<RefractiveCamera>& camera2, InputArray R, InputArray T, InputArray R1, InputArray R2, InputArray P1,
               InputArray P2, InputArray depth1, InputArray depth2, bool handleMissingValues, int ddepth, OutputArray status_,
               const _InputArray* sigma, InputArray calibrationCovariance, OutputArray covariance_)
{
    const Disparity disparity(disparity_, handleMissingValues);
    const Size size = disparity.size();
    if (size.empty())
    {
        for (const _OutputArray* output : { &_3dImage, &status_, &covariance_ })
            output->release();
        return;
    }
    const Camera& cam1 = cameraOf(camera1, "camera1");
    const Camera& cam2 = cameraOf(camera2, "camera2");
    if (ddepth == -1)
        ddepth = _3dImage.fixedType() ? _3dImage.depth() : CV_32F;
    if (ddepth != CV_32F && ddepth != CV_64F)
        CV_Error_(Error::StsUnsupportedFormat, ("ddepth is %s; it must be CV_32F or CV_64F", depthToString(ddepth)));
    const StereoPair pair(cam1, cam2, R, T);
    checkRectification(readRotation(R1, "R1"), readRotation(R2, "R2"), pair.R);
    RectifiedPair rectified = { pair, pair.cameras(), RectifiedView(cam1, R1, P1, noArray(), depth1, size, { "R1", "P1", "depth1" }),
                                RectifiedView(cam2, R2, P2, T, depth2, size, { "R2", "P2", "depth2" }), 0, 0 };
    rectified.axis = axisOf(rectified.first.projection(), rectified.second.projection());
    rectified.enough = ddepth == CV_32F ? 1e-2 : 0;     // of which a thousandth is left, below the rounding of what is stored
    const PointCovariance pointCovariance(rectified.cameras, calibrationCovariance);
    const Reprojector reprojector(rectified, sigma ? &pointCovariance : NULL, sigma ? readSigma(*sigma, size) : Mat());

    const Scalar none = Scalar::all(std::numeric_limits<double>::quiet_NaN());
    _3dImage.create(size, CV_MAKETYPE(ddepth, 3));
    Mat points = _3dImage.getMat(), status(size, CV_8U), covariance;
    points.setTo(none);
    if (sigma)
    {
        covariance.create(size, CV_64FC(9));
        covariance.reshape(1).setTo(none);
    }
    parallel_for_(Range(0, size.height), [&](const Range& range)
    {
        for (int y = range.start; y < range.end; y++)
            reprojector.row(y, size.width, disparity.row(y), points, status, covariance);
    });
    if (status_.needed())
        status.copyTo(status_);
    if (sigma && covariance_.needed())
        covariance.copyTo(covariance_);
}

} // namespace

void refractiveReprojectImageTo3D(InputArray disparity, OutputArray _3dImage, const Ptr<RefractiveCamera>& camera1,
                                  const Ptr<RefractiveCamera>& camera2, InputArray R, InputArray T, InputArray R1, InputArray R2,
                                  InputArray P1, InputArray P2, InputArray depth1, InputArray depth2, bool handleMissingValues,
                                  int ddepth, OutputArray status)
{
    CV_INSTRUMENT_REGION();

    reproject(disparity, _3dImage, camera1, camera2, R, T, R1, R2, P1, P2, depth1, depth2, handleMissingValues, ddepth, status,
              NULL, noArray(), noArray());
}

void refractiveReprojectImageTo3D(InputArray disparity, OutputArray _3dImage, const Ptr<RefractiveCamera>& camera1,
                                  const Ptr<RefractiveCamera>& camera2, InputArray R, InputArray T, InputArray R1, InputArray R2,
                                  InputArray P1, InputArray P2, InputArray depth1, InputArray depth2, bool handleMissingValues,
                                  int ddepth, OutputArray status, InputArray disparitySigma, InputArray calibrationCovariance,
                                  OutputArray covariance)
{
    CV_INSTRUMENT_REGION();

    reproject(disparity, _3dImage, camera1, camera2, R, T, R1, R2, P1, P2, depth1, depth2, handleMissingValues, ddepth, status,
              &disparitySigma, calibrationCovariance, covariance);
}

}} // namespace
