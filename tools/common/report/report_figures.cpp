// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/report_figures.hpp"
#include "console/progress.hpp"
#include "report/figures.hpp"

using namespace cv;

namespace tools {

static PageValues figure(const Figure& picture, const std::string& title, const std::string& reading)
{
    PageValues entry;
    entry.set("title", title);
    entry.set("svg", picture.svg);
    entry.set("reading", reading + (picture.note.empty() ? "" : " (" + picture.note + ")") + ".");
    return entry;
}

PageList figuresOf(const RigCalibration& c, int camera, Progress& progress)
{
    PageList list;
    auto add = [&](const Figure& picture, const char* title, const char* reading) {
        list.push_back(figure(picture, title, reading));
        progress.step();
    };
    add(drawSideView(c, camera, 0), "Seen from above",
        "To scale: the camera at the left, its rays bending at the window, the boards where they were seen");
    add(drawSideView(c, camera, 1), "Seen from the side",
        "The same with y pointing down; a window that is not where you mounted it shows here");
    add(drawCoverage(c, camera), "Where the board was seen",
        "Empty parts of the image are extrapolated: what is measured there is less certain");
    add(drawViewRms(c, camera), "Residual of each view",
        "All bars should be about equally high; one that stands out has wrong corners or a board that moved");
    if (!c.influences.empty())
        add(drawInfluence(c, camera), "Which view pulls",
            "How far the window turns or moves if a view is left out; a bar far above the line means that the result hangs on that view");
    add(drawResidualMap(c, camera), "Mean residual over the image",
        "Noise averages out, so most cells should be blue or green; red cells next to each other, where residuals all point the "
        "same way, are a systematic error. Cells with few corners are left white");
    return list;
}

PageValues errorOverRange(const RigCalibration& c, const Assessment& a, Progress& progress)
{
    progress.step();
    return figure(drawErrorOverRange(c, a), "Expected error over the range", "How far a measured point lies from the truth (one "
                  "standard deviation, 3-D). Where the red line leaves the dashed one, a better calibration would help; "
                  "where they meet, only a better image would");
}

void addErrorMaps(PageList& list, const RigCalibration& c, const Assessment& a, Progress& progress)
{
    const Vec2d scale = commonScale(a.errors);
    for (const ErrorMap& map : a.errors)
    {
        if (map.seen())
            list.push_back(figure(drawErrorMap(c, map, scale), format("Expected error at z = %.4g %s", map.range, c.unit.c_str()),
                                  c.data.cameraCount > 1 ? std::string("Over the image of camera 1; white parts are not seen by ")
                                                           + (c.data.cameraCount == 2 ? "both cameras" : "any other camera")
                                                           + ". The colours of all ranges are those of one scale"
                                                         : "Over the image, for points on a plane square to the camera. The colours of "
                                                           "all ranges are those of one scale"));
        progress.step();
    }
}

PageList rigFigures(const RigCalibration& c, Progress& progress)
{
    const char* reading = "To scale, obliquely from above: the cameras with their numbers, the part of each window that they look "
                          "through, their middle rays bending at it, and the points that were seen; a camera that is not where you "
                          "mounted it shows here";
    PageList list;
    list.push_back(figure(drawRig(c, 35.), "The rig from behind", reading));
    progress.step();
    list.push_back(figure(drawRig(c, -60.), "The rig from the other side", reading));
    progress.step();
    return list;
}

} // namespace tools
