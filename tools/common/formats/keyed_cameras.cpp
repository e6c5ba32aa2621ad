// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/foreign_file.hpp"
#include "camera/storage.hpp"
#include "formats/colmap_cameras.hpp"

#include <opencv2/core/affine.hpp>
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
    std::vector<double> numbers;
    for (const Names& names : {Names{"image_width", "image_height"}, Names{"width", "height"}, Names{"nx", "ny"}})
        if (numbers.size() != 2 && map.has(names[0]) && map.has(names[1]))
            numbers = numbersOf(Json::array({map.at(names[0]), map.at(names[1])}));
    const std::string both = nameIn(map, {"image_size", "imageSize", "resolution", "img_size", "size"}, "");
    if (numbers.size() != 2 && !both.empty())
        numbers = numbersOf(map.at(both));
    return numbers.size() == 2 ? imageSizeOf(numbers[0], numbers[1]) : Size();
}

//! "opencv" or "fisheye"; empty: the file does not say.
std::string lensModelIn(const Json& map)
{
    const std::string key = nameIn(map, {"cameraType", "distortion_model", "lens_model", "distortion_type"}, "");
    if (key.empty())
        return "";
    const Json& value = map.at(key);
    const std::string said = value.isNumber() ? cv::format("%g", value.asNumber()) : value.asText();
    const std::string name = said == "0" ? "opencv" : said == "1" ? "fisheye" : said;       // DepthAI numbers them
    const std::string model = cv::refract::lensModelCalled(name);
    if (model.empty())
        throw Failure("its " + key + " '" + said + "' has no equal among OpenCV's");
    return model;
}

//! OpenCV's own names and those of programs that took them over.
Ptr<RefractiveCamera> readOpenCV(const Json& map, const std::string& ending)
{
    const std::string distortion = nameIn(map, DISTORTIONS, ending);
    const Matx33d K = neededMatrix(map, nameIn(map, MATRICES, ending));
    if (distortion.empty())
        throw Failure("it has a camera matrix without coefficients of distortion: name them distortion_coefficients, distCoeffs, "
                      "D or dist; of a lens without distortion five zeros");
    const Json& value = map.at(distortion);
    const std::vector<double> D = numbersOf(value);
    const std::string model = lensModelIn(map);
    if (model.empty() && D.size() == 4 && std::count(D.begin(), D.end(), 0.) < 4)
        throw Failure("its " + distortion + " are four, and it does not say whether they are cv::fisheye's or k1, k2, p1, p2: add "
                      "distortion_model, equidistant or plumb_bob; the latter may have a fifth, 0, instead");
    if (D.empty() && !(value.isList() && value.items().empty()))
        throw Failure("its " + distortion + " are not all numbers");
    return makeCamera(model.empty() ? "opencv" : model, K, D, sizeIn(map));
}

Ptr<RefractiveCamera> readKalibr(const Json& map, const std::string&)
{
    const std::string model = map.at("camera_model").asText(), distortion = map.at("distortion_model").asText();
    if (model != "pinhole" || (distortion != "radtan" && distortion != "equi" && distortion != "none"))
        throw Failure("its lens " + model + "-" + distortion + " has no equal among OpenCV's: calibrate with pinhole-radtan or "
                      "pinhole-equi");
    const std::vector<double> p = neededNumbers(map, "intrinsics", 4);
    const std::vector<double> D = distortion == "none" ? std::vector<double>() : neededNumbers(map, "distortion_coeffs", 4);
    return makeCamera(lensModelIn(map), cameraMatrixOf(p[0], p[1], p[2], p[3]), D, sizeIn(map));
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

//! From focal lengths, centre and, if there is one, skew.
Matx33d focalMatrix(const Json& map, const std::string& focal, const std::string& center, const std::string& skew)
{
    const std::vector<double> f = neededNumbers(map, focal, 2), c = neededNumbers(map, center, 2);
    Matx33d K = cameraMatrixOf(f[0], f[1], c[0], c[1]);
    K(0, 1) = map.has(skew) ? neededNumbers(map, skew, 1)[0] : 0.;
    return K;
}

//! The toolbox of Bouguet, whose pixels count from 0, and whose skew is in focal lengths.
Ptr<RefractiveCamera> readBouguet(const Json& map, const std::string& ending)
{
    Matx33d K = focalMatrix(map, "fc" + ending, "cc" + ending, "alpha_c" + ending);
    K(0, 1) *= K(0, 0);
    return makeCamera("opencv", K, neededNumbers(map, "kc" + ending, 5), sizeIn(map));
}

//! MATLAB's toolbox, as a struct; its pixels count from 1, its older matrices are meant for rows.
Ptr<RefractiveCamera> readMatlab(const Json& map, const std::string&)
{
    if (map.has("MappingCoefficients"))
        throw Failure("MATLAB's fisheye model has no equal among OpenCV's");
    const Matx33d fromZero(1, 0, -1, 0, 1, -1, 0, 0, 1);
    const Matx33d K = map.has("IntrinsicMatrix") ? neededMatrix(map, "IntrinsicMatrix").t() : map.has("K") ? neededMatrix(map, "K")
        : focalMatrix(map, "FocalLength", "PrincipalPoint", "Skew");
    std::vector<double> D = numbersOf(map.at("RadialDistortion"));
    const std::vector<double> p = map.has("TangentialDistortion") ? neededNumbers(map, "TangentialDistortion", 2) : std::vector<double>(2);
    if (D.size() != 2 && D.size() != 3)
        throw Failure("its RadialDistortion must have 2 or 3 numbers");
    D.insert(D.begin() + 2, p.begin(), p.end());
    const std::vector<double> size = map.has("ImageSize") ? numbersOf(map.at("ImageSize")) : std::vector<double>();     // rows, columns
    return makeCamera("opencv", fromZero*K, D, size.size() == 2 ? imageSizeOf(size[1], size[0]) : Size());
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

//! A camera whose names end so; null if there is none.
Ptr<RefractiveCamera> cameraIn(const Json& map, const std::string& ending, std::string& format)
{
    for (const Dialect& dialect : DIALECTS)
        if (std::all_of(dialect.telling.begin(), dialect.telling.end(), [&](const std::string& n) { return map.has(n + ending); }))
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

//! A camera, and the map that it is in.
struct FoundCamera
{
    Ptr<RefractiveCamera> camera;
    const Json* map;
};
typedef std::vector<FoundCamera> Found;

//! Adds the cameras of this value and of those below it.
void collect(const Json& json, int depth, Found& found, std::string& format)
{
    const int DEEPEST = 5;
    if (depth > DEEPEST)
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

//! From one camera's frame, or any that all share, to another's.
typedef std::vector<cv::Affine3d> Places;

//! Names of a rotation and a translation, and whether they are meant for rows.
struct PlaceNames
{
    const char *R, *T;
    bool forRows;
};
const PlaceNames PLACES[] = {{"R", "T", false}, {"R", "t", false}, {"rotation_matrix", "translation_vector", false},
                             {"Rot", "Trans", false}, {"RotationOfCamera2", "TranslationOfCamera2", true}};

//! What this map itself says; empty: nothing.
Places placeIn(const Json& json)
{
    for (const PlaceNames& names : PLACES)
        if (json.has(names.R) && json.has(names.T))
        {
            const Matx33d R = neededMatrix(json, names.R);
            return {cv::Affine3d(names.forRows ? R.t() : R, Vec3d(neededNumbers(json, names.T, 3).data()))};
        }
    return {};
}

//! Of the second camera from the first, anywhere in the file but in this map.
Places findPlace(const Json& json, const Json* but, int depth)
{
    const int DEEPEST = 3;
    if (depth > DEEPEST || &json == but)
        return {};
    Places place = placeIn(json);
    for (size_t i = 0; i < json.names().size() && place.empty(); i++)
        place = findPlace(json.at(json.names()[i]), but, depth + 1);
    return place;
}

//! Each camera from one frame, in its own map.
Places ownPlaces(const Found& found)
{
    Places places;
    for (const FoundCamera& camera : found)
        for (const cv::Affine3d& place : &camera == &found[0] || camera.map != found[0].map ? placeIn(*camera.map) : Places())
            places.push_back(place);
    return places;
}

//! Kalibr: each camera from the one before it.
Places chainedPlaces(const Found& found)
{
    Places places(1);
    for (size_t c = 1; c < found.size() && found[c].map->has("T_cn_cnm1"); c++)
        places.push_back(cv::Affine3d(cv::Matx44d(neededNumbers(*found[c].map, "T_cn_cnm1", 16).data()))*places.back());
    return places;
}

//! Of all cameras, or of none.
Places placesOf(const Found& found, const Json& file)
{
    Places places = ownPlaces(found);
    if (places.size() == found.size())
        return places;
    const Places second = found.size() == 2 ? findPlace(file, found[0].map == found[1].map ? nullptr : found[0].map, 0) : Places();
    places = second.empty() ? chainedPlaces(found) : Places{cv::Affine3d(), second[0]};
    return places.size() == found.size() ? places : Places();
}

} // namespace

std::vector<double> numbersOf(const Json& json)
{
    const Json& value = json.has("data") ? json.at("data") : json;
    std::vector<double> numbers;
    if (value.isNumber())
        numbers.push_back(value.asNumber());
    for (size_t i = 0; value.isList() && i < value.items().size(); i++)
    {
        const Json& item = value.at(i);
        const std::vector<double> some = numbersOf(item);
        if (some.empty() && !(item.isList() && item.items().empty()))
            return {};
        numbers.insert(numbers.end(), some.begin(), some.end());
    }
    return numbers;
}

ForeignRig readKeyedCameras(const Json& file, std::string& format)
{
    Found found;
    collect(file, 0, found, format);
    const Places places = found.size() > 1 ? placesOf(found, file) : Places();
    ForeignRig rig;
    for (size_t c = 0; c < found.size(); c++)
        places.empty() ? rig.add(found[c].camera) : rig.add(found[c].camera, places[c].rotation(), places[c].translation());
    return rig;
}

} // namespace tools
