// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "colmap/survey_adjustment.hpp"
#include "colmap/scale_of_window.hpp"
#include "console/csv.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/progress.hpp"
#include "math/rotation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! X -> s R X + t, of the model's world to that of the start.
struct Similarity
{
    double s = 1.;
    RigidTransform rigid;

    Vec3d operator*(const Vec3d& X) const { return rigid.apply(s*X); }
    RigidTransform ofPose(const RigidTransform& cam_from_world) const
    {
        const Matx33d R = cam_from_world.R*rigid.R.t();
        return {R, s*cam_from_world.t - R*rigid.t};
    }
};

Vec3d centreOf(const ColmapPose& pose) { return transformOf(pose).inverse(Vec3d()); }

//! An image of each view, and camera; -1: there is none.
std::vector<std::vector<int>> imagesOfViews(const Survey& survey, int cameras)
{
    std::vector<std::vector<int>> images(survey.views.size(), std::vector<int>(cameras, -1));
    for (size_t i = 0; i < survey.viewOf.size(); i++)
        if (survey.viewOf[i] >= 0)
            images[survey.viewOf[i]][survey.cameraOf[i]] = (int)i;
    return images;
}

double scaleOfLengths(const Survey& survey, const GivenLengths& lengths)
{
    std::vector<double> ratios;
    for (const GivenLength& l : lengths.list)
        ratios.push_back(l.length/norm(survey.model.points[l.a].X - survey.model.points[l.b].X));
    return ratios.empty() ? 0. : median(ratios);
}

//! 0: no view is of two cameras.
double scaleOfRig(const Survey& survey, const RigModel& rig)
{
    std::vector<double> ratios;
    for (const std::vector<int>& images : imagesOfViews(survey, (int)rig.cameras.size()))
        for (size_t c = 1; c < images.size(); c++)
            if (images[0] >= 0 && images[c] >= 0)
                ratios.push_back(norm(rig.extrinsics[c].t)/norm(centreOf(survey.model.images[images[0]].cam_from_world)
                                                                - centreOf(survey.model.images[images[c]].cam_from_world)));
    return ratios.empty() ? 0. : median(ratios);
}

//! Horn's and Umeyama's: the model onto the positions.
Similarity ontoPositions(const Survey& survey, const std::map<int, KnownPosition>& positions)
{
    const int cameras = 1 + *std::max_element(survey.cameraOf.begin(), survey.cameraOf.end());
    const std::vector<std::vector<int>> images = imagesOfViews(survey, cameras);
    Vec3d meanFrom, meanTo;
    for (const auto& position : positions)
    {
        meanFrom += centreOf(survey.model.images[images[position.first][0]].cam_from_world)/(double)positions.size();
        meanTo += position.second.center/(double)positions.size();
    }
    Matx33d product = Matx33d::zeros(), spread = Matx33d::zeros();
    double squares = 0., variance = 0.;
    for (const auto& position : positions)
    {
        const Vec3d from = centreOf(survey.model.images[images[position.first][0]].cam_from_world) - meanFrom;
        product += (position.second.center - meanTo)*from.t();
        spread += from*from.t();
        squares += from.dot(from);
        variance += position.second.std*position.second.std/(double)positions.size();
    }
    const SVD svd(product), ofImages(spread);
    const Vec3d w(svd.w.ptr<double>());
    // Beside the line, what is common to images and positions, and how far that may be chance.
    const double TURN = 0.1, beside = w[1], chance = std::sqrt(variance*ofImages.w.at<double>(1));
    if (!(TURN*beside > chance) || !(beside > 1e-6*w[0]))
        throw Failure("--positions: the images were taken along a line, as far as std tells, about which the scene may turn: give "
                      "positions beside it, too");
    Matx33d signs = Matx33d::eye();
    signs(2, 2) = determinant(svd.u)*determinant(svd.vt) < 0 ? -1. : 1.;
    Similarity onto;
    onto.rigid.R = Matx33d(svd.u.ptr<double>())*signs*Matx33d(svd.vt.ptr<double>());
    onto.s = (w[0] + w[1] + signs(2, 2)*w[2])/squares;
    onto.rigid.t = meanTo - onto.s*(onto.rigid.R*meanFrom);
    return onto;
}

//! Of a million points only those that the file names are looked up.
GivenLengths lengthsOf(const Survey& survey, const std::string& path, const std::string& folder)
{
    const CsvTable table(path, {"id1", "id2", "length", "std"}, "a table of known lengths");
    std::set<std::string> named;
    for (const CsvTable::Row& row : table.rows())
        named.insert({table.text(row, "id1"), table.text(row, "id2")});
    Matches names;
    std::vector<int> indices;
    for (size_t i = 0; i < survey.model.points.size(); i++)
        if (named.count(std::to_string(survey.model.points[i].id)))
        {
            names.names.push_back({"", std::to_string(survey.model.points[i].id)});
            indices.push_back((int)i);
        }
    GivenLengths lengths = readLengths(path, folder, names);
    for (GivenLength& length : lengths.list)
    {
        length.a = indices[length.a];
        length.b = indices[length.b];
    }
    return lengths;
}

//! Less the mean of positions: survey coordinates are large.
void moveOrigin(SurveyStart& start)
{
    for (const auto& position : start.positions)
        start.origin += position.second.center/(double)start.positions.size();
    for (auto& position : start.positions)
        position.second.center -= start.origin;
}

Similarity toMetric(const Survey& survey, const BundleStart& bundle, const std::string& folder, bool quiet, SurveyStart& start)
{
    Similarity metric;
    const int cameras = (int)bundle.rig.cameras.size();
    if (!start.lengths.list.empty())
    {
        metric.s = scaleOfLengths(survey, start.lengths);
        start.scale = format("%zu length%s", start.lengths.list.size(), start.lengths.list.size() == 1 ? "" : "s");
    }
    if (!start.positions.empty())
    {
        metric = ontoPositions(survey, start.positions);
        start.scale += (start.scale.empty() ? "" : " and ") + format("%zu positions", start.positions.size());
    }
    if (!start.scale.empty())
        return metric;
    if (cameras > 1 && !(bundle.flags & GLASS_FREE_EXTRINSICS))
    {
        metric.s = scaleOfRig(survey, bundle.rig);
        start.scale = "the base line of the rig";
        if (metric.s > 0.)
            return metric;
    }
    const ScaleOfWindow found = scaleOfWindow(survey, bundle.rig, folder, quiet);
    metric.s = found.factor;
    start.lengths = found.asLengths;
    start.scale = "the window alone";
    start.isScaleOfWindow = true;
    return metric;
}

//! By the camera that sees most.
void startPose(const Survey& survey, const RigModel& rig, const Similarity& metric, const std::vector<Point3d>& points,
               const std::vector<int>& rows, Vec3d& rvec, Vec3d& tvec)
{
    std::vector<int> seen(rig.cameras.size(), 0);
    for (int row : rows)
        seen[survey.observations[row][1]]++;
    const int camera = (int)(std::max_element(seen.begin(), seen.end()) - seen.begin());
    std::vector<Point3d> objects;
    std::vector<Point2d> pixels;
    RigidTransform pose;
    for (int row : rows)
        if (survey.observations[row][1] == camera)
        {
            objects.push_back(points[survey.observations[row][2]]);
            pixels.push_back(survey.pixels[row]);
            pose = metric.ofPose(transformOf(survey.imageOf(row).cam_from_world));
        }
    rvec = rotationVector(pose.R);
    tvec = pose.t;
    refractiveSolvePnP(objects, pixels, rig.cameras[camera], rvec, tvec, true);     // else it stays where it is
    poseInCamera1(rig, camera, rvec, tvec);
}

/** Radians of a pose of which only the place is known: so many that thousands of views together tell nothing of a turn, and so few that the
place is not lost in rounding beside what a turn does to it. */
double vagueTurn(double distance, double std)
{
    const double MOST = 30., DIGITS = 1e6;
    return distance > 0. ? std::min(MOST, DIGITS*std/distance) : MOST;
}

} // namespace

//! positions.csv: image,x,y,z,std, of images of camera 1 by their names. By view. Throws Failure that names file and line.
static std::map<int, KnownPosition> readPositions(const std::string& path, const Survey& survey)
{
    const CsvTable table(path, {"image", "x", "y", "z", "std"}, "a table of positions of images");
    std::map<std::string, int> images;
    for (size_t i = 0; i < survey.model.images.size(); i++)
        images[survey.model.images[i].name] = (int)i;
    std::map<int, KnownPosition> positions;
    for (const CsvTable::Row& row : table.rows())
    {
        const std::string name = table.text(row, "image");
        const auto image = images.find(name);
        if (image == images.end() || survey.viewOf[image->second] < 0)
            continue;                   // was not reconstructed
        if (survey.cameraOf[image->second] > 0)
            throw Failure(table.where(row) + format(": image '%s' is of camera %d; give positions of camera 1", name.c_str(),
                                                    survey.cameraOf[image->second] + 1));
        const Vec3d center(table.number(row, "x"), table.number(row, "y"), table.number(row, "z"));
        const KnownPosition position = {center, table.number(row, "std"), row.line};
        if (!(position.std > 0))
            throw Failure(table.where(row) + format(": std is %g; it must be more than 0", position.std));
        if (!positions.insert({survey.viewOf[image->second], position}).second)
            throw Failure(table.where(row) + ": image '" + name + "' is there twice");
    }
    if (positions.size() < 3)
        throw Failure(format("'%s' has positions of %zu of the model's images, at least three are needed: are these its names, such as "
                             "'%s'?", path.c_str(), positions.size(), survey.model.images[0].name.c_str()));
    return positions;
}

SurveyStart startSurvey(const Survey& survey, const BundleStart& bundle, const std::string& lengthsPath, const std::string& positionsPath,
                        const std::string& folder, bool quiet)
{
    SurveyStart start;
    if (!lengthsPath.empty())
        start.lengths = lengthsOf(survey, lengthsPath, folder);
    if (!positionsPath.empty())
    {
        start.positions = readPositions(positionsPath, survey);
        moveOrigin(start);
    }
    const Similarity metric = toMetric(survey, bundle, folder, quiet, start);
    if (!(metric.s > 0) || !std::isfinite(metric.s))
        throw Failure("'" + folder + "': its scale cannot be told by " + start.scale + ": points or images coincide");
    for (const ColmapPoint& point : survey.model.points)
        start.points.push_back(Point3d(metric*point.X));
    std::vector<std::vector<int>> rows(survey.views.size());
    for (size_t i = 0; i < survey.observations.size(); i++)
        rows[survey.observations[i][0]].push_back((int)i);
    Progress progress("poses through the windows", (int)rows.size(), quiet);
    start.rvecs.resize(rows.size());
    start.tvecs.resize(rows.size());
    for (size_t view = 0; view < rows.size(); view++)
    {
        progress.at(survey.views[view]);
        startPose(survey, bundle.rig, metric, start.points, rows[view], start.rvecs[view], start.tvecs[view]);
        progress.step();
    }
    return start;
}

std::vector<Mat> covariancesOfPoses(const SurveyStart& start, const std::vector<Vec3d>& rvecs, std::vector<Vec3d>& tvecs)
{
    std::vector<Mat> all;
    if (start.positions.empty())
        return all;
    for (int view = 0; view < (int)rvecs.size(); view++)
    {
        const auto known = start.positions.find(view);
        if (known == start.positions.end())
        {
            all.push_back(Mat(6, 6, CV_64F, Scalar::all(std::numeric_limits<double>::quiet_NaN())));
            continue;
        }
        // (rvec, centre) -> (rvec, tvec = -R centre)
        const Vec3d& C = known->second.center;
        const double turn = vagueTurn(norm(C), known->second.std);
        const Rotation rotation(rvecs[view].val);
        const Matx33d byTurn = rotation.derivativeOf(-C);
        Matx66d J = Matx66d::eye(), S = Matx66d::zeros();
        for (int r = 0; r < 3; r++)
            for (int k = 0; k < 3; k++)
            {
                J(3 + r, k) = byTurn(r, k);
                J(3 + r, 3 + k) = -rotation.R(r, k);
            }
        for (int k = 0; k < 3; k++)
        {
            S(k, k) = turn*turn;
            S(3 + k, 3 + k) = known->second.std*known->second.std;
        }
        all.push_back(Mat(J*S*J.t(), true));
        tvecs[view] = -(rotation.R*C);
    }
    return all;
}

} // namespace tools
