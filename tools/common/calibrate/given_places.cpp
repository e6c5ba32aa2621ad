// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

/* A marker at X is on the plane n X = d. With errors of X of the covariance C_i the most likely plane has the least sum of
(n X_i - d)^2/(n C_i n); turned by small angles a about its two tangents t and shifted by e, the residual of a marker changes by
a (t X_i) - e. So the markers tell the normal and the distance together: beside the camera's axis, a window that is more inclined is
also further away. */
#include "calibrate/given_places.hpp"
#include "calibrate/given_window.hpp"
#include "calibrate/rigid_transform.hpp"
#include "calibrate/window_face.hpp"
#include "console/csv.hpp"
#include "console/failure.hpp"
#include "console/options.hpp"

#include <algorithm>
#include <cmath>

using namespace cv;
using cv::refract::GlassWindow;

namespace tools {

namespace {

const double DEGREES = 180./CV_PI;

//! Turns about two axes and the distance -> normal and distance.
Matx43d byTurns(const Vec3d& n)
{
    const Matx32d t = tangents(n);
    return Matx43d(t(0, 0), t(0, 1), 0, t(1, 0), t(1, 1), 0, t(2, 0), t(2, 1), 0, 0, 0, 1);
}

//! Of a marker's distance from a plane.
double varianceAcross(const PaneMarker& marker, const Vec3d& n)
{
    const Vec3d across = marker.std.mul(n);
    return across.dot(across);
}

//! The plane of least weighted squares, whose weights depend on its normal.
GivenPlace nearestPlane(const std::vector<PaneMarker>& markers)
{
    const int ROUNDS = 20;
    GivenPlace plane;
    plane.normal = Vec3d(0, 0, 1);
    for (int round = 0; round < ROUNDS; round++)
    {
        double weights = 0.;
        Vec3d middle;
        for (const PaneMarker& marker : markers)
        {
            const double weight = 1./varianceAcross(marker, plane.normal);
            weights += weight;
            middle += weight*marker.at;
        }
        middle *= 1./weights;
        Matx33d scatter = Matx33d::zeros();
        for (const PaneMarker& marker : markers)
            scatter += (marker.at - middle)*(marker.at - middle).t()*(1./varianceAcross(marker, plane.normal));
        Vec3d values;
        Matx33d vectors;
        eigen(scatter, values, vectors);
        plane.normal = Vec3d(vectors.row(2).val);
        plane.distance = plane.normal.dot(middle);
        if (plane.distance < 0.)
        {
            plane.normal = -plane.normal;
            plane.distance = -plane.distance;
        }
    }
    return plane;
}

//! d (distance of a marker from the plane)/d (turns, distance), over its standard deviation.
Vec3d rowOf(const PaneMarker& marker, const GivenPlace& plane, const Matx43d& tangents)
{
    const Vec3d row(tangents.t()*Vec4d(marker.at[0], marker.at[1], marker.at[2], -1.));
    return row*(1./std::sqrt(varianceAcross(marker, plane.normal)));
}

//! One that is not where the others say the plane is.
void requireOnPlane(const std::vector<PaneMarker>& markers, const GivenPlace& plane, const Matx33d& ofTurns, const std::string& path)
{
    const double MOST = 5.;             // standard deviations
    const Matx43d tangents = byTurns(plane.normal);
    double worst = 0., off = 0.;
    const PaneMarker* which = nullptr;
    for (const PaneMarker& marker : markers)
    {
        const Vec3d row = rowOf(marker, plane, tangents);
        const double left = 1. - row.dot(ofTurns*row), residual = plane.normal.dot(marker.at) - plane.distance;
        const double NONE = 1e-6;       // three markers are on a plane whatever they are
        if (left < NONE)
            continue;
        const double deviations = std::abs(residual)/std::sqrt(varianceAcross(marker, plane.normal)*left);
        if (deviations > worst)
        {
            worst = deviations;
            off = residual/left;
            which = &marker;
        }
    }
    if (worst > MOST)
        throw Failure(format("--pane-points=%s: the marker '%s' is %.3g from the plane of the others, %.0f standard deviations: they are "
                             "on one face, the one towards the camera; or say by --pane-points-std how well they are known",
                             path.c_str(), which->id.c_str(), std::abs(off), worst));
}

//! Each camera's part of values that are given once for each window, or once for all.
template<typename T> std::vector<T> forCameras(const std::vector<T>& given, int cameras, const std::vector<int>& windows)
{
    std::vector<int> seen;
    std::vector<T> all;
    for (int c = 0; c < cameras; c++)
    {
        const int window = windows.empty() ? c : windows[c];
        if (std::find(seen.begin(), seen.end(), window) == seen.end())
            seen.push_back(window);
        all.push_back(given[std::find(seen.begin(), seen.end(), window) - seen.begin()]);
    }
    return all;
}

int countOf(int cameras, std::vector<int> windows)
{
    std::sort(windows.begin(), windows.end());
    return windows.empty() ? cameras : (int)(std::unique(windows.begin(), windows.end()) - windows.begin());
}

} // namespace

double GivenPlace::normalStd() const
{
    Vec3d values;
    eigen(covariance.get_minor<3, 3>(0, 0), values);
    return std::sqrt(std::max(0., values[0]));
}

double GivenPlace::distanceStd() const { return std::sqrt(covariance(3, 3)); }

void GivenPlace::putInto(GlassWindow& window) const
{
    window.normal = normal;
    if (tellsDistance())
        window.distance = distance;
}

void GivenPlace::addTo(const GlassWindow& window, const ParameterColumns& at, Mat& all) const
{
    const bool isShown = hasDifferentMedia(window) || !window.wedge.empty();
    const int columns[] = {at.normal, at.normal + 1, at.normal + 2, at.distance}, count = isShown ? 4 : 3;
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            all.at<double>(columns[i], columns[j]) += covariance(i, j);
}

double deviationsBetween(const GlassWindow& given, const Matx44d& known, const GlassWindow& found, const Matx44d& ofFound)
{
    const Matx43d tangents = byTurns(given.normal);
    const Vec3d turn = found.normal - given.normal;
    const Vec3d off(tangents.t()*Vec4d(turn[0], turn[1], turn[2], found.distance - given.distance));
    const Matx33d ofOff = tangents.t()*(known + ofFound)*tangents;
    return std::sqrt(std::max(0., off.dot(ofOff.inv(DECOMP_SVD)*off)));
}

GivenPlace placeOfMarkers(const std::vector<PaneMarker>& markers, const std::string& path)
{
    if (markers.size() < 3)
        throw Failure(format("--pane-points=%s: %zu marker%s: a plane takes three, not on one line", path.c_str(), markers.size(),
                             markers.size() == 1 ? "" : "s"));
    GivenPlace place = nearestPlane(markers);
    const Matx43d tangents = byTurns(place.normal);
    Matx33d information = Matx33d::zeros();
    for (const PaneMarker& marker : markers)
    {
        const Vec3d row = rowOf(marker, place, tangents);
        information += row*row.t();
    }
    const double SINGULAR = 1e-13;      // least over largest information of turns and distance, in any unit
    Matx33d ofTurns;
    const bool isPlane = invert(information, ofTurns, DECOMP_SVD) > SINGULAR;
    place.covariance = tangents*ofTurns*tangents.t();
    const double MOST_DEG = 10.;
    if (!isPlane || !(place.normalStd()*DEGREES < MOST_DEG))
        throw Failure("--pane-points=" + path + ": the markers are nearly on one line, so that the plane may turn about it: give one "
                      "beside it");
    if (!(place.normal[2] > 0. && place.distance > 0.))
        throw Failure(format("--pane-points=%s: their plane is not before the camera (normal %.3g, %.3g, %.3g): x, y, z are in the "
                             "camera's frame, z ahead", path.c_str(), place.normal[0], place.normal[1], place.normal[2]));
    requireOnPlane(markers, place, ofTurns, path);
    return place;
}

std::vector<PaneMarker> readPaneMarkers(const std::string& path, double std)
{
    const CsvTable table(path, {"id", "x", "y", "z"}, "a file of markers on a window");
    const bool says = table.find("sx") >= 0;
    if (!says && !(std > 0.))
        throw Failure("--pane-points=" + path + ": say how well they are known, by --pane-points-std or columns sx,sy,sz");
    if (says && std > 0.)
        throw Failure("--pane-points-std: '" + path + "' has columns sx,sy,sz, which say it: leave one out");
    std::vector<PaneMarker> markers;
    for (const CsvTable::Row& row : table.rows())
    {
        PaneMarker marker{table.text(row, "id"), {}, Vec3d::all(std)};
        for (int i = 0; i < 3; i++)
        {
            const std::string axis(1, "xyz"[i]);
            marker.at[i] = table.numberOrNone(row, axis);
            if (says)
                marker.std[i] = table.numberOrNone(row, "s" + axis);
        }
        if (!std::isfinite(marker.at[0] + marker.at[1] + marker.at[2]))
            continue;
        if (!(marker.std[0] > 0. && marker.std[1] > 0. && marker.std[2] > 0.))
            throw Failure(table.where(row) + ": sx, sy and sz are standard deviations, each more than 0");
        markers.push_back(marker);
    }
    return markers;
}

void GivenPlaces::addTo(OptionParser& parser)
{
    Option normal = parser.add("--normal", normals_, "what is known of the normal of a flat window: X,Y,Z in the camera's frame; once for "
        "all cameras, or once for each").oneAtATime();
    parser.add("--normal-std", normalStdDeg_, "how well, one standard deviation about each of two axes, degrees: the normal is estimated "
        "within it; with --pane-points: how much all of them may be turned about the camera").check(moreThanZero());
    Option points = parser.add("--pane-points", points_, "markers on the face of a flat window towards the camera, or on the water's "
        "surface: id,x,y,z[,sx,sy,sz] in the camera's frame, once for each window; normal and distance are estimated within what they "
        "tell").oneAtATime().excludes(normal).excludes(parser.get("--distance"));
    parser.add("--pane-points-std", pointStd_, "how well each coordinate of each marker is known, by itself, where the table does not say "
        "it; what all of them share, as where the camera's centre is, is --distance-std").needs(points).check(moreThanZero());
}

std::vector<GivenPlace> GivenPlaces::of(int cameras, const std::vector<int>& windows) const
{
    if (!isSaid() && normalStdDeg_ > 0.)
        throw Failure("--normal-std is of a normal that is given: add --normal=X,Y,Z, or --pane-points");
    return areOfMarkers() ? ofMarkers(cameras, windows) : ofNormals(cameras, windows);
}

std::vector<GivenPlace> GivenPlaces::ofNormals(int cameras, const std::vector<int>& windows) const
{
    if (isSaid() && !(normalStdDeg_ > 0.))
        throw Failure("--normal=" + normals_[0] + ": say how well it is known, --normal-std=1 for a degree");
    if (normals_.size() > 1 && (int)normals_.size() != cameras)
        throw Failure(format("--normal is given %zu times, and there are %d cameras: give it once for all, or once for each",
                             normals_.size(), cameras));
    if (normals_.size() > 1 && countOf(cameras, windows) == 1)
        throw Failure(format("--normal is given %zu times, and all cameras look through one window: give that of camera 1",
                             normals_.size()));
    std::vector<GivenPlace> places;
    for (const std::string& text : normals_)
    {
        const Vec3d n = parseVector(text, "--normal");
        if (!(n[2] > 0.))
            throw Failure("--normal=" + text + ": it points from the camera to the scene, so that its z is more than 0");
        places.emplace_back();
        places.back().normal = normalize(n);
    }
    if (places.size() == 1)
        places.resize(cameras, places[0]);
    return places;
}

std::vector<GivenPlace> GivenPlaces::ofMarkers(int cameras, const std::vector<int>& windows) const
{
    const int count = countOf(cameras, windows);
    if ((int)points_.size() != count)
        throw Failure(format("--pane-points is given %zu time%s, and there %s %d window%s: give one table for each, in the frame of the "
                             "first camera behind it", points_.size(), points_.size() == 1 ? "" : "s", count == 1 ? "is" : "are", count,
                             count == 1 ? "" : "s"));
    std::vector<GivenPlace> places;
    for (const std::string& path : points_)
        places.push_back(placeOfMarkers(readPaneMarkers(path, pointStd_), path));
    return forCameras(places, cameras, windows);
}

} // namespace tools
