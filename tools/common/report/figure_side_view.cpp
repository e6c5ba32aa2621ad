// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"
#include "report/figures.hpp"
#include "report/plot.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>

/* Camera, window and boards seen from above (x to the right) or from the side (y down); z to the right, to scale.
Everything is projected along the third axis, but the window, which is cut where that axis is zero. */

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

using Path = std::vector<Point2d>;      // (z, x) or (z, y)

class SideView
{
public:
    SideView(const RigCalibration& calibration, int camera, int axis)
        : c_(calibration), camera_(camera), axis_(axis), through_(calibration.fit.rig.cameras[camera]),
          window_(through_->window()), first_(WindowFace::first(window_)), last_(WindowFace::last(window_)),
          farthest_(workingDepth(calibration, camera)[2])
    {}

    Path onPaper(const std::vector<Vec3d>& points) const
    {
        Path path;
        for (const Vec3d& p : points)
            path.emplace_back(p[2], p[axis_]);
        return path;
    }

    //! The rays of the middles of two opposite image borders: centre, both surfaces, a little beyond the farthest board.
    std::vector<Path> fieldOfView() const
    {
        const Size size = c_.data.imageSize[camera_];
        const Point2d middle((size.width - 1)/2., (size.height - 1)/2.);
        const std::vector<Point2d> pixels = axis_ == 0
            ? std::vector<Point2d>{{-0.5, middle.y}, {size.width - 0.5, middle.y}}
            : std::vector<Point2d>{{middle.x, -0.5}, {middle.x, size.height - 0.5}};
        std::vector<Vec3d> origins, directions, innerOrigins, inner;
        refractiveUnprojectPoints(pixels, origins, directions, through_);
        refractiveUnprojectPoints(pixels, innerOrigins, inner, copyWithWindow(through_, GlassWindow()));
        std::vector<Path> rays;
        for (size_t i = 0; i < pixels.size(); i++)
        {
            if (directions[i] != directions[i])     // the border sees nothing through this window
                continue;
            const Vec3d enters = first_.meets(Vec3d(), inner[i]), leaves = last_.meets(origins[i], directions[i]);
            const Vec3d end = origins[i] + directions[i]*((1.1*farthest_ - origins[i][2])/directions[i][2]);
            rays.push_back(onPaper({Vec3d(), enters, leaves, end}));
        }
        return rays;
    }

    //! Outlines of the boards seen through the window.
    std::vector<Path> boards() const
    {
        std::vector<Path> outlines;
        for (size_t k = 0; k < c_.fit.views.size(); k++)
        {
            if (!c_.data.views[c_.fit.views[k]].hasGlass(camera_))
                continue;
            Vec3d rvec, tvec;
            poseInCamera(c_.fit, k, camera_, rvec, tvec);
            const RigidTransform cam_from_board = transformOf(rvec, tvec);
            std::vector<Vec3d> points;
            for (const Point3d& X : c_.data.views[c_.fit.views[k]].objectPoints)
                points.push_back(cam_from_board.apply(Vec3d(X)));
            outlines.push_back(outlineOf(onPaper(points)));
        }
        return outlines;
    }

    //! The section of the layers with the plane of the paper, long enough for the field of view.
    Path section(double halfLength) const
    {
        if (window_.shape != WINDOW_FLAT)
            return curvedSection();
        const double from = window_.distance, to = from + glass();
        const Vec2d n(window_.normal[2], window_.normal[axis_]);
        const double length = std::sqrt(n.dot(n));
        const Vec2d unit = n/length, along(-unit[1], unit[0]);
        Path path;
        for (const auto& corner : {std::make_pair(from, -1.), std::make_pair(from, 1.), std::make_pair(to, 1.),
                                   std::make_pair(to, -1.)})
        {
            const Vec2d p = unit*(corner.first/length) + along*(corner.second*halfLength);
            path.emplace_back(p[0], p[1]);
        }
        return path;
    }

    //! Of faces that are met by all lines of the paper's plane through the camera: from one side of the image to the other, and more.
    Path curvedSection() const
    {
        const Size size = c_.data.imageSize[camera_];
        const Matx33d K = through_->cameraMatrix();
        const double WIDER = 1.3, half = std::min(80.*CV_PI/180., WIDER*std::atan2(0.5*(axis_ == 0 ? size.width : size.height),
                                                                                  K(axis_, axis_)));
        const int STEPS = 40;
        std::vector<Vec3d> inside, outside;
        for (int i = 0; i <= STEPS; i++)
        {
            Vec3d along(0, 0, std::cos(half*(2.*i/STEPS - 1.)));
            along[axis_] = std::sin(half*(2.*i/STEPS - 1.));
            inside.push_back(first_.meets(Vec3d(), along));
            outside.insert(outside.begin(), last_.meets(Vec3d(), along));
        }
        inside.insert(inside.end(), outside.begin(), outside.end());
        return onPaper(inside);
    }

    //! Angle of the normal on paper and its standard deviation.
    void normalAngle(double& angle, double& std) const
    {
        const Vec3d n = window_.normal;
        const int at = columnsOf(c_.fit.rig, camera_).normal;
        const Mat cov = c_.fit.covariance(Rect(at, at, 3, 3));
        const double squared = n[2]*n[2] + n[axis_]*n[axis_];
        const double gAxis = n[2]/squared, gZ = -n[axis_]/squared;      // of atan2(n[axis], n[2])
        angle = std::atan2(n[axis_], n[2]);
        std = std::sqrt(std::max(0., gAxis*gAxis*cov.at<double>(axis_, axis_) + gZ*gZ*cov.at<double>(2, 2)
                                 + 2*gAxis*gZ*cov.at<double>(axis_, 2)));
    }

    const GlassWindow& window() const { return window_; }
    double glass() const { return glassOf(window_); }
    //! To the last face.
    double depth() const { return isRound(window_) ? last_.along(Vec3d(), Vec3d(0, 0, 1)) : window_.distance + glass(); }
    double farthest() const { return farthest_; }

private:
    static Path outlineOf(const Path& points)
    {
        std::vector<Point2f> all(points.begin(), points.end()), hull;
        convexHull(all, hull);
        Path outline(hull.begin(), hull.end());
        outline.push_back(outline[0]);
        return outline;
    }

    const RigCalibration& c_;
    int camera_, axis_;
    Ptr<RefractiveCamera> through_;
    GlassWindow window_;
    WindowFace first_, last_;
    double farthest_;
};

//! The cone of the normal: from the centre, +- one standard deviation widened by a factor.
Path cone(double angle, double halfWidth, double length)
{
    Path path{Point2d(0, 0)};
    for (int i = -8; i <= 8; i++)
    {
        const double a = angle + halfWidth*i/8.;
        path.emplace_back(length*std::cos(a), length*std::sin(a));
    }
    path.emplace_back(0, 0);
    return path;
}

} // namespace

Figure drawSideView(const RigCalibration& calibration, int camera, int axis)
{
    const SideView view(calibration, camera, axis);
    const std::vector<Path> rays = view.fieldOfView();
    double half = 0.;       // of the window as drawn
    for (const Path& ray : rays)
        half = std::max({half, std::abs(ray[1].y), std::abs(ray[2].y)});
    half = std::max(1.6*half, 0.08*view.farthest());

    const bool hasNormal = !isRound(view.window());
    double angle = 0., std = 0.;
    if (hasNormal)
        view.normalAngle(angle, std);
    const double widened = std > 0 ? std::max(1., std::pow(10., std::ceil(std::log10(2./(std*180./CV_PI))))) : 1.;
    const double length = std::max(0.4*view.farthest(), 1.3*view.depth());

    Plot plot(640, 420);
    plot.paths("rays", rays);
    plot.paths("boards", view.boards());
    // A surface without thickness (bare water) is a line.
    plot.paths("glass", {view.section(half)});
    if (hasNormal)
    {
        plot.paths("cone", {cone(angle, widened*std, length)});
        plot.paths("normal", {Path{Point2d(0, 0), Point2d(length*std::cos(angle), length*std::sin(angle))}});
    }
    plot << "set size ratio -1\nset xlabel " << Plot::quoted("z, away from the camera", calibration.unit) << "\nset ylabel "
         << Plot::quoted(axis == 0 ? "x, to the right" : "y, downwards", calibration.unit) << "\nset yrange [*:*] " << "reverse\n"
         << "set key outside top center horizontal maxrows 1 samplen 1.5\n"
         << "plot $boards with lines linecolor rgb '#94a3b8' title 'boards', ";
    if (hasNormal)
        plot << "$cone with filledcurves closed fillcolor rgb '#dc2626' fillstyle solid 0.25 noborder title 'normal, +- std x "
             << widened << "', $normal with lines linewidth 1.5 linecolor rgb '#dc2626' notitle, ";
    plot << "$rays with lines linewidth 1.5 linecolor rgb '#f59e0b' title 'field of view', "
         << (view.glass() > 0 ? "$glass with filledcurves closed fillcolor rgb '#0284c7' fillstyle solid 0.3 border rgb '#0284c7'"
                              : "$glass with lines linewidth 2 linecolor rgb '#0284c7'")
         << " title 'window', '+' using (0):(0) every ::0::0 with points pointtype 7 pointsize 1 linecolor rgb '#0f172a' "
         << "title 'camera'\n";
    const GlassWindow& window = view.window();
    if (!hasNormal)
        return {plot.svg(), ""};
    std::string note = widened > 1 ? format("the cone of the normal is widened %g times", widened)
                                   : std::string("the cone of the normal is drawn as it is");
    if (!hasDifferentMedia(window))
        note += format("; the window's distance does not show in the images, it is drawn at %.3g %s", window.distance,
                       calibration.unit.c_str());
    return {plot.svg(), note};
}

} // namespace tools
