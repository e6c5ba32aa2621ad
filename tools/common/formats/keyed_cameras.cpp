// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/keyed_cameras.hpp"
#include "console/failure.hpp"
#include "formats/lens_maker.hpp"

#include <algorithm>

/* Programs write the same numbers by other names. A dialect is one way to name those of a camera; a file may have a camera at its top
level, in maps and lists below it, and several beside each other whose names end in 1 and 2, or in left and right. */

namespace tools {

using cv::Matx33d;
using cv::Ptr;
using cv::Size;
using cv::Vec3d;
using cv::refract::RefractiveCamera;

namespace {

typedef std::vector<std::string> Names;

const Names MATRICES = {"camera_matrix", "Camera_Matrix", "cameraMatrix", "CameraMatrix", "cam_matrix", "K", "mtx", "M", "intrinsicMatrix",
                        "intrinsic_matrix", "matrix"};
const Names DISTORTIONS = {"distortion_coefficients", "Distortion_Coefficients", "distCoeffs", "dist_coeffs", "dist_coeff", "distCoeff",
                           "distortion_coeffs", "DistCoeffs", "dist_coefs", "dist", "D", "distortionCoeff", "distortions", "distortion"};

//! What names of cameras beside each other end in.
const Names ENDINGS[] = {{""}, {"1", "2"}, {"_1", "_2"}, {"_left", "_right"}, {"Left", "Right"}, {"L", "R"}, {"_l", "_r"}, {"_L", "_R"},
                         {"0", "1"}, {"_0", "_1"}};

//! The first of these names, with the ending, that a map has; empty: none.
std::string nameIn(const Json& map, const Names& names, const std::string& ending)
{
    for (const std::string& name : names)
        if (map.has(name + ending))
            return name + ending;
    return "";
}

std::vector<double> neededNumbers(const Json& map, const std::string& name, size_t count)
{
    const Json& value = map.at(name);
    const std::vector<double> numbers = numbersOf(value);
    if (numbers.size() == count)
        return numbers;
    const std::string has = value.isText() ? ", and is '" + value.asText() + "'"
        : numbers.empty() ? ", and what it has is none or no number (nan)" : ", and has " + std::to_string(numbers.size());
    throw Failure("its " + name + " must have " + std::to_string(count) + " numbers" + has);
}

Matx33d neededMatrix(const Json& map, const std::string& name) { return Matx33d(neededNumbers(map, name, 9).data()); }

//! 0x0 where the file does not say.
Size sizeIn(const Json& map)
{
    for (const auto& [width, height] : {std::make_pair("image_width", "image_height"), std::make_pair("width", "height"),
                                        std::make_pair("nx", "ny")})
        if (map.has(width) && map.has(height) && numbersOf(map.at(width)).size() == 1 && numbersOf(map.at(height)).size() == 1)
            return imageSizeOf(numbersOf(map.at(width))[0], numbersOf(map.at(height))[0]);
    const std::string both = nameIn(map, {"image_size", "imageSize", "resolution", "img_size", "size"}, "");
    const std::vector<double> numbers = both.empty() ? std::vector<double>() : numbersOf(map.at(both));
    return numbers.size() == 2 ? imageSizeOf(numbers[0], numbers[1]) : Size();
}

//! "opencv" or "fisheye" by what other programs call them; empty: the file does not say.
std::string lensModelIn(const Json& map)
{
    const std::string key = nameIn(map, {"distortion_model", "lens_model", "distortion_type"}, "");
    if (map.has("cameraType"))          // DepthAI
    {
        const double type = map.at("cameraType").asNumber();
        if (type != 0 && type != 1)
            throw Failure(cv::format("its cameraType %g is neither perspective (0) nor fisheye (1)", type));
        return type == 0 ? "opencv" : "fisheye";
    }
    if (key.empty())
        return "";
    const std::string model = map.at(key).asText();
    for (const char* known : {"plumb_bob", "rational_polynomial", "thin_prism", "opencv", "radtan", "brown", "none"})
        if (model == known)
            return "opencv";
    for (const char* known : {"equidistant", "fisheye", "equi", "kannala_brandt"})
        if (model == known)
            return "fisheye";
    throw Failure("its " + key + " '" + model + "' has no equal among OpenCV's");
}

//! OpenCV's own names and those of programs that took them over.
Ptr<RefractiveCamera> readOpenCV(const Json& map, const std::string& ending)
{
    const std::string distortion = nameIn(map, DISTORTIONS, ending);
    const Matx33d K = neededMatrix(map, nameIn(map, MATRICES, ending));
    if (distortion.empty())
        throw Failure("it has a camera matrix without coefficients of distortion: name them distortion_coefficients, distCoeffs, "
                      "D or dist; of a lens without distortion five zeros");
    std::vector<double> D = numbersOf(map.at(distortion));
    const std::string said = lensModelIn(map);
    const bool isBent = std::any_of(D.begin(), D.end(), [](double k) { return k != 0.; });
    if (said.empty() && D.size() == 4 && isBent)
        throw Failure("its " + distortion + " are four, and it does not say whether they are cv::fisheye's or k1, k2, p1, p2: add "
                      "distortion_model, equidistant or plumb_bob; the latter may have a fifth, 0, instead");
    if (D.empty() && numbersOf(map.at(distortion)).empty() && !(map.at(distortion).isList() && map.at(distortion).items().empty()))
        throw Failure("its " + distortion + " are not all numbers");
    return makeCamera(said.empty() ? "opencv" : said, K, D, sizeIn(map));
}

Ptr<RefractiveCamera> readKalibr(const Json& map, const std::string&)
{
    const std::string model = map.at("camera_model").asText(), distortion = map.at("distortion_model").asText();
    if (model != "pinhole" || (distortion != "radtan" && distortion != "equi" && distortion != "none"))
        throw Failure("its lens " + model + "-" + distortion + " has no equal among OpenCV's: calibrate with pinhole-radtan or "
                      "pinhole-equi");
    const std::vector<double> p = neededNumbers(map, "intrinsics", 4);
    const std::vector<double> D = distortion == "none" ? std::vector<double>() : neededNumbers(map, "distortion_coeffs", 4);
    return makeCamera(distortion == "equi" ? "fisheye" : "opencv", cameraMatrixOf(p[0], p[1], p[2], p[3]), D, sizeIn(map));
}

Ptr<RefractiveCamera> readCalibmar(const Json& map, const std::string&)
{
    const Ptr<RefractiveCamera> camera = makeColmapCamera(map.at("model").asText(), numbersOf(map.at("parameters")), sizeIn(map));
    if (map.has("non_svp_model") && map.at("non_svp_model").asText() != "NONE")
        camera->setWindow(makePort(map.at("non_svp_model").asText(), numbersOf(map.at("non_svp_parameters"))));
    if (map.has("non_svp_camera"))
        camera->setWindow(makePort(map.at("non_svp_camera").at("type").asText(), numbersOf(map.at("non_svp_camera").at("parameters"))));
    return camera;
}

//! The toolbox of Bouguet, whose pixels count from 0.
Ptr<RefractiveCamera> readBouguet(const Json& map, const std::string& ending)
{
    const std::vector<double> f = neededNumbers(map, "fc" + ending, 2), c = neededNumbers(map, "cc" + ending, 2);
    Matx33d K = cameraMatrixOf(f[0], f[1], c[0], c[1]);
    if (map.has("alpha_c" + ending))
        K(0, 1) = f[0]*neededNumbers(map, "alpha_c" + ending, 1)[0];
    return makeCamera("opencv", K, neededNumbers(map, "kc" + ending, 5), sizeIn(map));
}

//! MATLAB's toolbox, as a struct; its pixels count from 1, its older matrices are meant for rows.
Ptr<RefractiveCamera> readMatlab(const Json& map, const std::string&)
{
    Matx33d K = Matx33d::eye();
    if (map.has("MappingCoefficients"))
        throw Failure("MATLAB's fisheye model has no equal among OpenCV's");
    if (map.has("IntrinsicMatrix"))
        K = neededMatrix(map, "IntrinsicMatrix").t();
    else if (map.has("K"))
        K = neededMatrix(map, "K");
    else
    {
        const std::vector<double> f = neededNumbers(map, "FocalLength", 2), c = neededNumbers(map, "PrincipalPoint", 2);
        K = cameraMatrixOf(f[0], f[1], c[0], c[1]);
        K(0, 1) = map.has("Skew") ? neededNumbers(map, "Skew", 1)[0] : 0.;
    }
    K(0, 2) -= 1.;
    K(1, 2) -= 1.;
    std::vector<double> D = numbersOf(map.at("RadialDistortion"));
    const std::vector<double> p = map.has("TangentialDistortion") ? neededNumbers(map, "TangentialDistortion", 2) : std::vector<double>(2);
    if (D.size() != 2 && D.size() != 3)
        throw Failure("its RadialDistortion must have 2 or 3 numbers");
    D.insert(D.begin() + 2, p.begin(), p.end());
    const std::vector<double> rowsColumns = map.has("ImageSize") ? numbersOf(map.at("ImageSize")) : std::vector<double>();
    const bool known = rowsColumns.size() == 2;
    return makeCamera("opencv", K, D, known ? imageSizeOf(rowsColumns[1], rowsColumns[0]) : Size());
}

//! How a program names the numbers of a camera.
struct Dialect
{
    const char* format;
    Names telling;              //!< a camera of it has all of these
    Ptr<RefractiveCamera> (*read)(const Json& map, const std::string& ending);
};

const Dialect DIALECTS[] = {
    {"Kalibr's camchain", {"camera_model", "intrinsics"}, readKalibr},
    {"Calibmar's calibration", {"model", "parameters"}, readCalibmar},
    {"Bouguet's Calib_Results", {"fc", "cc"}, readBouguet},
    {"MATLAB's cameraParameters", {"RadialDistortion"}, readMatlab},
    {"MATLAB's fisheyeParameters", {"MappingCoefficients"}, readMatlab},
    {"ROS's camera_info", {"camera_matrix", "distortion_model"}, readOpenCV},
    {"DepthAI's calibration", {"intrinsicMatrix", "distortionCoeff"}, readOpenCV}};

bool tells(const Dialect& dialect, const Json& map, const std::string& ending)
{
    return std::all_of(dialect.telling.begin(), dialect.telling.end(), [&](const std::string& name) { return map.has(name + ending); });
}

//! A camera whose names end so; null if there is none.
Ptr<RefractiveCamera> cameraIn(const Json& map, const std::string& ending, std::string& format)
{
    for (const Dialect& dialect : DIALECTS)
        if (tells(dialect, map, ending))
        {
            format = dialect.format;
            return dialect.read(map, ending);
        }
    const std::string matrix = nameIn(map, MATRICES, ending);
    const size_t numbers = matrix.empty() ? 0 : numbersOf(map.at(matrix)).size();
    if (matrix.empty() || (numbers != 9 && nameIn(map, DISTORTIONS, ending).empty()))
        return nullptr;
    format = "a file of OpenCV's camera matrix and coefficients";
    return readOpenCV(map, ending);
}

typedef std::vector<std::pair<Ptr<RefractiveCamera>, const Json*>> Found;

//! Adds the cameras of this value and of those below it.
void collect(const Json& json, int depth, Found& found, std::string& format)
{
    const int DEEPEST = 5;
    if (depth > DEEPEST || (!json.isObject() && !json.isList()))
        return;
    const size_t before = found.size();
    for (const Names& endings : ENDINGS)
    {
        for (const std::string& ending : endings)
            if (const Ptr<RefractiveCamera> camera = cameraIn(json, ending, format))
                found.push_back({camera, &json});
            else
                break;
        if (found.size() > before)
            return;
    }
    if (json.isList())
        for (const Json& item : json.items())
            collect(item, depth + 1, found, format);
    for (const std::string& name : json.names())
        collect(json.at(name), depth + 1, found, format);
}

//! Names of a rotation and a translation, and whether they are meant for rows.
struct PlaceNames
{
    const char *R, *T;
    bool forRows;
};
const PlaceNames PLACES[] = {{"R", "T", false}, {"R", "t", false}, {"rotation_matrix", "translation_vector", false},
                             {"Rot", "Trans", false}, {"RotationOfCamera2", "TranslationOfCamera2", true}};

//! What this map itself says.
bool placeIn(const Json& json, Matx33d& R, Vec3d& T)
{
    for (const PlaceNames& names : PLACES)
        if (json.has(names.R) && json.has(names.T))
        {
            R = neededMatrix(json, names.R);
            T = Vec3d(neededNumbers(json, names.T, 3).data());
            R = names.forRows ? R.t() : R;
            return true;
        }
    return false;
}

//! The place of the second camera from the first, anywhere in the file but with the first.
bool findPlace(const Json& json, const Json* first, int depth, Matx33d& R, Vec3d& T)
{
    const int DEEPEST = 3;
    if (depth > DEEPEST || &json == first)
        return false;
    if (placeIn(json, R, T))
        return true;
    for (const std::string& name : json.names())
        if (findPlace(json.at(name), first, depth + 1, R, T))
            return true;
    return false;
}

//! Each camera from one frame, in its own map.
bool findPlaces(const Found& found, ForeignRig& rig)
{
    for (size_t c = 0; c < found.size(); c++)
    {
        Matx33d R;
        Vec3d T;
        if ((c > 0 && found[c].second == found[0].second) || !placeIn(*found[c].second, R, T))
            return false;
        rig.add(found[c].first, R, T);
    }
    return true;
}

//! Kalibr: each camera from the one before it.
bool findChain(const Found& found, ForeignRig& rig)
{
    Matx33d R = Matx33d::eye();
    Vec3d T;
    for (size_t c = 0; c < found.size(); c++)
    {
        if (c > 0 && !found[c].second->has("T_cn_cnm1"))
            return false;
        if (c > 0)
        {
            const cv::Matx44d step(neededNumbers(*found[c].second, "T_cn_cnm1", 16).data());
            R = step.get_minor<3, 3>(0, 0)*R;
            T = step.get_minor<3, 3>(0, 0)*T + Vec3d(step(0, 3), step(1, 3), step(2, 3));
        }
        rig.add(found[c].first, R, T);
    }
    return true;
}

void addNumbers(const Json& json, std::vector<double>& numbers)
{
    if (json.isNumber())
        numbers.push_back(json.asNumber());
    else
        for (const Json& item : json.items())
            addNumbers(item, numbers);
}

} // namespace

std::vector<double> numbersOf(const Json& json)
{
    std::vector<double> numbers;
    try
    {
        addNumbers(json.has("data") ? json.at("data") : json, numbers);
    }
    catch (const Json::Error&)
    {
        numbers.clear();
    }
    return numbers;
}

ForeignRig readKeyedCameras(const Json& file, std::string& format)
{
    Found found;
    collect(file, 0, found, format);
    ForeignRig rig;
    rig.format = format;
    Matx33d R;
    Vec3d T;
    if (found.size() > 1 && findPlaces(found, rig))
        return rig;
    rig = ForeignRig();
    rig.format = format;
    if (found.size() == 2 && findPlace(file, found[0].second == found[1].second ? nullptr : found[0].second, 0, R, T))
    {
        rig.add(found[0].first, Matx33d::eye(), Vec3d());
        rig.add(found[1].first, R, T);
    }
    else if (found.size() == 1 || !findChain(found, rig))
    {
        rig = ForeignRig();
        rig.format = format;
        for (const auto& camera : found)
            rig.add(camera.first);
    }
    return rig;
}

} // namespace tools
