// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/window_face.hpp"
#include "console/csv.hpp"
#include "console/failure.hpp"
#include "export/export_files.hpp"
#include "formats/colmap_cameras.hpp"
#include <opencv2/calib3d.hpp>
#include <cmath>
#include <map>

namespace tools {

using cv::Point2d;
using cv::refract::GlassWindow;
using cv::refract::RefractiveCamera;

std::vector<MeasuredPoint> readMeasuredPoints(const std::string& path, int cameras)
{
    std::vector<std::string> required = {"image"};
    for (int c = 1; c <= cameras; c++)
        for (const char* const coordinate : {"u", "v"})
            required.push_back(coordinate + std::to_string(c));
    required.insert(required.end(), {"x", "y", "z"});
    const CsvTable table(path, required, "what refract_measure writes for these cameras");
    std::vector<MeasuredPoint> points;
    for (const CsvTable::Row& row : table.rows())
    {
        const auto numberOf = [&](const std::string& name) { return table.numberOrNone(row, name); };
        MeasuredPoint point = {table.text(row, "image"), {}, {numberOf("x"), numberOf("y"), numberOf("z")}};
        for (int c = 1; c <= cameras; c++)
            point.pixels.emplace_back(numberOf("u" + std::to_string(c)), numberOf("v" + std::to_string(c)));
        if (std::isfinite(point.X.x + point.X.y + point.X.z))
            points.push_back(point);
    }
    return points;
}

ColmapPort colmapPortOf(const GlassWindow& window, const std::string& name, const std::string& program)
{
    if (!refracts(window))
        return {};
    const bool isDome = window.shape == cv::refract::WINDOW_DOME, isFlat = window.shape == cv::refract::WINDOW_FLAT;
    if ((!isDome && !isFlat) || window.thickness.size() > 1)
        throw Failure(name + " looks through a window that " + program + " has none like: it has flat ones and domes, of one layer");
    for (const cv::Vec2d& wedge : window.wedge)
        if (wedge != cv::Vec2d())
            throw Failure(name + " looks through a window with a wedge, and " + program + " has none: calibrate with --wedge-std=0");
    const bool isBare = window.thickness.empty();       // a surface is a port of no thickness, whose index does not matter
    const cv::Vec3d where = isDome ? window.center : window.normal;
    return {isDome ? "DOMEPORT" : "FLATPORT",
            {where[0], where[1], where[2], isDome ? window.radius : window.distance, isBare ? 0. : window.thickness[0],
             window.innerIndex, isBare ? window.outerIndex : window.index[0], window.outerIndex}};
}

ColmapCamera exactColmapCamera(const RefractiveCamera& camera, uint32_t id, const std::string& name, const std::string& program)
{
    const size_t MOST = 4 + 8;          // focal lengths, centre, coefficients
    const bool isFisheye = camera.lensModel() == "fisheye";
    if ((!isFisheye && (camera.lensModel() != "opencv" || camera.lensParameters().total() > MOST))
        || camera.cameraMatrix().at<double>(0, 1) != 0.)
        throw Failure(name + " has a lens that " + program + " has none like: it has OpenCV's with up to eight coefficients, and "
                      "cv::fisheye's without skew");
    return colmapCameraOf(camera, id);
}

namespace {

std::string cameraLine(const ColmapCamera& own, const ColmapPort& port)
{
    std::string line = cv::format("%u %s %d %d", own.id, own.model.c_str(), (int)own.width, (int)own.height);
    for (double parameter : own.parameters)
        line += cv::format(" %.17g", parameter);
    line += port.model.empty() ? "" : " " + port.model;
    for (double parameter : port.parameters)
        line += cv::format(" %.17g", parameter);
    return line + "\n";
}

//! A camera at a view.
struct Image
{
    int camera;
    std::string name;
    std::vector<std::pair<Point2d, int>> points;        // where, and number of the 3-D point
};

/* Where the central camera would have seen a point: its own projection of it, and beside that what the true one was off by, so
that what a bundle adjustment finds of the noise stays what it was. */
struct CorrectedPixel
{
    CorrectedPixel(const ExportedCamera& camera, const cv::Point3d& X, const Point2d& raw)
    {
        std::vector<Point2d> central, refracted;
        const std::vector<cv::Point3d> point{X};
        cv::refract::refractiveProjectPoints(point, camera.pose.R, camera.pose.t, camera.central.camera, central);
        cv::refract::refractiveProjectPoints(point, camera.truePose.R, camera.truePose.t, camera.trueCamera, refracted);
        residual = raw - refracted[0];
        pixel = central[0] + residual;
    }
    bool isSeen() const { return pixel.x == pixel.x && pixel.y == pixel.y; }
    Point2d pixel, residual;
};

//! COLMAP's model, line by line.
class Model
{
public:
    Model(const CentralRig& rig, const std::string& extension) : rig_(rig), extension_(extension) {}

    void add(const MeasuredPoint& point)
    {
        std::string track;
        double errors = 0;
        int seen = 0;
        for (int c = 0; c < (int)rig_.cameras.size(); c++)
        {
            const CorrectedPixel corrected(rig_.cameras[c], point.X, point.pixels[c]);
            if (!corrected.isSeen())
                continue;
            const int index = imageOf(c, point.image);
            track += cv::format(" %d %d", index + 1, (int)images_[index].points.size());
            images_[index].points.push_back({corrected.pixel, count_ + 1});
            errors += cv::norm(corrected.residual);
            seen++;
        }
        if (seen == 0)
            return;
        count_++;
        points_ += cv::format("%d %.17g %.17g %.17g 255 255 255 %.6g", count_, point.X.x, point.X.y, point.X.z, errors/seen) + track
                   + "\n";
    }

    //! Of a rig without points: one image a camera.
    void addImages()
    {
        for (int c = 0; c < (int)rig_.cameras.size(); c++)
            imageOf(c, "");
    }

    std::string images() const
    {
        std::string text;
        for (size_t i = 0; i < images_.size(); i++)
        {
            const ExportedCamera& camera = rig_.cameras[images_[i].camera];
            const cv::Vec4d q = cv::refract::quaternionOf(camera.pose.R);
            text += cv::format("%d %.17g %.17g %.17g %.17g %.17g %.17g %.17g %d ", (int)i + 1, q[0], q[1], q[2], q[3], camera.pose.t[0],
                               camera.pose.t[1], camera.pose.t[2], images_[i].camera + 1) + images_[i].name + "\n";
            for (const auto& point : images_[i].points)
                text += cv::format("%.10g %.10g %d ", point.first.x + COLMAP_CORNER, point.first.y + COLMAP_CORNER, point.second);
            text += "\n";
        }
        return text;
    }
    const std::string& points() const { return points_; }

private:
    int imageOf(int camera, const std::string& view)
    {
        const auto key = std::make_pair(camera, view);
        const auto known = index_.find(key);
        if (known != index_.end())
            return known->second;
        const std::string& name = rig_.cameras[camera].name;
        images_.push_back({camera, view.empty() ? name : name + "/" + view + extension_, {}});
        return index_[key] = (int)images_.size() - 1;
    }

    const CentralRig& rig_;
    const std::string extension_;
    std::vector<Image> images_;
    std::map<std::pair<int, std::string>, int> index_;
    std::string points_;
    int count_ = 0;
};

//! @param head first line of each file @param cameras lines of cameras.txt
std::vector<ExportFile> filesOf(const std::string& head, const std::string& cameras, const CentralRig& rig,
                                const std::vector<MeasuredPoint>& points, const std::string& extension)
{
    Model model(rig, extension);
    for (const MeasuredPoint& point : points)
        model.add(point);
    if (points.empty())
        model.addImages();
    return {{"cameras.txt", head + cameras},
            {"images.txt", head + "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME\n# POINTS2D[] as X Y POINT3D_ID\n" + model.images()},
            {"points3D.txt", head + "# POINT3D_ID X Y Z R G B ERROR TRACK[] as IMAGE_ID POINT2D_IDX\n" + model.points()}};
}

} // namespace

std::vector<ExportFile> colmapFiles(const CentralRig& rig, const std::vector<MeasuredPoint>& points, const std::string& extension)
{
    std::string cameras = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n";
    for (size_t c = 0; c < rig.cameras.size(); c++)
        cameras += "# " + errorText(rig, rig.cameras[c]) + "\n"
            + cameraLine(colmapCameraOf(*rig.cameras[c].central.camera, (uint32_t)c + 1), {});
    return filesOf("# " + headText(rig) + "\n", cameras, rig, points, extension);
}

std::vector<ExportFile> underwaterColmapFiles(const Calibration& calibration, const std::string& source,
                                              const std::vector<MeasuredPoint>& points, const std::string& extension)
{
    const std::string program = "COLMAP for cameras under water";
    CentralRig rig = {{}, source, {}, calibration.unit};        // each camera is its own
    std::string cameras = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[] OPTIONAL[REFRAC_MODEL REFRAC_PARAMS[]]\n";
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        const cv::Ptr<cv::refract::RefractiveCamera> camera = calibration.cameras[c].camera;
        const RigidTransform& pose = calibration.extrinsics[c];
        const std::string name = cv::format("camera%zu", c + 1);
        rig.cameras.push_back({name, camera, pose, {camera, RigidTransform(), {}}, pose});
        cameras += cameraLine(exactColmapCamera(*camera, (uint32_t)c + 1, name, program), colmapPortOf(camera->window(), name, program));
    }
    return filesOf("# of " + source + (rig.unit.empty() ? "" : ", lengths in " + rig.unit) + "\n", cameras, rig, points, extension);
}

/* Calibmar knows windows: what it can be told is exact. Its lenses and ports are COLMAP's, whose pixel (0, 0) is a corner. */

namespace {

std::string listOf(const std::vector<double>& numbers)
{
    std::string text;
    for (double number : numbers)
        text += cv::format("%s%.17g", text.empty() ? "" : ", ", number);
    return "[" + text + "]";
}

} // namespace

std::vector<ExportFile> calibmarFiles(const Calibration& calibration, const std::string& source)
{
    std::vector<ExportFile> files;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        const cv::refract::RefractiveCamera& camera = *calibration.cameras[c].camera;
        const std::string name = cv::format("camera%zu", c + 1);
        const ColmapCamera lens = exactColmapCamera(camera, 1, name, "Calibmar");
        const ColmapPort port = colmapPortOf(camera.window(), name, "Calibmar");
        files.push_back({name + ".yaml", "# of " + source + (calibration.unit.empty() ? "" : ", lengths in " + calibration.unit) + "\n"
            + "model: " + lens.model + "\nparameters: " + listOf(lens.parameters) + "\n"
            + "non_svp_model: " + (port.model.empty() ? "NONE" : port.model) + "\nnon_svp_parameters: " + listOf(port.parameters) + "\n"
            + cv::format("width: %d\nheight: %d\n", camera.imageSize().width, camera.imageSize().height)});
    }
    return files;
}

} // namespace tools
