// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/collected_findings.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include <algorithm>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

bool isLensFree(const RigCalibration& c, int camera)
{
    const ParameterColumns at = columnsOf(c.fit.rig, camera);
    return c.fit.stdDeviations.at<double>(at.lens) > 0.;
}

//! What a tape measure can tell.
std::string scaleInWords(const RigCalibration& c)
{
    double width = 0.;
    for (int i : c.fit.views)
    {
        const std::vector<Point3d>& points = c.data.views[i].objectPoints;
        for (const Point3d& X : points)
            width = std::max(width, norm(X - points[0]));
    }
    const Vec3d depth = workingDepth(c, 0);
    std::string text = format("the target is %.3g %s across, %.3g to %.3g %s from camera 1", width, c.unit.c_str(), depth[0], depth[2],
                              c.unit.c_str());
    if (c.data.cameraCount > 1)
        text += format(", which is %.3g %s from camera 2", norm(c.fit.rig.extrinsics[1].T), c.unit.c_str());
    return text;
}

std::string listOf(const std::vector<double>& values)
{
    std::string text;
    for (double value : values)
        text += (text.empty() ? "" : ", ") + format("%.6g", value);
    return text;
}

std::string shapeAssumed(const GlassWindow& window)
{
    switch (window.shape)
    {
    case WINDOW_DOME: return ", a dome of spheres about one centre";
    case WINDOW_TUBE: return ", a tube of cylinders about one axis";
    case WINDOW_BENT: return ", a window bent like a sphere";
    default: return window.wedge.empty() ? ", a flat window with parallel surfaces" : ", a flat window";
    }
}

} // namespace

void checkAssumptions(const RigCalibration& c, Findings& f)
{
    for (int k = 0; k < c.data.cameraCount; k++)
        if (c.lensSources[k].kind == LensSource::FROM_FILE && !isLensFree(c, k))
            f.assumed.push_back(prefixOf(c, k) + "the lens of the file, taken as exact, as the file states no covariance");
    if (c.options.std.scale == 0.)
        f.assumed.push_back((c.square > 0 ? format("the square of %g", c.square) : std::string("the coordinates of the points in"))
                            + " " + c.unit + ": all lengths are in proportion to it, and no image shows it. A tape measure does: "
                            + scaleInWords(c));
    if (c.options.flags & GLASS_USE_POSES)
        f.assumed.push_back("the poses of the target, within their given standard deviations");
    const GlassWindow& window = c.options.window;
    if (!window.thickness.empty() && !(c.options.flags & GLASS_FREE_THICKNESS) && c.options.std.thickness == 0.)
        f.assumed.push_back("the thickness, " + listOf(window.thickness) + " " + c.unit
                            + (hasDifferentMedia(window) ? " (an error in it is largely taken up by the distance, as the media on its two "
                               "sides differ)" : ""));
    if (!window.index.empty() && !(c.options.flags & GLASS_FREE_INDEX) && !c.options.std.ofIndices())
        f.assumed.push_back("the index, " + listOf(window.index));
    std::vector<GivenIndex> indices = c.options.layers;
    indices.insert(indices.end(), {c.options.inner, c.options.outer});
    for (const GivenIndex& index : indices)
        if (index.isNamed() && std::find(f.assumed.begin(), f.assumed.end(), index.sentence()) == f.assumed.end())
            f.assumed.push_back(index.sentence());
    if (isRound(window) && !(c.options.flags & GLASS_FREE_RADIUS) && c.options.std.radius == 0.)
        f.assumed.push_back("the radius, " + listOf({window.radius}) + " " + c.unit);
    if (hasDifferentMedia(window) && !isRound(window) && !(c.options.flags & GLASS_FREE_DISTANCE) && c.options.std.distance == 0.
        && !c.options.areMarkersGiven())
        f.assumed.push_back("the distance, " + listOf({window.distance}) + " " + c.unit);
    for (int k = 0; k < c.data.cameraCount; k++)
        if (c.data.countPairs(k) && c.options.std.placement == 0.)
            f.assumed.push_back(prefixOf(c, k) + "that neither board nor camera moved between the two images of a pair, also not "
                                "all the same way, which no residual shows");
    if (!c.outliers.fault.empty())
        f.assumed.push_back("that no point is wrong: they could not be looked for, as " + c.outliers.fault);
    f.assumed.push_back(std::string(c.square > 0 ? "a flat board with even spacing" : "a rigid target that is as its coordinates say")
                        + shapeAssumed(c.fit.rig.cameras[0]->window())
                        + ", and independent corner noise");
}

} // namespace tools
