// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/sheet.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/rigid_transform.hpp"
#include "console/failure.hpp"
#include "console/file_output.hpp"
#include "math/dense.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/rig_vector.hpp"
#include "measure/target_pose.hpp"
#include <opencv2/core/persistence.hpp>
#include <cmath>
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double IN_SHEET = 0.01;           // sine of the angle between a ray and the sheet

//! Of lens and window, to know a camera by. @param outerIndexAt if given: where among them the scene's index is
std::vector<double> parametersOf(const RefractiveCamera& camera, size_t* outerIndexAt = nullptr)
{
    std::vector<double> values = camera.lensParameters();
    const GlassWindow w = camera.window();
    values.insert(values.end(), {w.normal[0], w.normal[1], w.normal[2], w.distance, w.innerIndex, w.outerIndex});
    if (outerIndexAt)
        *outerIndexAt = values.size() - 1;
    values.insert(values.end(), w.thickness.begin(), w.thickness.end());
    values.insert(values.end(), w.index.begin(), w.index.end());
    for (const Vec2d& wedge : w.wedge)
        values.insert(values.end(), {wedge[0], wedge[1]});
    if (w.shape != WINDOW_FLAT)
        values.insert(values.end(), {(double)w.shape, w.center[0], w.center[1], w.center[2], w.axis[0], w.axis[1], w.axis[2], w.radius,
                                     w.curvature});
    return values;
}

bool areSame(const std::vector<double>& a, const std::vector<double>& b)
{
    if (a.size() != b.size())
        return false;
    for (size_t i = 0; i < a.size(); i++)
        if (!(std::abs(a[i] - b[i]) <= 1e-12*std::max(1., std::abs(a[i]))))
            return false;
    return true;
}

/** A sheet in another medium is another one: its light comes through a window of its own.
@param camera that it was calibrated with */
void requireSameMedium(const std::string& filename, std::vector<double>& camera, const CameraCalibration& now)
{
    size_t at;
    const std::vector<double> values = parametersOf(*now.camera, &at);
    if (camera.size() != values.size())
        return;                     // another camera at all
    if (!(std::abs(camera[at] - values[at]) <= std::max(now.windowStd.outerIndex, 1e-9)))
        throw Failure("'" + filename + format("' was calibrated in a medium of index %.5f, not %.5f: the sheet itself is bent where it "
                      "leaves its projector; calibrate it again in this medium (--sheet-out, with the same --outer-index)", camera[at],
                      values[at]));
    camera[at] = values[at];
}

} // namespace

SheetDistances distancesFromPlane(const Vec4d& plane, const std::vector<Point3d>& points)
{
    const Eigen::Index count = (Eigen::Index)points.size();
    const Eigen::RowVector3d n(plane[0], plane[1], plane[2]);
    SheetDistances d = {VectorXd(count), n.replicate(count, 1), MatrixXd(count, 4)};
    for (Eigen::Index i = 0; i < count; i++)
    {
        const Point3d& X = points[i];
        d.byState.row(i) << X.x, X.y, X.z, -1.;
        d.e[i] = n.dot(Eigen::RowVector3d(X.x, X.y, X.z)) - plane[3];
    }
    return d;
}

SheetDistances distancesFromEmitter(const Emitter& emitter, const std::vector<Point3d>& points)
{
    const Eigen::Index count = (Eigen::Index)points.size();
    const Vec3d rvec = rotationVector(emitter.R), T = emitter.translation();
    std::vector<Point2d> pixels;
    refractiveProjectPoints(points, rvec, T, emitter.camera, pixels);
    const PointDerivatives by = differentiatePoints(emitter.camera, points, rvec, T);
    const Eigen::Index parameters = by.byParameters.cols();
    SheetDistances d = {VectorXd(count), MatrixXd(count, 3), MatrixXd(count, 6 + parameters)};
    for (Eigen::Index i = 0; i < count; i++)
    {
        const Vec3d g(by.byPose(2*i, 3), by.byPose(2*i, 4), by.byPose(2*i, 5));     // of u, by the point in the emitter's frame
        const Vec3d byPoint = emitter.R.t()*g, byRotation = (emitter.R*(Vec3d(points[i]) - emitter.position)).cross(g);
        const double perUnit = 1/norm(g);
        d.e[i] = (pixels[i].x - emitter.line)*perUnit;
        for (int k = 0; k < 3; k++)
        {
            d.byPoint(i, k) = byPoint[k]*perUnit;
            d.byState(i, k) = byRotation[k]*perUnit;
            d.byState(i, 3 + k) = -byPoint[k]*perUnit;
        }
        d.byState.row(i).tail(parameters) = by.byParameters.row(2*i)*perUnit;
    }
    return d;
}

//! Two tangents of the normal, and d.
MatrixXd PlaneSurface::basis() const
{
    const Matx32d across = tangents(Vec3d(plane_.val));
    MatrixXd basis = MatrixXd::Zero(4, 3);
    for (int i = 0; i < 3; i++)
        basis.row(i) << across(i, 0), across(i, 1), 0.;
    basis(3, 2) = 1.;
    return basis;
}

std::shared_ptr<const SheetSurface> PlaneSurface::moved(const VectorXd& step) const
{
    const VectorXd by = timesVector(basis(), step);
    const Vec4d plane = plane_ + Vec4d(by[0], by[1], by[2], by[3]);
    return std::make_shared<PlaneSurface>(plane/norm(Vec3d(plane.val)), coefficients_);
}

std::shared_ptr<const SheetSurface> EmitterSurface::moved(const VectorXd& step) const
{
    return std::make_shared<EmitterSurface>(*prior_, prior_->moved(emitter_, step));
}

bool isPlane(const Sheet& sheet) { return sheet.emitter.camera.empty(); }

void pointsOnSheet(const Calibration& calibration, const Sheet& sheet, const std::vector<Point2d>& pixels, std::vector<Point3d>& points,
                   std::vector<uchar>& status)
{
    const auto& camera = calibration.cameras[0].camera;
    if (isPlane(sheet))
    {
        refractivePointsOnPlane(pixels, points, camera, sheet.plane, status);
        return;
    }
    // The emitter's part of each pair is half a pixel.
    const std::vector<Point2d> halves(pixels.size(), Point2d(sheet.emitter.line, std::numeric_limits<double>::quiet_NaN()));
    triangulateRefractive({camera, sheet.emitter.camera}, std::vector<Matx33d>{Matx33d::eye(), sheet.emitter.R},
                          std::vector<Vec3d>{Vec3d(), sheet.emitter.translation()}, std::vector<std::vector<Point2d>>{pixels, halves},
                          points, status);
}

Sheet readSheet(const std::string& filename, const Calibration& calibration)
{
    const FileStorage fs = openDescription(filename, "a sheet of light, as refract_laser --sheet-out writes it");
    Sheet sheet;
    std::vector<double> camera;
    std::vector<double> plane, depth;
    int state = 4;
    if (!fs["emitter"].empty())
    {
        sheet.emitter = readEmitter(fs["emitter"], "'" + filename + "': emitter", true);
        state = 6 + columnsOf(*sheet.emitter.camera).end;
    }
    std::string colour;
    fs["sheet_plane"] >> plane;
    fs["covariance"] >> sheet.covariance;
    fs["by_parameters"] >> sheet.byParameters;
    fs["line_scale_px"] >> sheet.scale;
    fs["line_noise_px"] >> sheet.lineNoise;
    fs["laser"] >> colour;
    fs["depth"] >> depth;
    fs["unit"] >> sheet.unit;
    fs["camera_parameters"] >> camera;
    if (plane.size() != 4 || sheet.covariance.size() != Size(state, state) || sheet.byParameters.rows != state || !(sheet.scale > 0.) ||
        depth.size() != 2 || laserColourOf(colour) > LASER_ANY)
        throw Failure("'" + filename + "' is not a sheet of light: it must be what refract_laser --sheet-out wrote");
    sheet.plane = Vec4d(plane.data());
    sheet.depth = Vec2d(depth.data());
    sheet.colour = laserColourOf(colour);
    if (std::abs(norm(Vec3d(plane.data())) - 1.) > 1e-9)
        throw Failure("'" + filename + "': the normal of sheet_plane is not a unit vector");
    requireSameMedium(filename, camera, calibration.cameras[0]);
    if (!areSame(camera, parametersOf(*calibration.cameras[0].camera))
        || sheet.byParameters.cols != columnsOf(*calibration.cameras[0].camera).end)
        throw Failure("'" + filename + "' was calibrated with another camera calibration: calibrate the sheet again with this one "
                      "(--sheet-out)");
    return sheet;
}

void writeSheet(const std::string& filename, const Sheet& sheet, const Calibration& calibration)
{
    writeStorage(filename, ".yml", [&](FileStorage& fs) {
        fs << "sheet_plane" << std::vector<double>(sheet.plane.val, sheet.plane.val + 4);
        if (!isPlane(sheet))
        {
            fs << "emitter" << "{";
            writeEmitter(fs, sheet.emitter);
            fs << "}";
        }
        fs << "covariance" << sheet.covariance << "by_parameters" << sheet.byParameters;
        fs << "line_scale_px" << sheet.scale << "line_noise_px" << sheet.lineNoise << "laser" << laserColourNames()[sheet.colour];
        fs << "depth" << std::vector<double>(sheet.depth.val, sheet.depth.val + 2);
        fs << "unit" << sheet.unit << "camera_parameters" << parametersOf(*calibration.cameras[0].camera);
        fs << "command" << sheet.command << "refract_version" << REFRACT_VERSION << "calibration_time" << sheet.time;
    });
}

/* X with projection u and distance e = 0 from the sheet:     [G; n^T] dX = [du - A dp; -B ds]     G: pixel by point, A: pixel by lens and
window, n, B: distance by point and by the sheet's state s */
OnSheetDerivatives differentiateOnSheet(const Calibration& calibration, const Sheet& sheet, const std::vector<RidgePoint>& line,
                                        const std::vector<Point3d>& points)
{
    const SheetDistances from = isPlane(sheet) ? distancesFromPlane(sheet.plane, points) : distancesFromEmitter(sheet.emitter, points);
    const PointDerivatives d = differentiatePoints(calibration.cameras[0].camera, points, Vec3d(), Vec3d());
    const MatrixXd sheetByParameters = toEigen(sheet.byParameters);
    const Eigen::Index rows = 3*(Eigen::Index)points.size();
    OnSheetDerivatives result = {MatrixXd(rows, 1), MatrixXd(rows, from.byState.cols()), MatrixXd(rows, d.byParameters.cols())};
    for (size_t i = 0; i < points.size(); i++)
    {
        Eigen::Matrix3d M;
        M << d.byPose.block(2*i, 3, 2, 3), from.byPoint.row(i);
        const Eigen::Matrix3d inverse = inverse3(M);
        result.byAcross.middleRows(3*i, 3) = inverse*Eigen::Vector3d(line[i].across[0], line[i].across[1], 0.);
        result.byState.middleRows(3*i, 3) = -inverse.col(2)*from.byState.row(i);
        result.byParameters.middleRows(3*i, 3) = product(result.byState.middleRows(3*i, 3), sheetByParameters)
            - product(inverse.leftCols(2), d.byParameters.middleRows(2*i, 2));
    }
    return result;
}

Measurement measureOnSheet(const Calibration& calibration, const Sheet& sheet, const std::vector<RidgePoint>& line)
{
    const auto& camera = calibration.cameras[0].camera;
    std::vector<Point2d> pixels;
    for (const RidgePoint& r : line)
        pixels.push_back(r.pixel);
    Measurement result;
    result.pixels = {pixels};
    if (line.empty())
        return result;
    Mat origins, directions;
    refractiveUnprojectPoints(pixels, origins, directions, camera);
    pointsOnSheet(calibration, sheet, pixels, result.points, result.status);
    const SheetDistances from = isPlane(sheet) ? distancesFromPlane(sheet.plane, result.points)
                                               : distancesFromEmitter(sheet.emitter, result.points);
    const OnSheetDerivatives d = differentiateOnSheet(calibration, sheet, line, result.points);
    const MatrixXd C = covarianceOfCamera1(calibration, d.byParameters.cols()), ofSheet = toEigen(sheet.covariance);
    const double none = std::numeric_limits<double>::quiet_NaN();
    for (size_t i = 0; i < line.size(); i++)
    {
        const Vec3d direction = directions.at<Vec3d>((int)i), n(from.byPoint(i, 0), from.byPoint(i, 1), from.byPoint(i, 2));
        if (result.status[i] == REFRACT_OK && std::abs(n.dot(direction)) < IN_SHEET)
            result.status[i] = REFRACT_PARALLEL_RAYS;
        if (result.status[i] != REFRACT_OK)
        {
            result.points[i] = Point3d(none, none, none);
            result.sigma.push_back(Vec3d::all(none));
            continue;
        }
        Vec3d variance;
        for (int k = 0; k < 3; k++)
        {
            const Eigen::Index row = 3*(Eigen::Index)i + k;
            variance[k] = std::pow(line[i].sigma*d.byAcross(row, 0), 2)
                + propagated(ofSheet, d.byState.row(row))(0, 0)
                + propagated(C, d.byParameters.row(row))(0, 0);
        }
        result.sigma.emplace_back(std::sqrt(variance[0]), std::sqrt(variance[1]), std::sqrt(variance[2]));
    }
    return result;
}

} // namespace tools
