// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "precomp.hpp"
#include "window/parameters.hpp"

namespace cv { namespace refract {

GlassWindow::GlassWindow()
    : shape(WINDOW_FLAT), normal(0, 0, 1), distance(0), center(0, 0, 0), axis(0, 0, 0), radius(0), curvature(0), innerIndex(1),
      outerIndex(1), wavelength(0) {}

//! The unit normal, after a check of everything.
static Vec3d checkedNormal(const Vec3d& normal, double thickness, double index, double distance, double outerIndex)
{
    const double length = cv::norm(normal);
    if (!(length > 0) || !std::isfinite(length))
        CV_Error_(Error::StsBadArg, ("normal is (%g, %g, %g); it must be finite and not zero",
                                     normal[0], normal[1], normal[2]));
    GlassWindow window;
    window.normal = normal/length;
    window.thickness.assign(1, thickness);
    window.index.assign(1, index);
    window.distance = distance;
    window.outerIndex = outerIndex;
    window.check();
    return window.normal;
}

// What is wrong is found before any member is made: OpenCV's bindings destroy an object whose constructor threw once more.
// A window that a function returns would not do: it may be made, and destroyed, in this one's place.
GlassWindow::GlassWindow(const Vec3d& normal_, double thickness_, double index_, double distance_, double outerIndex_)
    : shape(WINDOW_FLAT), normal(checkedNormal(normal_, thickness_, index_, distance_, outerIndex_)), distance(distance_),
      center(0, 0, 0), axis(0, 0, 0), radius(0), curvature(0), thickness(1, thickness_), index(1, index_), innerIndex(1),
      outerIndex(outerIndex_), wavelength(0) {}

GlassWindow GlassWindow::dome(const Vec3d& center, double radius, double thickness, double index, double outerIndex)
{
    GlassWindow window;
    window.shape = WINDOW_DOME;
    window.center = center;
    window.radius = radius;
    window.thickness.assign(1, thickness);
    window.index.assign(1, index);
    window.outerIndex = outerIndex;
    window.check();
    return window;
}

GlassWindow GlassWindow::tube(const Vec3d& axisPoint, const Vec3d& axisDirection, double radius, double thickness, double index,
                              double outerIndex)
{
    const double length = cv::norm(axisDirection);
    if (!(length > 0) || !std::isfinite(length))
        CV_Error_(Error::StsBadArg, ("axisDirection is (%g, %g, %g); it must be finite and not zero", axisDirection[0],
                                     axisDirection[1], axisDirection[2]));
    GlassWindow window;
    window.shape = WINDOW_TUBE;
    window.axis = axisDirection/length;
    window.center = axisPoint - axisPoint.dot(window.axis)*window.axis;
    window.radius = radius;
    window.thickness.assign(1, thickness);
    window.index.assign(1, index);
    window.outerIndex = outerIndex;
    window.check();
    return window;
}

GlassWindow GlassWindow::atWavelength(double wavelengthNm) const
{
    check();
    if (!(wavelengthNm > 0 && wavelengthNm <= MAX_LENGTH))
        CV_Error_(Error::StsOutOfRange, ("wavelengthNm is %g; it must be finite and more than 0", wavelengthNm));
    const bool refracts = !index.empty() || innerIndex != outerIndex;
    if (refracts && materials.empty())
        CV_Error(Error::StsBadArg, "window.materials is empty: nothing says how the indices change with the wavelength");
    GlassWindow window = *this;
    window.wavelength = wavelengthNm;
    for (size_t i = 0; i < materials.size(); i++)
    {
        if (materials[i].empty())
            continue;
        double& n = i == 0 ? window.innerIndex : i <= index.size() ? window.index[i - 1] : window.outerIndex;
        const double there = refractiveIndex(materials[i], wavelengthNm);
        n = wavelength > 0 ? n*(there/refractiveIndex(materials[i], wavelength)) : there;
    }
    window.check();
    return window;
}

}} // namespace
