// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* What the cameras of a problem see at its current parameters, and what they do not see. */

#include "adjust/problem.hpp"
#include "arrays/arrays.hpp"
#include "window/place.hpp"

namespace cv { namespace refract {

/** The camera must be possible.
@param part of its way from the camera at which a point is asked for */
Problem::Prediction Problem::predict(const Image& image, const Pose& pose, double part) const
{
    const RigCamera& rigCamera = cameras_[image.camera];
    const Camera& camera = *rigCamera.camera(image.refracted);
    const SimilarityTransform placed = targetErrors_.place(rotationMatrix(pose.rvec), pose.tvec, image.refracted);
    const int count = (int)image.points.object.size();
    Prediction all = { std::vector<Point2d>(count), std::vector<uchar>(count, (uchar)REFRACT_OK) };
    double x[BLOCK], y[BLOCK], z[BLOCK], u[BLOCK], v[BLOCK];
    for (int begin = 0; begin < count; begin += BLOCK)
    {
        const int n = std::min(BLOCK, count - begin);
        for (int k = 0; k < n; k++)
        {
            const Vec3d X = part*rigCamera.extrinsics.apply(placed.apply(Vec3d(image.points.object[begin + k])));
            x[k] = X[0]; y[k] = X[1]; z[k] = X[2];
        }
        camera.project(n, x, y, z, nullptr, u, v, &all.status[begin]);
        for (int k = 0; k < n; k++)
            all.pixel[begin + k] = Point2d(u[k], v[k]);
    }
    return all;
}

std::vector<double> Problem::pixelErrors(const Image& image, const Pose& pose) const
{
    const int count = (int)image.points.pixel.size();
    std::vector<double> errors(count, std::numeric_limits<double>::infinity());
    if (!cameras_[image.camera].camera(image.refracted))
        return errors;
    const Prediction all = predict(image, pose);
    for (int row = 0; row < count; row++)
        if (all.status[row] == REFRACT_OK)
            errors[row] = image.points.whitening.empty() ? norm(all.pixel[row] - image.points.pixel[row])
                                                         : norm(image.points.error(row, all.pixel[row].x, all.pixel[row].y));
    return errors;
}

std::vector<std::vector<double> > Problem::pixelErrors() const
{
    std::vector<std::vector<double> > all(images_.size());
    parallel_for_(Range(0, (int)images_.size()), [&](const Range& range)
    {
        for (int i = range.start; i < range.end; i++)
            all[i] = pixelErrors(images_[i]);
    });
    return all;
}

//! Why no image is seen by its camera; converged where one may be.
FitOutcome Problem::checkCamera(const Image& image) const
{
    if (cameras_[image.camera].camera(image.refracted))
        return FitOutcome();
    FitOutcome outcome(FitOutcome::NO_IMAGE);
    outcome.camera = image.camera;
    const TransferredWindow* window = cameras_[image.camera].window.get();
    if (!window)            // its own is impossible
        return outcome;
    const GlassWindow seen = withParameters(rig_.cameras[image.camera].window(), window->parameters.data());
    outcome.status = seen.normal[2] > 0 ? FitOutcome::BEYOND_WINDOW : FitOutcome::LOOKS_AWAY;
    outcome.point = Point3d(seen.normal);
    outcome.distance = distanceToSurface(seen);
    return outcome;
}

FitOutcome Problem::findPointWithoutImage() const
{
    std::vector<FitOutcome> outcomes(images_.size());
    parallel_for_(Range(0, (int)images_.size()), [&](const Range& range)
    {
        for (int i = range.start; i < range.end; i++)
            outcomes[i] = findPointWithoutImage(images_[i]);
    });
    for (const FitOutcome& outcome : outcomes)
        if (!outcome.converged())
            return outcome;
    return FitOutcome();
}

FitOutcome Problem::findPointWithoutImage(const Image& image) const
{
    FitOutcome outcome = checkCamera(image);
    if (!outcome.converged())
        return outcome;
    const Prediction all = predict(image, pose(image.view));
    for (int row = 0; row < (int)all.status.size(); row++)
    {
        if (image.rootWeights[row] == 0 || all.status[row] == REFRACT_OK)
            continue;
        outcome.status = FitOutcome::NO_IMAGE;
        outcome.camera = image.camera;
        outcome.view = image.view;
        outcome.refracted = image.refracted;
        outcome.point = image.points.object[row];
        outcome.pointIndex = image.points.index[row];
        outcome.imageStatus = all.status[row];
        return outcome;
    }
    return outcome;
}

FitOutcome Problem::findPointAtWindow(double nearer, int owner) const
{
    for (const Image& image : images_)
    {
        if (!image.refracted || !cameras_[image.camera].camera(true) || (owner >= 0 && rig_.owner[image.camera] != owner))
            continue;
        const Prediction all = predict(image, pose(image.view), 1 - nearer);
        for (int row = 0; row < (int)all.status.size(); row++)
        {
            if (image.rootWeights[row] == 0 || all.status[row] != REFRACT_BEHIND_WINDOW)
                continue;
            FitOutcome outcome;
            outcome.view = image.view;
            outcome.camera = image.camera;
            outcome.pointIndex = image.points.index[row];
            return outcome;
        }
    }
    return FitOutcome();
}

double Problem::squaredDistances(const Image& image) const
{
    if (image.points.whitening.empty())
        return squaredPixelError(image);
    const Prediction all = predict(image, pose(image.view));
    double sum = 0;
    for (int row = 0; row < (int)all.status.size(); row++)
    {
        const double weight = image.rootWeights[row]*image.rootWeights[row];
        if (weight > 0)
            sum += all.status[row] == REFRACT_OK ? weight*squaredDistance(all.pixel[row], image.points.pixel[row])
                                                 : std::numeric_limits<double>::infinity();
    }
    return sum;
}

}} // namespace
