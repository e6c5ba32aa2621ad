// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens/lens.hpp"
#include <cstring>
#include <locale>
#include <sstream>

/* mrcal's lens models by name. PINHOLE and OPENCV4, 5, 8, 12 are OpenCV's model with that many coefficients. The intrinsics
are fx, fy, cx, cy and the coefficients; a name may go on with what is no parameter, _key=value. */

namespace cv { namespace refract {

namespace {

struct MrcalModel
{
    const char* name;
    size_t coefficients;
    std::vector<const char*> keys;
};

const std::vector<MrcalModel>& mrcalModels()
{
    static const std::vector<MrcalModel> models = {
        { "LENSMODEL_PINHOLE", 0, {} }, { "LENSMODEL_OPENCV4", 4, {} }, { "LENSMODEL_OPENCV5", 5, {} },
        { "LENSMODEL_OPENCV8", 8, {} }, { "LENSMODEL_OPENCV12", 12, {} }, { "LENSMODEL_STEREOGRAPHIC", 0, {} },
        { "LENSMODEL_LONLAT", 0, {} }, { "LENSMODEL_LATLON", 0, {} }, { "LENSMODEL_CAHVOR", 5, {} },
        { "LENSMODEL_CAHVORE", 8, { "linearity" } },
        { "LENSMODEL_SPLINED_STEREOGRAPHIC", 0, { "order", "Nx", "Ny", "fov_x_deg" } } };
    return models;
}

//! The values in model's name, in the order of keys.
std::vector<double> valuesInName(const String& model, const MrcalModel& of)
{
    std::istringstream rest(model.substr(std::strlen(of.name)));
    rest.imbue(std::locale::classic());
    std::vector<double> values;
    String pattern = of.name;
    for (const char* key : of.keys)
    {
        std::string text;
        double value = NAN;
        if (std::getline(rest, text, '=') && text == String("_") + key && rest >> value)
            values.push_back(value);
        pattern += String("_") + key + "=...";
    }
    if (values.size() != of.keys.size() || rest.peek() != std::char_traits<char>::eof())
        CV_Error_(Error::StsBadArg, ("lensModel is %s; its name must be %s", model.c_str(), pattern.c_str()));
    return values;
}

SplineGrid gridOf(const String& model, const std::vector<double>& values)
{
    const int MOST = 65535;
    for (double value : values)
        if (value != std::floor(value) || !(value >= 1 && value <= MOST))
            CV_Error_(Error::StsBadArg, ("lensModel is %s; %g is no whole number from 1 to %d", model.c_str(), value, MOST));
    const SplineGrid grid = { (int)values[0], (int)values[1], (int)values[2], values[3] };
    if ((grid.order != 2 && grid.order != 3) || grid.nx <= grid.order || grid.ny <= grid.order || grid.fovX >= 360)
        CV_Error_(Error::StsBadArg, ("lensModel is %s; its order must be 2 or 3, Nx and Ny above it, fov_x_deg below 360",
                                     model.c_str()));
    return grid;
}

void checkIntrinsics(const String& model, const std::vector<double>& intrinsics, size_t expected)
{
    if (intrinsics.size() != expected)
        CV_Error_(Error::StsBadArg, ("intrinsics has %d values; %s has %d", (int)intrinsics.size(), model.c_str(), (int)expected));
    for (size_t i = 0; i < intrinsics.size(); i++)
        if (!std::isfinite(intrinsics[i]) || (i < 2 && !(intrinsics[i] > 0)))
            CV_Error_(Error::StsBadArg, ("intrinsics[%d] is %g; focal lengths must be positive, all finite",
                                         (int)i, intrinsics[i]));
}

//! The model that a name is of: all of it, or what stands before _key=value.
const MrcalModel& modelOf(const String& name)
{
    String known;
    for (const MrcalModel& m : mrcalModels())
    {
        const String start = m.keys.empty() ? m.name : m.name + String("_") + m.keys[0] + "=";
        if (m.keys.empty() ? name == start : name.compare(0, start.size(), start) == 0)
            return m;
        known += (known.empty() ? "" : ", ") + start + (m.keys.empty() ? "" : "...");
    }
    CV_Error_(Error::StsBadArg, ("lensModel is %s; known are %s", name.c_str(), known.c_str()));
}

} // namespace

Ptr<Lens> makeMrcalLens(const String& name, const std::vector<double>& intrinsics)
{
    const MrcalModel& model = modelOf(name);
    const std::vector<double> values = valuesInName(name, model);
    if (values.size() == 4)
    {
        const SplineGrid grid = gridOf(name, values);
        checkIntrinsics(name, intrinsics, 4 + 2*(size_t)grid.nx*grid.ny);
        return makeSplinedLens(name, intrinsics, grid);
    }
    checkIntrinsics(name, intrinsics, 4 + model.coefficients);
    if (String(model.name).find("CAHVOR") != String::npos)
        return makeCahvorLens(name, intrinsics, values.empty() ? 1 : values[0]);
    if (String(model.name).find("OPENCV") == String::npos && name != "LENSMODEL_PINHOLE")
        return makePanoramicLens(name, intrinsics);
    const double* p = intrinsics.data();
    return makeOpenCVLens(Matx33d(p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1),
                          std::vector<double>(intrinsics.begin() + 4, intrinsics.end()), name);
}

}} // namespace
