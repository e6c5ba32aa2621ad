#include "calibrate/image_fit.hpp"
#include "console/table.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

static void append(std::vector<EstimatedParameter>& list, const Fit& fit, const std::string& name, int column, double value,
                   bool isNormal = false)
{
    const double std = fit.stdDeviations.at<double>(column);
    if (std > 0)
        list.push_back({name, column, value, std, isNormal});
}

ParameterColumns columnsOf(const RefractiveCamera& camera, int first)
{
    ParameterColumns columns;
    columns.names = camera.parameterNames();
    columns.lensCount = camera.lensParameters().rows;
    columns.layers = (int)camera.window().thickness.size();
    const auto find = [&](const char* name)
    { return first + int(std::find(columns.names.begin(), columns.names.end(), name) - columns.names.begin()); };
    columns.lens = first;
    columns.normal = find("normal[0]");
    columns.distance = find("distance");
    columns.thickness = find("thickness[0]");
    columns.index = find("index[0]");
    columns.innerIndex = find("innerIndex");
    columns.outerIndex = find("outerIndex");
    columns.end = first + (int)columns.names.size();
    return columns;
}

ParameterColumns columnsOf(const RigModel& rig, int camera)
{
    int first = 0;
    for (int c = 0; c < camera; c++)
        first = columnsOf(*rig.cameras[c], first).end;
    return columnsOf(*rig.cameras[camera], first);
}

std::vector<double> normalStdDeg(const Mat& covariance, const RigModel& rig, int camera)
{
    const int at = columnsOf(rig, camera).normal;
    // Rank 2: the third eigenvalue, along the normal itself, is zero.
    Mat eigenvalues;
    eigen(covariance(Rect(at, at, 3, 3)), eigenvalues);
    std::vector<double> result;
    for (int i = 0; i < 2; i++)
        result.push_back(std::sqrt(std::max(0., eigenvalues.at<double>(i))) * 180. / CV_PI);
    return result;
}

WindowStd windowStd(const Fit& fit, int camera)
{
    const ParameterColumns at = columnsOf(fit.rig, camera);
    auto std = [&fit](int column) { return fit.stdDeviations.at<double>(column); };
    WindowStd result;
    result.normalDeg = normalStdDeg(fit.covariance, fit.rig, camera);
    result.distance = std(at.distance);
    for (int i = 0; i < at.layers; i++)
    {
        result.thickness.push_back(std(at.thickness + i));
        result.index.push_back(std(at.index + i));
    }
    result.outerIndex = std(at.outerIndex);
    return result;
}

Calibration calibrationOf(const RigModel& rig)
{
    Calibration calibration;
    for (const Ptr<RefractiveCamera>& camera : rig.cameras)
        calibration.cameras.push_back({camera, WindowStd(), -1.});
    calibration.R = rig.R;
    calibration.T = rig.T;
    return calibration;
}

std::vector<EstimatedParameter> estimatedWindowParameters(const Fit& fit, int flags)
{
    std::vector<EstimatedParameter> list;
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

std::vector<EstimatedParameter> estimatedRigParameters(const Fit& fit)
{
    std::vector<EstimatedParameter> list;
    int end = 0;
    for (int c = 0; c < (int)fit.rig.cameras.size(); c++)
    {
        const std::string prefix = fit.rig.cameras.size() == 1 ? "" : format("camera %d ", c + 1);
        const Mat lens = fit.rig.cameras[c]->lensParameters();
        const ParameterColumns at = columnsOf(fit.rig, c);
        for (int i = 0; i < at.lensCount; i++)
            append(list, fit, prefix + at.names[i], at.lens + i, lens.at<double>(i));
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

} // namespace tools
