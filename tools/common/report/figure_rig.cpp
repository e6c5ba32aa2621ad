// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/rigid_transform.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"
#include "report/figures.hpp"
#include "report/plot.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>

/* The rig as a whole, to scale, drawn obliquely from above without perspective: cameras as pyramids, what their axes do at the
windows, the part of each window that they look through, and the measured volume. */

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

using Line = std::vector<Vec3d>;        // in the frame of camera 1

const double ELEVATION_DEG = 25.;

//! From the frame of camera 1 to paper.
class Projection
{
public:
    //! @param azimuthDeg from where: 0 from behind the cameras, 90 from their right
    Projection(const RigModel& rig, double azimuthDeg)
    {
        Vec3d up, ahead;
        for (const RigidTransform& cam_from_cam1 : rig.extrinsics)
        {
            const Matx33d& R = cam_from_cam1.R;
            up -= Vec3d(R(1, 0), R(1, 1), R(1, 2));
            ahead += Vec3d(R(2, 0), R(2, 1), R(2, 2));
        }
        const double ENOUGH = 0.1;      // of a camera's unit vector; less where they look from all sides
        up_ = norm(up) > ENOUGH*(double)rig.extrinsics.size() ? normalize(up) : Vec3d(0, -1, 0);
        ahead -= up_*up_.dot(ahead);
        if (norm(ahead) < ENOUGH*(double)rig.extrinsics.size())
            ahead = Vec3d(0, 0, 1) - up_*up_[2];
        const Vec3d forward = normalize(ahead), right = forward.cross(up_);
        const double a = azimuthDeg*CV_PI/180., e = ELEVATION_DEG*CV_PI/180.;
        x_ = std::cos(a)*right + std::sin(a)*forward;
        y_ = std::cos(e)*up_ + std::sin(e)*(std::cos(a)*forward - std::sin(a)*right);
    }

    Point2d operator()(const Vec3d& X) const { return {x_.dot(X), y_.dot(X)}; }

private:
    Vec3d up_, x_, y_;
};

class RigDrawing
{
public:
    explicit RigDrawing(const RigCalibration& c) : c_(c), rig_(c.fit.rig)
    {
        for (size_t k = 0; k < c.fit.views.size(); k++)
        {
            const View& view = c.data.views[c.fit.views[k]];
            const RigidTransform cam1_from_board = transformOf(c.fit.rvecs[k], c.fit.tvecs[k]);
            for (const Point3d& X : view.objectPoints)
                if (view.hasGlass())
                    points_.push_back(cam1_from_board.apply(Vec3d(X)));
        }
        for (const Vec3d& X : points_)
            middle_ += X*(1./(double)points_.size());
        for (int camera = 0; camera < c.data.cameraCount; camera++)
            size_ = std::max(size_, norm(inFirst(camera, Vec3d()) - middle_));
    }

    const std::vector<Vec3d>& points() const { return points_; }
    double size() const { return size_; }       //!< from the middle of the volume to the farthest camera
    Vec3d centre(int camera) const { return inFirst(camera, Vec3d()); }

    //! From the centre through the image's corners, and the image.
    std::vector<Line> pyramid(int camera) const
    {
        const double LENGTH = 0.1;
        const Size image = c_.data.imageSize[camera];
        const std::vector<Point2d> corners = {{-0.5, -0.5}, {image.width - 0.5, -0.5}, {image.width - 0.5, image.height - 0.5},
                                              {-0.5, image.height - 0.5}};
        const Matx33d inverse = Matx33d(rig_.cameras[camera]->cameraMatrix()).inv();
        Line frame;
        for (const Point2d& p : corners)
            frame.push_back(inFirst(camera, inverse*Vec3d(p.x, p.y, 1)*(LENGTH*size_)));
        frame.push_back(frame[0]);
        std::vector<Line> lines = {frame};
        for (int i = 0; i < 4; i++)
            lines.push_back({centre(camera), frame[i]});
        return lines;
    }

    //! The ray of the image's middle: centre, both surfaces, as far as the middle of the volume.
    Line axis(int camera) const
    {
        const Size image = c_.data.imageSize[camera];
        const std::vector<Line> paths = rays(camera, {{0.5*(image.width - 1), 0.5*(image.height - 1)}});
        return paths.empty() ? Line() : paths[0];
    }

    //! What the cameras that share a window need of its outer surface.
    Line window(int owner) const
    {
        std::vector<Vec3d> through;
        for (int camera = 0; camera < c_.data.cameraCount; camera++)
            if (rig_.sharesWindow(owner, camera))
                for (const Line& ray : rays(camera, borderOf(c_.data.imageSize[camera])))
                    through.push_back(ray[2]);
        if (through.size() < 3)
            return {};
        const GlassWindow window = rig_.cameras[owner]->window();
        const Vec3d n = rig_.extrinsics[owner].R.t()*(isRound(window) ? Vec3d(0, 0, 1) : window.normal);
        const Matx32d axes = tangents(n);
        std::vector<Point2f> flat;
        std::vector<int> hull;
        for (const Vec3d& X : through)
        {
            const Vec2d p = axes.t()*(X - through[0]);
            flat.emplace_back((float)p[0], (float)p[1]);
        }
        convexHull(flat, hull);
        Line outline;
        for (int i : hull)
            outline.push_back(through[i]);
        outline.push_back(outline[0]);
        return outline;
    }

private:
    Vec3d inFirst(int camera, const Vec3d& X) const { return rig_.extrinsics[camera].inverse(X); }

    static std::vector<Point2d> borderOf(Size image)
    {
        const int STEPS = 6;
        std::vector<Point2d> pixels;
        for (int i = 0; i < STEPS; i++)
        {
            const double x = image.width*i/(double)STEPS - 0.5, y = image.height*i/(double)STEPS - 0.5;
            pixels.insert(pixels.end(), {{x, -0.5}, {image.width - 0.5, y}, {image.width - 1 - x, image.height - 0.5},
                                         {-0.5, image.height - 1 - y}});
        }
        return pixels;
    }

    //! Paths of pixels that see something: centre, both surfaces, end.
    std::vector<Line> rays(int camera, const std::vector<Point2d>& pixels) const
    {
        const Ptr<RefractiveCamera> through = rig_.cameras[camera], bare = copyWithWindow(through, GlassWindow());
        const WindowFace first = WindowFace::first(through->window()), last = WindowFace::last(through->window());
        std::vector<Vec3d> origins, directions, innerOrigins, inner;
        refractiveUnprojectPoints(pixels, origins, directions, through);
        refractiveUnprojectPoints(pixels, innerOrigins, inner, bare);
        const Vec3d end = rig_.extrinsics[camera].apply(middle_);
        std::vector<Line> lines;
        for (size_t i = 0; i < pixels.size(); i++)
        {
            if (directions[i] != directions[i] || inner[i] != inner[i])
                continue;
            // A camera without a window has its centre in place of both faces.
            const Vec3d enters = inner[i]*std::max(0., first.along(Vec3d(), inner[i]));
            const double s = std::max(0., last.along(origins[i], directions[i]));
            const double far = std::max(s, (end - origins[i]).dot(directions[i]));
            lines.push_back({centre(camera), inFirst(camera, enters), inFirst(camera, origins[i] + s*directions[i]),
                             inFirst(camera, origins[i] + far*directions[i])});
        }
        return lines;
    }

    const RigCalibration& c_;
    const RigModel& rig_;
    std::vector<Vec3d> points_;
    Vec3d middle_;
    double size_ = 0.;
};

class Paper
{
public:
    Paper(const RigModel& rig, double azimuthDeg) : project_(rig, azimuthDeg), low_(INFINITY, INFINITY), high_(-low_) {}

    void draw(Plot& plot, const std::string& name, const std::vector<Line>& lines)
    {
        std::vector<std::vector<Point2d>> paths;
        for (const Line& line : lines)
        {
            paths.emplace_back();
            for (const Vec3d& X : line)
                paths.back().push_back(at(X));
        }
        plot.paths(name, paths);
    }

    Point2d at(const Vec3d& X)
    {
        const Point2d p = project_(X);
        low_ = Point2d(std::min(low_.x, p.x), std::min(low_.y, p.y));
        high_ = Point2d(std::max(high_.x, p.x), std::max(high_.y, p.y));
        return p;
    }

    Point2d low() const { return low_; }
    Point2d high() const { return high_; }

private:
    Projection project_;
    Point2d low_, high_;
};

//! A length that reads well: 1, 2 or 5 times a power of ten.
double roundLength(double x)
{
    const double power = std::pow(10., std::floor(std::log10(x))), lead = x/power;
    return power*(lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}

std::string drawnWindows(size_t count)
{
    std::string commands;
    for (size_t i = 0; i < count; i++)
        commands += format("$window%zu with filledcurves closed fillcolor rgb '#0284c7' fillstyle transparent solid 0.18 border rgb "
                           "'#0284c7' %s, ", i, i ? "notitle" : "title 'windows'");
    return commands;
}

} // namespace

Figure drawRig(const RigCalibration& c, double azimuthDeg)
{
    const RigDrawing drawing(c);
    Paper paper(c.fit.rig, azimuthDeg);
    Plot plot(640, 480);
    std::vector<Line> cameras, axes, windows;
    std::vector<std::vector<double>> points, names;
    for (int k = 0; k < c.data.cameraCount; k++)
    {
        const std::vector<Line> pyramid = drawing.pyramid(k);
        cameras.insert(cameras.end(), pyramid.begin(), pyramid.end());
        axes.push_back(drawing.axis(k));
        if (c.fit.rig.ownsWindow(k))
            windows.push_back(drawing.window(k));
        const Point2d name = paper.at(drawing.centre(k));
        names.push_back({name.x, name.y, k + 1.});
    }
    const size_t MOST = 2000, step = drawing.points().size()/MOST + 1;
    for (size_t i = 0; i < drawing.points().size(); i += step)
    {
        const Point2d point = paper.at(drawing.points()[i]);
        points.push_back({point.x, point.y});
    }
    plot.data("points", points);
    plot.data("names", names);
    paper.draw(plot, "cameras", cameras);
    paper.draw(plot, "axes", axes);
    for (size_t i = 0; i < windows.size(); i++)         // polygons of one block would be one
        paper.draw(plot, format("window%zu", i), {windows[i]});

    const double bar = roundLength(0.3*(paper.high().x - paper.low().x)), gap = 0.08*(paper.high().y - paper.low().y);
    const Point2d from(paper.low().x, paper.low().y - gap);
    plot.data("bar", {{from.x, from.y}, {from.x + bar, from.y}});
    plot << "set size ratio -1\nunset border\nunset tics\nunset grid\nset offsets graph 0.06, graph 0.06, graph 0.06, graph 0.06\n"
         << "set key outside top center horizontal maxrows 1 samplen 1.5\n"
         << "set label 1 " << Plot::quoted(format("%g %s", bar, c.unit.c_str())) << " at " << from.x + 0.5*bar << "," << from.y
         << " center offset 0,-0.8\n"
         << "plot $points with points pointtype 7 pointsize 0.25 linecolor rgb '#94a3b8' title 'points', "
         << drawnWindows(windows.size())
         << "$axes with lines linewidth 1 linecolor rgb '#f59e0b' title 'middle rays', "
         << "$cameras with lines linewidth 1.3 linecolor rgb '#0f172a' title 'cameras', "
         << "$names using 1:2:3 with labels offset 0,1 font ',12' textcolor rgb '#0f172a' notitle, "
         << "$bar with lines linewidth 2 linecolor rgb '#475569' notitle\n";
    const GlassWindow window = c.fit.rig.cameras[0]->window();
    const bool isHidden = !isRound(window) && !hasDifferentMedia(window);
    return {plot.svg(), isHidden ? "the windows' distances do not show in the images, they are drawn as given" : ""};
}

} // namespace tools
