#include "rig_calibration.hpp"
#include "table.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>
#include <set>

using namespace cv;
using namespace cv::refract;

namespace tools {

static void append(std::vector<FreeParameter>& list, const Fit& fit, const std::string& name, int column, double value,
            bool isNormal = false)
{
    const double std = fit.stdDeviations.at<double>(column);
    if (std > 0)
        list.push_back({name, column, value, std, isNormal});
}

Rms rmsOf(const RigCalibration& calibration, int camera, bool glass, int moment)
{
    Rms rms;
    double sum = 0.;
    std::set<int> views;
    for (const Residual& r : calibration.residuals)
        if (r.camera == camera && r.glass == glass && (moment < 0 || r.moment == moment))
        {
            sum += r.error.dot(r.error);
            rms.points++;
            views.insert(r.moment);
        }
    rms.views = (int)views.size();
    if (rms.points)
        rms.px = std::sqrt(sum / rms.points);
    return rms;
}

Rms rmsOfCamera(const RigCalibration& calibration, int camera)
{
    const Rms glass = rmsOf(calibration, camera, true), direct = rmsOf(calibration, camera, false);
    Rms both;
    both.points = glass.points + direct.points;
    both.views = glass.views + direct.views;
    double sum = 0.;
    for (const Rms& part : {glass, direct})
        if (part.points)
            sum += part.px * part.px * part.points;
    if (both.points)
        both.px = std::sqrt(sum / both.points);
    return both;
}

std::vector<FreeParameter> freeWindowParameters(const Fit& fit, int flags)
{
    std::vector<FreeParameter> list;
    const bool shared = flags & GLASS_SHARED_WINDOW;
    for (int c = 0; c < (shared ? 1 : (int)fit.rig.cameras.size()); c++)
    {
        const std::string prefix = fit.rig.cameras.size() == 1 ? "" : format("camera %d ", c + 1);
        const GlassWindow window = fit.rig.cameras[c]->window();
        const ParameterColumns at = columnsOf(fit.rig, c);
        append(list, fit, prefix + "normal x", at.normal, window.normal[0], true);
        append(list, fit, prefix + "normal y", at.normal + 1, window.normal[1], true);
        append(list, fit, prefix + "distance", at.distance, window.distance);
        for (int i = 0; i < at.layers; i++)
        {
            const std::string layer = at.layers == 1 ? "" : format(" %d", i + 1);
            append(list, fit, prefix + "thickness" + layer, at.thickness + i, window.thickness[i]);
            append(list, fit, prefix + "index" + layer, at.index + i, window.index[i]);
        }
        append(list, fit, prefix + "outer index", at.outerIndex, window.outerIndex);
    }
    return list;
}

std::vector<FreeParameter> freeRigParameters(const Fit& fit)
{
    static const char* const LENS[] = {"fx", "fy", "cx", "cy"};
    std::vector<FreeParameter> list;
    int end = 0;
    for (int c = 0; c < (int)fit.rig.cameras.size(); c++)
    {
        const std::string prefix = fit.rig.cameras.size() == 1 ? "" : format("camera %d ", c + 1);
        const Mat lens = fit.rig.cameras[c]->lensParameters();
        const ParameterColumns at = columnsOf(fit.rig, c);
        for (int i = 0; i < at.lensCount; i++)
            append(list, fit, prefix + (i < 4 ? std::string(LENS[i]) : format("lens coefficient %d", i - 3)), at.lens + i,
                   lens.at<double>(i));
        end = at.end;
    }
    if (fit.rig.cameras.size() == 2)
    {
        Vec3d rvec;
        Rodrigues(fit.rig.R, rvec);
        for (int i = 0; i < 3; i++)
            append(list, fit, std::string("R rotation vector ") + "xyz"[i], end + i, rvec[i]);
        for (int i = 0; i < 3; i++)
            append(list, fit, std::string("T ") + "xyz"[i], end + 3 + i, fit.rig.T[i]);
    }
    return list;
}

double coverage(const RigCalibration& calibration, int camera)
{
    const int COLUMNS = 8, ROWS = 6;
    const Size size = calibration.data.imageSize[camera];
    std::set<int> cells;
    for (const Residual& r : calibration.residuals)
        if (r.camera == camera && r.glass)
            cells.insert((int)(r.pixel.y * ROWS / size.height) * COLUMNS + (int)(r.pixel.x * COLUMNS / size.width));
    return (double)cells.size() / (COLUMNS * ROWS);
}

Vec3d workingDepth(const RigCalibration& calibration, int camera)
{
    std::vector<double> depths;
    const Fit& fit = calibration.fit;
    for (size_t k = 0; k < fit.moments.size(); k++)
    {
        if (!calibration.data.moments[fit.moments[k]].hasGlass(camera))
            continue;
        Vec3d rvec, tvec;
        poseInCamera(fit, k, camera, rvec, tvec);
        Matx33d R;
        Rodrigues(rvec, R);
        for (const Point3d& X : calibration.data.objectPoints)
            depths.push_back((R * Vec3d(X) + tvec)[2]);
    }
    std::sort(depths.begin(), depths.end());
    return depths.empty() ? Vec3d(NONE, NONE, NONE) : Vec3d(depths.front(), depths[depths.size() / 2], depths.back());
}

} // namespace tools
