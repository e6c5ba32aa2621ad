// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/image_disagreement.hpp"
#include "calibrate/pinhole_camera.hpp"
#include "console/numbers.hpp"
#include "diagnose/plain_fit.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int LENS_ITERATIONS = 10;

//! How far the two images of a pair are apart; px, the median of all points of a camera.
double pairsApart(const RigData& data, int camera)
{
    std::vector<double> lengths;
    for (const View& view : data.views)
        if (view.isPair(camera))
            for (size_t i = 0; i < view.objectPoints.size(); i++)
                if (seen(view.direct[camera][i]) && seen(view.glass[camera][i]))
                    lengths.push_back(norm(view.direct[camera][i] - view.glass[camera][i]));
    return lengths.empty() ? 0. : median(lengths);
}

void addImage(const View& view, const std::vector<Point2d>& pixels, std::vector<std::vector<Point3f>>& objects,
              std::vector<std::vector<Point2f>>& images)
{
    std::vector<Point3f> object;
    std::vector<Point2f> image;
    for (size_t i = 0; i < pixels.size(); i++)
        if (seen(pixels[i]) && view.objectPoints[i].z == view.objectPoints[0].z)
        {
            object.emplace_back((float)view.objectPoints[i].x, (float)view.objectPoints[i].y, 0.f);
            image.push_back(pixels[i]);
        }
    if (image.size() < 8)
        return;
    objects.push_back(object);
    images.push_back(image);
}

//! Zeros: there is none.
Matx33d roughLens(const RigData& data, int camera, bool glass)
{
    std::vector<std::vector<Point3f>> objects;
    std::vector<std::vector<Point2f>> images;
    for (const View& view : data.views)
        addImage(view, (glass ? view.glass : view.direct)[camera], objects, images);
    if (images.size() < 3)
        return Matx33d::zeros();
    try
    {
        Mat K = initCameraMatrix2D(objects, images, data.imageSize[camera], 1.), distortion;
        calibrateCamera(objects, images, data.imageSize[camera], K, distortion, noArray(), noArray(),
                        CALIB_USE_INTRINSIC_GUESS | CALIB_FIX_PRINCIPAL_POINT | CALIB_FIX_ASPECT_RATIO | CALIB_ZERO_TANGENT_DIST
                        | CALIB_FIX_K1 | CALIB_FIX_K2 | CALIB_FIX_K3 | CALIB_USE_LU,
                        TermCriteria(TermCriteria::COUNT, LENS_ITERATIONS, 0.));
        return K;
    }
    catch (const cv::Exception&)        // degenerate images
    {
        return Matx33d::zeros();
    }
}

/** A lens through its window: with the focal length that a pane across the axis gives it. A lens from these images alone would err by
itself, and put the same camera elsewhere. */
Matx33d throughWindow(const Matx33d& direct, const Matx33d& glass, const RigOptions& options)
{
    if (!(direct(0, 0) > 0.))
        return glass;
    const double longer = options.window.outerIndex/options.window.innerIndex;
    return Matx33d(longer*direct(0, 0), 0, direct(0, 2), 0, longer*direct(1, 1), direct(1, 2), 0, 0, 1);
}

//! Of a flat board before a pinhole, the best first.
std::vector<RigidTransform> posesOfBoard(const View& view, const std::vector<Point2d>& pixels, const Matx33d& K)
{
    std::vector<RigidTransform> poses;
    if (isSolid(view.objectPoints) || std::count_if(pixels.begin(), pixels.end(), seen) < 6)
        return poses;
    std::vector<Vec3d> rvecs, tvecs;
    refractiveSolvePnPGeneric(view.objectPoints, pixels, K, noArray(), GlassWindow(), rvecs, tvecs);
    for (size_t i = 0; i < rvecs.size(); i++)
        poses.push_back(transformOf(rvecs[i], tvecs[i]));
    return poses;
}

template<typename T> void addBytes(const T* from, size_t count, std::string& to)
{
    to.append(reinterpret_cast<const char*>(from), count*sizeof(T));
}

} // namespace

const std::vector<RigidTransform>& BoardPoses::of(const View& view, const std::vector<Point2d>& pixels, const Matx33d& K)
{
    std::string key;
    addBytes(K.val, 9, key);
    addBytes(pixels.data(), pixels.size(), key);
    addBytes(view.objectPoints.data(), view.objectPoints.size(), key);
    const auto entry = known_.emplace(key, std::vector<RigidTransform>());
    if (entry.second)
        entry.first->second = posesOfBoard(view, pixels, K);
    return entry.first->second;
}

namespace {

//! A board that two cameras saw at one moment.
struct Both
{
    RigidTransform one, other;
    const View* view;
};

//! @param K1, K2 lenses of camera 1 and of this one
std::vector<Both> boardsOf(const RigData& data, int camera, bool glass, const Matx33d& K1, const Matx33d& K2, BoardPoses& poses)
{
    std::vector<Both> boards;
    if (!(K1(0, 0) > 0.) || !(K2(0, 0) > 0.))
        return boards;
    for (const View& view : data.views)
    {
        const PerCamera<std::vector<Point2d>>& images = glass ? view.glass : view.direct;
        const std::vector<RigidTransform>&one = poses.of(view, images[0], K1), &other = poses.of(view, images[camera], K2);
        if (!one.empty() && !other.empty())
            boards.push_back({one[0], other[0], &view});
    }
    return boards;
}

//! A point of a board in both cameras.
struct PointInBoth
{
    Vec3d one, other;
};

std::vector<std::vector<PointInBoth>> pointsOf(const std::vector<Both>& boards)
{
    std::vector<std::vector<PointInBoth>> points(boards.size());
    for (size_t i = 0; i < boards.size(); i++)
        for (const Point3d& X : boards[i].view->objectPoints)
            points[i].push_back({boards[i].one.apply(Vec3d(X)), boards[i].other.apply(Vec3d(X))});
    return points;
}

//! How far boards are from where a place of two cameras to each other has them, each; px.
std::vector<double> distancesFrom(const RigidTransform& place, const std::vector<std::vector<PointInBoth>>& boards, double focal)
{
    std::vector<double> errors;
    for (const std::vector<PointInBoth>& board : boards)
    {
        double sum = 0.;
        for (const PointInBoth& X : board)
            sum += norm(place.apply(X.one) - X.other)/std::abs(X.other[2]);
        errors.push_back(focal*sum/board.size());
    }
    return errors;
}

/** The place of two cameras to each other, which one of some boards gives, that has the middling board nearest to it.
@return how far that is, px; 0: too few boards */
double apart(const std::vector<Both>& boards, const std::vector<Both>& places, double focal, RigidTransform* best = nullptr)
{
    if (boards.size() < 3 || places.size() < 3)
        return 0.;
    const std::vector<std::vector<PointInBoth>> points = pointsOf(boards);
    double least = NO_FIT;
    for (const Both& from : places)
    {
        const RigidTransform place = fromTo(from.one, from.other);
        const double middling = median(distancesFrom(place, points, focal));
        if (middling < least && best)
            *best = place;
        least = std::min(least, middling);
    }
    return least;
}

/** By how much the images through the window are not magnified against direct ones as a pane across the axis does, at half an image's
width; px. */
double magnificationOff(const Matx33d& direct, const Matx33d& glass, const RigOptions& options, Size size)
{
    const double expected = direct(0, 0)*options.window.outerIndex/options.window.innerIndex;
    return direct(0, 0) > 0. && glass(0, 0) > 0. ? 0.5*size.width*std::abs(std::log(glass(0, 0)/expected)) : 0.;
}

} // namespace

RoughLenses roughLensesOf(const RigData& data)
{
    RoughLenses lenses;
    for (int c = 0; c < data.cameraCount; c++)
    {
        lenses.direct[c] = roughLens(data, c, false);
        lenses.glass[c] = roughLens(data, c, true);
    }
    return lenses;
}

std::vector<int> allCameras(const RigData& data)
{
    std::vector<int> cameras(data.cameraCount);
    std::iota(cameras.begin(), cameras.end(), 0);
    return cameras;
}

double Disagreements::largest() const
{
    double largest = 0.;
    for (const std::vector<double>& kind : kinds())
        for (double px : kind)
            largest = std::max(largest, px);
    return largest;
}

double Disagreements::camerasApart() const
{
    double worst = 0.;
    for (size_t i = 0; i < direct.size(); i++)
        worst = std::max({worst, direct[i], glass[i]});
    return worst;
}

void update(const RigData& data, const RigOptions& options, const RoughLenses& lenses, const std::vector<int>& cameras, BoardPoses& poses,
            Disagreements& all)
{
    const auto isChanged = [&](int c) { return std::find(cameras.begin(), cameras.end(), c) != cameras.end(); };
    const auto through = [&](int c) { return throughWindow(lenses.direct[c], lenses.glass[c], options); };
    for (int c = 0; c < data.cameraCount; c++)
    {
        if (isChanged(c))
        {
            all.pairs[c] = pairsApart(data, c);
            all.magnifications[c] = magnificationOff(lenses.direct[c], lenses.glass[c], options, data.imageSize[c]);
        }
        if (c == 0 || !(isChanged(0) || isChanged(c)))
            continue;
        const std::vector<Both> direct = boardsOf(data, c, false, lenses.direct[0], lenses.direct[c], poses),
                                glass = boardsOf(data, c, true, through(0), through(c), poses);
        all.direct[c - 1] = apart(direct, direct, lenses.direct[c](0, 0));
        all.glass[c - 1] = apart(glass, glass, through(c)(0, 0));
        all.states[c - 1] = apart(glass, direct, through(c)(0, 0));
    }
}

std::vector<int> viewsElsewhere(const RigData& data, const RigOptions& options, int camera)
{
    // A lens from images through a window is rough: of right images boards are off by up to 90 px, and by four times the middling one.
    const double MOST = 2.*MOMENTS_PX, TIMES = 5., ROUGHEST = 3.*WINDOWS_PX;
    const RoughLenses lenses = roughLensesOf(data);
    const Matx33d K1 = throughWindow(lenses.direct[0], lenses.glass[0], options),
                  K2 = throughWindow(lenses.direct[camera], lenses.glass[camera], options);
    BoardPoses poses;
    const std::vector<Both> boards = boardsOf(data, camera, true, K1, K2, poses);
    RigidTransform place;
    const double middling = apart(boards, boards, K2(0, 0), &place), most = std::max(MOST, TIMES*middling);
    std::vector<int> elsewhere;
    if (!(middling > 0. && middling < ROUGHEST))
        return elsewhere;
    for (const Both& board : boards)
    {
        std::vector<Both> all;
        for (const RigidTransform& one : poses.of(*board.view, board.view->glass[0], K1))
            for (const RigidTransform& other : poses.of(*board.view, board.view->glass[camera], K2))
                all.push_back({one, other, board.view});
        const std::vector<double> off = distancesFrom(place, pointsOf(all), K2(0, 0));
        if (!off.empty() && *std::min_element(off.begin(), off.end()) > most)
            elsewhere.push_back(int(board.view - data.views.data()));
    }
    return elsewhere;
}

Disagreements disagreementsOf(const RigData& data, const RigOptions& options, const RoughLenses& lenses, BoardPoses& poses)
{
    Disagreements all;
    all.pairs.resize(data.cameraCount);
    all.magnifications.resize(data.cameraCount);
    for (std::vector<double>* kind : {&all.direct, &all.glass, &all.states})
        kind->resize(data.cameraCount - 1);
    update(data, options, lenses, allCameras(data), poses, all);
    return all;
}

double camerasApart(const RigData& data, const RigOptions& options)
{
    BoardPoses poses;
    return disagreementsOf(data, options, roughLensesOf(data), poses).camerasApart();
}

} // namespace tools
