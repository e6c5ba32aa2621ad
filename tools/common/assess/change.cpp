// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/change.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/rig_data.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double DEGREE = CV_PI/180.;
const double FAR = 10.*DEGREE, WIDE = 0.2;      // of angles, and of lengths and factors: share of their size

Vec3d first3(const VectorXd& delta, int at = 0) { return Vec3d(delta[at], delta[at + 1], delta[at + 2]); }

void changeWindow(RigModel& rig, int c, const std::function<void(GlassWindow&)>& change)
{
    GlassWindow window = rig.cameras[c]->window();
    change(window);
    rig.cameras[c]->setWindow(window);
}

//! Of all cameras that look through the window of one of them.
void changePane(RigModel& rig, int c, const std::function<void(GlassWindow&)>& change)
{
    for (int k = 0; k < (int)rig.cameras.size(); k++)
        if (rig.sharesWindow(c, k))
            changeWindow(rig, k, change);
}

//! About the first camera's centre of projection, along that camera's axes, and nearer to where it looks.
void moveWindow(RigModel& rig, int owner, double tilt1, double tilt2, double nearer)
{
    changeWindow(rig, owner, [&](GlassWindow& window) {
        const Vec3d n = window.normal, across = normalize(n.cross(Vec3d(0, 1, 0)));
        window.normal = normalize(n + tilt1*across + tilt2*n.cross(across));
        window.distance = std::max(0., window.distance + nearer); });
    shareWindow(rig, owner);
}

//! A centre moves as a point of its first camera's frame; of a tube, whose axis turns about it, across the axis.
void moveCentre(RigModel& rig, int owner, const Vec3d& by)
{
    changeWindow(rig, owner, [&](GlassWindow& window) { window.center += by; });
    shareWindow(rig, owner);
}

void turnAxis(RigModel& rig, int owner, const Vec3d& by)
{
    changeWindow(rig, owner, [&](GlassWindow& window) { window.axis = normalize(window.axis + by); });
    shareWindow(rig, owner);
}

void changeLens(RigModel& rig, int c, double factor, const Vec2d& shift = {})
{
    Mat lens = rig.cameras[c]->lensParameters().clone();
    lens.at<double>(0) *= factor;
    lens.at<double>(1) *= factor;
    lens.at<double>(2) += shift[0];
    lens.at<double>(3) += shift[1];
    rig.cameras[c]->setLensParameters(lens);
}

//! The camera as it was sees with this motion what it now sees: X -> motion X in its own frame.
void moveCamera(RigModel& rig, int c, const RigidTransform& motion)
{
    if (c > 0)
    {
        rig.extrinsics[c] = motion*rig.extrinsics[c];
        return;
    }
    const RigidTransform back = motion.inverse();
    for (size_t k = 1; k < rig.extrinsics.size(); k++)
        rig.extrinsics[k] = rig.extrinsics[k]*back;
}

class ChangeTable
{
public:
    ChangeTable(const RigModel& rig, const std::string& unit, const Vec3d& middle)
        : rig_(rig), unit_(unit), middle_(middle), count_((int)rig.cameras.size()), depth_(std::max(1e-9, norm(middle)))
    {
        for (int c = 0; c < count_; c++)
            addWindow(c);
        addMedium();
        for (int c = 0; c < count_; c++)
            addLens(c);
        addAllLenses();
        for (int c = 0; c < count_; c++)
            addPlace(c);
        addTarget();
    }
    std::vector<Change> rows;

private:
    ChangedQuantity angle(int count) const { return {"degrees", 1./DEGREE, count, FAR}; }
    ChangedQuantity length(int count, double range) const { return {unit_, 1., count, range}; }
    static ChangedQuantity percent(double range) { return {"%", 100., 1, range}; }

    void add(const std::string& name, int camera, const std::vector<ChangedQuantity>& quantities,
             const std::function<void(RigModel&, const VectorXd&)>& apply)
    {
        rows.push_back({name, camera, quantities, apply});
    }

    //! The last row has a control chart.
    void chart(const std::string& name, const std::vector<std::string>& axes, double sign = 1.)
    {
        rows.back().chart = name;
        rows.back().axes = axes;
        rows.back().chartFactor = sign*rows.back().quantities[0].factor;
    }

    //! "window", or "window of camera 2", or "dome of cameras 1, 2".
    std::string windowName(int c) const
    {
        std::string cameras;
        int sharing = 0;
        for (int k = 0; k < count_; k++)
            if (rig_.sharesWindow(c, k))
                cameras += (sharing++ ? ", " : "") + std::to_string(k + 1);
        const std::string window = isRound(rig_.cameras[c]->window()) ? nameOfShape(rig_.cameras[c]->window()) : "window";
        return count_ == 1 ? window : window + " of camera" + std::string(sharing > 1 ? "s " : " ") + cameras;
    }

    void addWindow(int c)
    {
        if (!rig_.ownsWindow(c) || !refracts(rig_.cameras[c]->window()))
            return;
        const GlassWindow window = rig_.cameras[c]->window();
        const std::string name = windowName(c);
        if (isRound(window))
        {
            addRound(c, window, name);
            return;
        }
        add(name + " tilted by", c, {angle(2)}, [c](RigModel& rig, const VectorXd& d) { moveWindow(rig, c, d[0], d[1], 0.); });
        rows.back().isTilt = true;
        chart(name + ": tilt", {"x", "y"}, -1.);        // moveWindow's axes point against the image's
        if (hasDifferentMedia(rig_.cameras[c]->window()))
        {
            const ChangedQuantity nearer = length(1, WIDE*depth_);
            add("distance of the " + name + " changed by", c, {nearer},
                [c](RigModel& rig, const VectorXd& d) { moveWindow(rig, c, 0., 0., d[0]); });
            chart(name + ": distance", {""});
            add(name + " tilted and shifted by", c, {angle(2), nearer},
                [c](RigModel& rig, const VectorXd& d) { moveWindow(rig, c, d[0], d[1], d[2]); });
        }
        for (size_t i = 0; i < window.thickness.size(); i++)
            addLayer(c, i, window, name);
        // The angles of a wedge, and what they do to a thickness, are another camera's other numbers.
        const bool isAlone = (int)std::count_if(rig_.windows.begin(), rig_.windows.end(),
                                                [&](int w) { return w == rig_.windows[c]; }) <= 1;
        if (!window.wedge.empty() && isAlone)
            addWedge(c, name);
    }

    //! A dome's centre along the camera's axes, a tube's across its own.
    void addRound(int c, const GlassWindow& window, const std::string& name)
    {
        const bool isTube = window.shape == WINDOW_TUBE;
        const Vec3d u = isTube ? normalize(std::abs(window.axis[0]) < 0.7 ? Vec3d(1, 0, 0) - window.axis[0]*window.axis
                                                                         : Vec3d(0, 1, 0) - window.axis[1]*window.axis) : Vec3d(1, 0, 0);
        const Vec3d v = isTube ? window.axis.cross(u) : Vec3d(0, 1, 0);
        const auto shift = [=](const VectorXd& d) { return d[0]*u + d[1]*v + (isTube ? 0. : d[2])*Vec3d(0, 0, 1); };
        add(name + (isTube ? " moved across its axis by" : " moved by"), c, {length(isTube ? 2 : 3, WIDE*window.radius)},
            [c, shift](RigModel& rig, const VectorXd& d) { moveCentre(rig, c, shift(d)); });
        rows.back().isShift = true;
        chart(name + ": centre", isTube ? std::vector<std::string>{"1", "2"} : std::vector<std::string>{"x", "y", "z"});
        if (isTube)
        {
            add("axis of the " + name + " turned by", c, {angle(2)}, [c, u, v](RigModel& rig, const VectorXd& d) {
                turnAxis(rig, c, d[0]*u + d[1]*v); });
            rows.back().isAxis = true;
        }
        add("radius of the " + name + " changed by", c, {length(1, WIDE*window.radius)},
            [c](RigModel& rig, const VectorXd& d) { changePane(rig, c, [&](GlassWindow& w) { w.radius += d[0]; }); });
        rows.back().isOfAnotherPane = true;
        for (size_t i = 0; i < window.thickness.size(); i++)
            addLayer(c, i, window, name);
    }

    void addLayer(int c, size_t i, const GlassWindow& window, const std::string& name)
    {
        const std::string layer = window.thickness.size() > 1 ? format(" of layer %zu", i + 1) : "";
        const std::string of = layer + " of the " + name + " changed by";
        add("thickness" + of, c, {length(1, window.thickness[i])}, [c, i](RigModel& rig, const VectorXd& d) {
            changePane(rig, c, [&](GlassWindow& w) { w.thickness[i] += d[0]; }); });
        rows.back().isOfAnotherPane = true;
        add("index" + of, c, {{"", 1., 1, WIDE}}, [c, i](RigModel& rig, const VectorXd& d) {
            changePane(rig, c, [&](GlassWindow& w) { w.index[i] += d[0]; }); });
        rows.back().isOfAnotherPane = true;
    }

    void addWedge(int c, const std::string& name)
    {
        const ChangedQuantity minutes{"arc minutes", 1./ARC_MINUTE, 2, 60.*ARC_MINUTE};
        add("wedge of the " + name + " (another pane, or the pane turned) changed by", c, {minutes},
            [c](RigModel& rig, const VectorXd& d) {
                changeWindow(rig, c, [&](GlassWindow& w) { w.wedge[0] += Vec2d(d[0], d[1]); }); });
        rows.back().isOfAnotherPane = true;
        rows.back().axes = {"1", "2"};          // as the window's file counts them
        const GlassWindow window = rig_.cameras[c]->window();
        add(name + ": another pane, wedge and thickness changed by", c, {minutes, length(1, window.thickness[0])},
            [c](RigModel& rig, const VectorXd& d) {
                changeWindow(rig, c, [&](GlassWindow& w) { w.wedge[0] += Vec2d(d[0], d[1]); w.thickness[0] += d[2]; }); });
        rows.back().isOfAnotherPane = true;
    }

    void addMedium()
    {
        const int count = count_;
        const auto isOutside = [](const RigModel& rig, int c) { return hasDifferentMedia(rig.cameras[c]->window()); };
        for (int c = 0; c < count; c++)
            if (isOutside(rig_, c))
            {
                add("index of the medium before the window (salt, temperature) changed by", -1, {{"", 1., 1, WIDE}},
                    [count, isOutside](RigModel& rig, const VectorXd& d) {
                        for (int k = 0; k < count; k++)
                            if (isOutside(rig, k))
                                changeWindow(rig, k, [&](GlassWindow& w) { w.outerIndex += d[0]; }); });
                chart("index of the medium", {""});
                return;
            }
    }

    void addLens(int c)
    {
        if (isSplined(*rig_.cameras[c]))
            return;
        const std::string of = ofCamera(c, count_);
        const double f = rig_.cameras[c]->lensParameters().at<double>(0);
        const ChangedQuantity pixels{"px", 1., 2, WIDE*f};
        add("focal length" + of + " changed by", c, {percent(WIDE)},
            [c](RigModel& rig, const VectorXd& d) { changeLens(rig, c, 1. + d[0]); });
        chart("focal length" + of, {""});
        add("principal point" + of + " (lens or sensor shifted) moved by", c, {pixels},
            [c](RigModel& rig, const VectorXd& d) { changeLens(rig, c, 1., Vec2d(d[0], d[1])); });
        chart("principal point" + of, {"x", "y"});
        add("focal length and principal point" + of + " changed by", c, {percent(WIDE), pixels},
            [c](RigModel& rig, const VectorXd& d) { changeLens(rig, c, 1. + d[0], Vec2d(d[1], d[2])); });
        for (size_t row = rows.size() - 3; row < rows.size(); row++)
            rows[row].ease = Change::UNLIKELY;
    }

    //! No chart: those of the cameras have it.
    void addAllLenses()
    {
        const auto hasNoFocus = [](const auto& camera) { return isSplined(*camera); };
        if (count_ < 2 || std::any_of(rig_.cameras.begin(), rig_.cameras.end(), hasNoFocus))
            return;
        add("focal lengths of all cameras (temperature) changed by", -1, {percent(WIDE)}, [](RigModel& rig, const VectorXd& d) {
            for (int c = 0; c < (int)rig.cameras.size(); c++)
                changeLens(rig, c, 1. + d[0]); });
        rows.back().ease = Change::UNLIKELY;
    }

    void addPlace(int c)
    {
        // Of two cameras, each moves to the other: said of the second.
        if (count_ == 1 || (count_ == 2 && c == 0))
            return;
        const std::string camera = format("camera %d", c + 1);
        const double range = WIDE*depth_;
        add(c == 0 ? "camera 1 turned about its own centre by" : format("R of camera %d (turned about its own centre) changed by", c + 1),
            c, {angle(3)}, [c](RigModel& rig, const VectorXd& d) { moveCamera(rig, c, {rotationMatrix(first3(d)), Vec3d()}); });
        rows.back().ease = Change::CAMERA_TURNS;
        chart(c == 0 ? "R of camera 1" : "R of " + camera, {"x", "y", "z"});
        add(c == 0 ? "camera 1 shifted by" : "T of " + camera + " changed by", c, {length(3, range)},
            [c](RigModel& rig, const VectorXd& d) { moveCamera(rig, c, {Matx33d::eye(), first3(d)}); });
        chart(c == 0 ? "position of camera 1" : "T of " + camera, {"x", "y", "z"});
        add(c == 0 ? "camera 1 turned and shifted by" : "R and T of " + camera + " changed by", c, {angle(3), length(3, range)},
            [c](RigModel& rig, const VectorXd& d) { moveCamera(rig, c, transformOf(first3(d), first3(d, 3))); });
        if (c == 0)
            return;
        addTurnAlone(c);
        const double baseLine = norm(rig_.extrinsics[c].t);
        if (baseLine > 0.)
            add(format("base line (length of T of camera %d) changed by", c + 1), c, {length(1, WIDE*baseLine)},
                [c, baseLine](RigModel& rig, const VectorXd& d) { rig.extrinsics[c].t *= 1. + d[0]/baseLine; });
    }

    //! Of two cameras that is a turn of the first, told in its own axes.
    void addTurnAlone(int c)
    {
        const bool isOfFirst = count_ == 2;
        add(format("R of camera %d alone (T as it was%s) changed by", c + 1, isOfFirst ? ": camera 1 turned about its own centre" : ""), c,
            {angle(3)}, [c, isOfFirst](RigModel& rig, const VectorXd& d) {
                if (isOfFirst)
                    moveCamera(rig, 0, {rotationMatrix(first3(d)), Vec3d()});
                else
                    rig.extrinsics[c].R = rotationMatrix(first3(d))*rig.extrinsics[c].R; });
        rows.back().ease = isOfFirst ? Change::FIRST_CAMERA_TURNS : Change::UNLIKELY;   // which turns about no centre
        rows.back().axes = {"x", "y", "z"};
    }

    void addTarget()
    {
        rows.push_back(changeOfSquare());
        chart("square of the board", {""});
        const Vec3d middle = middle_;
        const auto move = [middle](RigModel& rig, const Vec3d& turn, const Vec3d& shift) {
            const Matx33d R = rotationMatrix(turn);
            rig.targetMotion = RigidTransform{R, middle - R*middle + shift}*rig.targetMotion;
        };
        const std::string boards = "all boards (or the mount of the cameras) between the direct and the glass images (--placement-std) ";
        add(boards + "shifted by", -1, {length(3, WIDE*depth_)},
            [move](RigModel& rig, const VectorXd& d) { move(rig, Vec3d(), first3(d)); });
        add(boards + "shifted and turned by", -1, {length(3, WIDE*depth_), angle(3)},
            [move](RigModel& rig, const VectorXd& d) { move(rig, first3(d, 3), first3(d)); });
    }

    const RigModel& rig_;
    const std::string unit_;
    const Vec3d middle_;
    const int count_;
    const double depth_;
};

} // namespace

Change changeOfSquare()
{
    return {"square of the board (--square) other than given by", -1, {{"%", 100., 1, WIDE}},
            [](RigModel& rig, const VectorXd& d) { rig.targetScale *= 1. + d[0]; }};
}

int Change::size() const
{
    int count = 0;
    for (const ChangedQuantity& quantity : quantities)
        count += quantity.count;
    return count;
}

VectorXd Change::ranges() const
{
    VectorXd ranges(size());
    int at = 0;
    for (const ChangedQuantity& quantity : quantities)
        for (int i = 0; i < quantity.count; i++)
            ranges[at++] = quantity.range;
    return ranges;
}

std::vector<Change> changesOf(const RigModel& rig, const std::string& unit, const Vec3d& middle)
{
    return ChangeTable(rig, unit, middle).rows;
}

} // namespace tools
