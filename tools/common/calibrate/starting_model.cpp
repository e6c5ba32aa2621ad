#include "calibrate/starting_model.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/pinhole_camera.hpp"
#include "console/table.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

using Views = std::vector<std::vector<Point2d>>;

Views directViews(const RigData& data, int camera)
{
    Views views;
    for (const Moment& m : data.moments)
        views.push_back(m.direct[camera]);
    return views;
}

Views glassViews(const RigData& data, int camera)
{
    Views views;
    for (const Moment& m : data.moments)
        views.push_back(m.glass[camera]);
    return views;
}

int countTaken(const Views& views)
{
    return (int)std::count_if(views.begin(), views.end(), [](const std::vector<Point2d>& v) { return !v.empty(); });
}

Ptr<RefractiveCamera> startLens(const RigData& data, const RigOptions& options, int camera, LensSource& source)
{
    if (options.known[camera])
        return options.known[camera];
    const std::string suffix = camera ? "2" : "";
    Views views = directViews(data, camera);
    source.kind = LensSource::FROM_DIRECT;
    if (countTaken(views) == 0)
    {
        if (!(options.flags & GLASS_FREE_INTRINSICS))
            throw Failure("there is nothing to take the lens from: give --direct" + suffix + " images or --camera" + suffix
                          + ", or --free=intrinsics to find the lens through the window");
        views = glassViews(data, camera);   // a pinhole through the glass is a good start
        source.kind = LensSource::FROM_GLASS;
    }
    source.views = countTaken(views);
    if (source.views < 3)
        throw Failure(format("camera %d: %d image(s) to calibrate the lens from are too few: give at least 3 (better 10 or "
                             "more, tilted to all sides), or --camera%s", camera + 1, source.views, suffix.c_str()));
    return calibratePinhole(data.objectPoints, views, data.imageSize[camera], options.lensCoefficients, source.rms);
}

/** What was known of a camera before: its lens, if a file has it, with the file's covariance, and the window's given values
with the given deviations. */
KnownCamera knownOf(const RefractiveCamera& camera, const RigOptions& options, int c)
{
    const GlassWindow window = camera.window();
    const int lens = camera.lensParameters().rows, layers = (int)window.thickness.size();
    KnownCamera known{camera.lensParameters(), window.thickness, window.index, Mat()};
    // Without a covariance the lens of a file is exact, unless the caller wants it free.
    const bool lensKnown = options.known[c] && !(options.knownCovariance[c].empty() && (options.flags & GLASS_FREE_INTRINSICS));
    const bool windowKnown = layers > 0 && (options.thicknessStd > 0. || options.indexStd > 0.);
    if (!lensKnown && !windowKnown)
        return known;
    known.covariance = Mat::zeros(lens, lens, CV_64F);
    if (!lensKnown)
        known.covariance.diag().setTo(NAN);         // nothing is known
    else if (!options.knownCovariance[c].empty())
        options.knownCovariance[c].copyTo(known.covariance);
    if (!windowKnown)
        return known;
    const ParameterColumns at = columnsOf(camera);
    Mat covariance = Mat::zeros(at.end, at.end, CV_64F);
    known.covariance.copyTo(covariance(Rect(0, 0, lens, lens)));
    for (int i = 0; i < layers; i++)
    {
        covariance.at<double>(at.thickness + i, at.thickness + i) = options.thicknessStd*options.thicknessStd;
        covariance.at<double>(at.index + i, at.index + i) = options.indexStd*options.indexStd;
    }
    known.covariance = covariance;
    return known;
}

//! A lens with many coefficients, overfitted, may fold the image over itself; then nothing else can work.
void checkLens(const RigData& data, const Ptr<RefractiveCamera>& lens, int camera, const LensSource& source)
{
    int outside = 0;
    for (const Views& views : {directViews(data, camera), glassViews(data, camera)})
        for (const std::vector<Point2d>& view : views)
        {
            Mat origins, directions;
            std::vector<uchar> status;
            refractiveUnprojectPoints(view, origins, directions, lens, status);
            outside += (int)std::count(status.begin(), status.end(), (uchar)REFRACT_OUTSIDE_LENS_MODEL);
        }
    if (outside)
        throw Failure(format("camera %d: %d corners lie where the lens model is not one-to-one: ", camera + 1, outside)
                      + (source.kind == LensSource::FROM_FILE ? "--camera does not belong to these images"
                         : "these images do not determine that many coefficients; choose a smaller --lens (opencv5, opencv4) "
                           "or show the target in the image's corners too"));
}

//! Board -> camera of one view, and the sum of squared errors; false if there is none.
bool solveView(const RigData& data, const Ptr<RefractiveCamera>& camera, const std::vector<Point2d>& pixels,
               Matx33d& R, Vec3d& t)
{
    if (pixels.empty())
        return false;
    Vec3d rvec;
    if (!refractiveSolvePnP(data.objectPoints, pixels, camera, rvec, t))
        return false;
    Rodrigues(rvec, R);
    return true;
}

struct BoardInBoth { Matx33d R1, R2; Vec3d t1, t2; };

double relativePoseMisfit(const std::vector<BoardInBoth>& boards, const std::vector<Point3d>& object,
                          const Matx33d& R, const Vec3d& T)
{
    // The median over the boards, as single-view poses of a flat board may be mirrored.
    std::vector<double> misfits;
    for (const BoardInBoth& b : boards)
    {
        double sum = 0.;
        for (const Point3d& X : object)
        {
            const Vec3d p(X);
            const Vec3d there = R*(b.R1*p + b.t1) + T, here = b.R2*p + b.t2;
            sum += norm(there - here, NORM_L2SQR)/here.dot(here);
        }
        misfits.push_back(sum);
    }
    std::nth_element(misfits.begin(), misfits.begin() + misfits.size()/2, misfits.end());
    return misfits[misfits.size()/2];
}

//! R, T from single boards seen by both cameras (direct images first, any lens): the one that fits the others best.
void startExtrinsics(const RigData& data, RigModel& rig)
{
    const RigModel bare{{copyWithWindow(rig.cameras[0], GlassWindow()), copyWithWindow(rig.cameras[1], GlassWindow())},
                        rig.R, rig.T};
    std::vector<BoardInBoth> boards;
    for (int through = 0; through < 2 && boards.empty(); through++)
        for (const Moment& m : data.moments)
        {
            const RigModel& r = through ? rig : bare;
            BoardInBoth b;
            if (solveView(data, r.cameras[0], through ? m.glass[0] : m.direct[0], b.R1, b.t1) &&
                solveView(data, r.cameras[1], through ? m.glass[1] : m.direct[1], b.R2, b.t2))
                boards.push_back(b);
        }
    if (boards.empty())
        throw Failure("no moment is seen by both cameras, so their places to each other cannot be found: images of one "
                      "moment must have equal names in the folders of camera 1 and camera 2");
    double best = std::numeric_limits<double>::infinity();
    for (const BoardInBoth& b : boards)
    {
        const Matx33d R = b.R2*b.R1.t();
        const Vec3d T = b.t2 - R*b.t1;
        const double misfit = relativePoseMisfit(boards, data.objectPoints, R, T);
        if (misfit < best)
        {
            best = misfit;
            rig.R = R;
            rig.T = T;
        }
    }
}

} // namespace

RigModel startModel(const RigData& data, const RigOptions& options, std::vector<LensSource>& lensSources)
{
    RigModel rig;
    lensSources.assign(data.cameraCount, LensSource());
    for (int c = 0; c < data.cameraCount; c++)
    {
        Ptr<RefractiveCamera> lens = startLens(data, options, c, lensSources[c]);
        const Size known = lens->imageSize();
        if (!known.empty() && known != data.imageSize[c])
            throw Failure(format("--camera%s was calibrated on %dx%d images, but the images here are %dx%d", c ? "2" : "",
                                 known.width, known.height, data.imageSize[c].width, data.imageSize[c].height));
        checkLens(data, copyWithWindow(lens, GlassWindow()), c, lensSources[c]);
        rig.cameras.push_back(copyWithWindow(lens, options.window));
        rig.cameras.back()->setImageSize(data.imageSize[c]);
    }
    if (data.cameraCount == 2)
        startExtrinsics(data, rig);
    for (int c = 0; c < data.cameraCount; c++)
        rig.known.push_back(knownOf(*rig.cameras[c], options, c));
    return rig;
}

} // namespace tools
