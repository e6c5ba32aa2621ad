// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_WINDOW_FACE_HPP
#define REFRACT_TOOLS_WINDOW_FACE_HPP

#include <opencv2/refract.hpp>
#include <string>

namespace tools {

//! Where rays meet the first or the last face of a window of any shape: to draw it, and to see whether something is beyond it.
class WindowFace
{
public:
    static WindowFace first(const cv::refract::GlassWindow& window);
    static WindowFace last(const cv::refract::GlassWindow& window);

    //! How far along a unit vector the line leaves the camera's side; -inf: there is no window, NaN: it does not meet the face.
    double along(const cv::Vec3d& origin, const cv::Vec3d& direction) const;
    cv::Vec3d meets(const cv::Vec3d& origin, const cv::Vec3d& direction) const { return origin + along(origin, direction)*direction; }
    //! On the camera's side.
    bool isBefore(const cv::Vec3d& point) const { return beyond(point) < 0.; }

private:
    WindowFace(const cv::refract::GlassWindow& window, double glass, cv::Vec2d lean);
    //! The face is where this is 0; beyond it is more.
    double beyond(const cv::Vec3d& point) const;

    cv::Vec3d normal_, point_;          //!< flat, bent: n (X - P) + k/2 |X - P|^2 = 0
    cv::Vec3d axis_;                    //!< a tube's; 0: none
    double curvature_ = 0., radius_ = 0.;       //!< radius 0: flat or bent; else |X - P| = r, across the axis
    bool isNone_ = false;
};

//! From the first face to the last.
double glassOf(const cv::refract::GlassWindow& window);

//! "window", "dome", "tube", "bent window"
const char* nameOfShape(const cv::refract::GlassWindow& window);

//! On its two sides.
inline bool hasDifferentMedia(const cv::refract::GlassWindow& window) { return window.innerIndex != window.outerIndex; }

//! There is something that bends rays: a pane, or the surface between two media.
inline bool refracts(const cv::refract::GlassWindow& window) { return !window.thickness.empty() || hasDifferentMedia(window); }

//! It has a centre and a radius.
inline bool isRound(const cv::refract::GlassWindow& window)
{
    return window.shape == cv::refract::WINDOW_DOME || window.shape == cv::refract::WINDOW_TUBE;
}

//! Of a flat window against the optical axis.
double tiltDegrees(const cv::refract::GlassWindow& window);

/** How far the centre of projection is from a dome's centre, or from a tube's axis. There it is in the middle, and rays are hardly
refracted, in a dome not at all. */
double offsetOf(const cv::refract::GlassWindow& window);

/** How far one window is from another of its shape: the angle between their normals in degrees, or the distance between their centres
(of a tube across its axis). */
double placeChange(const cv::refract::GlassWindow& before, const cv::refract::GlassWindow& after);
//! Its unit: "deg", or that of lengths.
std::string placeUnit(const cv::refract::GlassWindow& window, const std::string& unit);
//! What it is of: "normal" or "centre".
const char* placeName(const cv::refract::GlassWindow& window);

} // namespace tools

#endif // REFRACT_TOOLS_WINDOW_FACE_HPP
