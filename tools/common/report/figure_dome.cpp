// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/round_window.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"
#include "report/figures.hpp"
#include "report/plot.hpp"
#include "math/dense.hpp"
#include <algorithm>
#include <cmath>

/* The section of a dome or tube with the plane of the optical axis and the direction from the camera to the centre: where the camera
sits. In that plane a ray stays when it is refracted by a dome. */

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

using Path = std::vector<Point2d>;      // (z, across)

const int RAYS = 9;
const double REACH = 1.7;               // of the outer radius: how far rays are drawn

class Section
{
public:
    Section(const RigCalibration& c, int camera)
        : c_(c), camera_(camera), through_(c.fit.rig.cameras[camera]), window_(through_->window()),
          outer_(window_.radius + glassOf(window_))
    {
        const double beside = std::hypot(window_.center[0], window_.center[1]);
        across_ = beside > 1e-9*window_.radius ? Vec3d(window_.center[0]/beside, window_.center[1]/beside, 0) : Vec3d(1, 0, 0);
        // A tube is cut across its axis, as far as the optical axis allows.
        const double upright = std::hypot(window_.axis[0], window_.axis[1]);
        if (window_.shape == WINDOW_TUBE && upright > 0.1)
            across_ = Vec3d(window_.axis[1]/upright, -window_.axis[0]/upright, 0);
    }

    //! The pixels along the line of the image in which the plane meets it.
    std::vector<Path> rays() const
    {
        const Size size = c_.data.imageSize[camera_];
        const Matx33d K = through_->cameraMatrix();
        const Point2d middle(K(0, 2), K(1, 2)), along(across_[0], across_[1]);
        const double half = 0.5*std::min(size.width/std::max(1e-9, std::abs(along.x)), size.height/std::max(1e-9, std::abs(along.y)));
        std::vector<Point2d> pixels;
        for (int i = 0; i < RAYS; i++)
            pixels.push_back(middle + along*(0.95*half*(2.*i/(RAYS - 1) - 1.)));
        std::vector<Vec3d> origins, directions, innerOrigins, inner;
        refractiveUnprojectPoints(pixels, origins, directions, through_);
        refractiveUnprojectPoints(pixels, innerOrigins, inner, copyWithWindow(through_, GlassWindow()));
        const WindowFace first = WindowFace::first(window_), last = WindowFace::last(window_);
        std::vector<Path> paths;
        for (size_t i = 0; i < pixels.size(); i++)
        {
            const Vec3d leaves = last.meets(origins[i], directions[i]);
            if (leaves == leaves)
                paths.push_back({onPaper(Vec3d()), onPaper(first.meets(Vec3d(), inner[i])), onPaper(leaves),
                                 onPaper(leaves + (REACH - 1.)*outer_*directions[i])});
        }
        return paths;
    }

    //! A face: all lines of the plane through the camera meet it.
    Path face(const WindowFace& of) const
    {
        const int STEPS = 180;
        Path path;
        for (int i = 0; i <= STEPS; i++)
        {
            const double angle = 2.*CV_PI*i/STEPS;
            path.push_back(onPaper(of.meets(Vec3d(), Vec3d(0, 0, std::cos(angle)) + std::sin(angle)*across_)));
        }
        return path;
    }

    Path inner() const { return face(WindowFace::first(window_)); }
    Path outer() const { return face(WindowFace::last(window_)); }
    Path centre() const { return {onPaper(window_.center)}; }

    //! One standard deviation of the centre, so many times.
    Path ellipse(double widened) const
    {
        const ParameterColumns at = columnsOf(c_.fit.rig, camera_);
        const Matx33d C = Mat(c_.fit.covariance(Rect(at.center, at.center, 3, 3)));
        const Vec3d z(0, 0, 1);
        Eigen::Matrix2d onPlane;
        onPlane << z.dot(C*z), z.dot(C*across_), z.dot(C*across_), across_.dot(C*across_);
        const SymmetricEigen eigen(onPlane);
        const Eigen::Vector2d std = eigen.values.cwiseMax(0.).cwiseSqrt();
        Path path;
        const int STEPS = 60;
        for (int i = 0; i <= STEPS; i++)
        {
            const double angle = 2.*CV_PI*i/STEPS;
            const Eigen::Vector2d p = widened*timesVector(eigen.vectors, Eigen::Vector2d(std[0]*std::cos(angle), std[1]*std::sin(angle)));
            path.push_back(onPaper(window_.center) + Point2d(p[0], p[1]));
        }
        return path;
    }

    const GlassWindow& window() const { return window_; }

private:
    Point2d onPaper(const Vec3d& X) const { return {X[2], across_.dot(X)}; }

    const RigCalibration& c_;
    int camera_;
    Ptr<RefractiveCamera> through_;
    GlassWindow window_;
    double outer_;
    Vec3d across_;
};

} // namespace

Figure drawDome(const RigCalibration& c, int camera)
{
    const Section section(c, camera);
    const double std = placeStd(c.fit.covariance, c.fit.rig, camera), SEEN = 0.03*section.window().radius;
    const double widened = std > 0 ? std::max(1., std::pow(10., std::ceil(std::log10(SEEN/std)))) : 1.;
    // The outer face there, the inner one back: the glass between them.
    Path glass = section.outer(), back = section.inner();
    glass.insert(glass.end(), back.rbegin(), back.rend());
    Plot plot(520, 460);
    plot.paths("rays", section.rays());
    plot.paths("glass", {glass});
    plot.paths("ellipse", {section.ellipse(widened)});
    plot.paths("centre", {section.centre()});
    plot << "set size ratio -1\nset xlabel " << Plot::quoted("z, away from the camera, " + c.unit) << "\nset ylabel "
         << Plot::quoted("towards the centre, " + c.unit) << "\nset key outside top center horizontal maxrows 1 samplen 1.5\n"
         << "plot $glass with filledcurves closed fillcolor rgb '#0284c7' fillstyle solid 0.3 border rgb '#0284c7' title '"
         << nameOfShape(section.window()) << "', $rays with lines linewidth 1.5 linecolor rgb '#f59e0b' title 'rays', "
         << "$ellipse with filledcurves closed fillcolor rgb '#dc2626' fillstyle solid 0.25 border rgb '#dc2626' title 'centre, +- std x "
         << widened << "', $centre with points pointtype 2 pointsize 1 linecolor rgb '#dc2626' notitle, "
         << "'+' using (0):(0) every ::0::0 with points pointtype 7 pointsize 1 linecolor rgb '#0f172a' title 'camera'\n";
    const RoundWindow round = *roundWindowOf(c, camera);
    return {plot.svg(), "the centre is " + round.offsetWords(c.unit)};
}

} // namespace tools
