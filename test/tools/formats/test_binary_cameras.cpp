// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Lens files of bytes: NumPy's archives, MATLAB's variables, COLMAP's cameras.
#include "formats/foreign_files.hpp"
#include "paths.hpp"

using tools::ForeignRig;

namespace {

//! Of deflate: bytes as they are.
std::string storedBlock(const std::string& bytes)
{
    const uint16_t size = (uint16_t)bytes.size();
    return '\x01' + raw(size) + raw((uint16_t)~size) + bytes;
}

std::string npy(const std::string& type, bool fortran, const std::string& shape, const std::string& data)
{
    const std::string heading = "{'descr': '" + type + "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': (" + shape
        + "), }\n";
    return std::string("\x93NUMPY\x01\x00", 8) + raw((uint16_t)heading.size()) + heading + data;
}

//! A zip of arrays. @param method 0 stored, 8 deflated
std::string npz(const std::vector<std::pair<std::string, std::string>>& arrays, uint16_t method)
{
    std::string bytes, directory;
    for (const auto& [name, content] : arrays)
    {
        const std::string data = method ? storedBlock(content) : content, file = name + ".npy";
        const std::string sizes = raw(std::vector<uint32_t>{0, (uint32_t)data.size(), (uint32_t)content.size()});
        directory += "PK\x01\x02" + raw(std::vector<uint16_t>{20, 20, 0, method, 0, 0}) + sizes
                   + raw(std::vector<uint16_t>{(uint16_t)file.size(), 0, 0, 0, 0, 0, 0}) + raw((uint32_t)bytes.size()) + file;
        bytes += "PK\x03\x04" + raw(std::vector<uint16_t>{20, 0, method, 0, 0}) + sizes + raw(std::vector<uint16_t>{(uint16_t)file.size(),
                                                                                                                    4})
               + file + "more" + data;
    }
    return bytes + directory + "PK\x05\x06" + raw(std::vector<uint16_t>{0, 0, (uint16_t)arrays.size(), (uint16_t)arrays.size()})
         + raw(std::vector<uint32_t>{(uint32_t)directory.size(), (uint32_t)bytes.size()}) + raw((uint16_t)0);
}

std::string element(uint32_t type, const std::string& data)
{
    return raw(type) + raw((uint32_t)data.size()) + data + std::string((8 - data.size() % 8) % 8, '\0');
}

//! MATLAB: a matrix by columns, or a struct of the elements that follow.
std::string variable(const std::string& name, int rows, int columns, const std::vector<double>& numbers)
{
    return element(14, element(6, raw(std::vector<uint32_t>{6, 0})) + element(5, raw(std::vector<int32_t>{rows, columns}))
                   + element(1, name) + element(9, raw(numbers)));
}
std::string structure(const std::string& name, const std::vector<std::string>& names, const std::string& members)
{
    std::string all;
    for (const std::string& member : names)
        all += member + std::string(32 - member.size(), '\0');
    return element(14, element(6, raw(std::vector<uint32_t>{2, 0})) + element(5, raw(std::vector<int32_t>{1, 1})) + element(1, name)
                   + raw((uint16_t)5) + raw((uint16_t)4) + raw((int32_t)32) + element(1, all) + members);
}

//! MATLAB's save -v7.
std::string compressed(const std::string& bytes)
{
    uint32_t a = 1, b = 0;
    for (unsigned char c : bytes)
    {
        a = (a + c) % 65521;
        b = (b + a) % 65521;
    }
    const uint32_t sum = b << 16 | a;
    const std::string data = "\x78\x01" + storedBlock(bytes) + std::string{(char)(sum >> 24), (char)(sum >> 16), (char)(sum >> 8),
                                                                           (char)sum};
    return raw((uint32_t)15) + raw((uint32_t)data.size()) + data;
}

std::string mat(const std::string& variables)
{
    std::string head = "MATLAB 5.0 MAT-file, made by a test";
    head.resize(124, ' ');
    return head + raw((uint16_t)0x0100) + "IM" + variables;
}

const std::vector<double> K = {1210.5, 0, 639.25, 0, 1190.25, 481.5, 0, 0, 1}, K_COLUMNS = {1210.5, 0, 0, 0, 1190.25, 0, 639.25, 481.5, 1};
const std::vector<double> D = {-0.11, 0.07, 0.001, -0.002, 0.013};
const Distortion BROWN = brown(-0.11, 0.07, 0.001, -0.002, 0.013);

void requireSame(const ForeignRig& rig, double corner = 0) { requireLens(rig.cameras.at(0), BROWN, 1210.5, 1190.25, 639.25 - corner,
                                                                         481.5 - corner); }

//! @param parameters fx fy cx cy and others
std::string colmapRecord(int id, int model, const std::vector<double>& parameters)
{
    return raw(std::vector<int32_t>{id, model}) + raw(std::vector<uint64_t>{1280, 960}) + raw(parameters);
}

} // namespace

TEST_CASE("NumPy's archives are read, stored and compressed, in both orders of memory", "[foreign]")
{
    TemporaryFolder f;
    for (uint16_t method : {0, 8})
    {
        requireSame(rigOf(f, npz({{"mtx", npy("<f8", false, "3, 3", raw(K))}, {"dist", npy("<f8", false, "1, 5", raw(D))}}, method)));
        requireSame(rigOf(f, npz({{"rvecs", npy("|O", false, "2,", "pickled")}, {"camera_matrix", npy("<f8", true, "3, 3", raw(K_COLUMNS))},
                                 {"D", npy("<f8", false, "5,", raw(D))}, {"width", npy("<i8", false, "", raw((int64_t)1280))},
                                 {"height", npy("<i4", false, "", raw((int32_t)960))}}, method)));
    }
    const std::string whole = npz({{"mtx", npy("<f8", false, "3, 3", raw(K))}, {"dist", npy("<f8", false, "1, 5", raw(D))}}, 8);
    for (size_t size : {(size_t)40, whole.size()/2, whole.size() - 30})
        CHECK_THAT(refusal(saved(f, "cut", whole.substr(0, size))), Catch::Contains("looks like NumPy's archive, but")
                   && Catch::Contains("cut short"));
    CHECK_THAT(refusal(saved(f, "none", npz({{"a", npy("<f8", false, "1,", raw(1.))}}, 0))), Catch::Contains("there is no camera in it"));
    CHECK_THAT(refusal(saved(f, "big", npz({{"mtx", npy(">f8", false, "3, 3", raw(K))}, {"dist", npy("<f8", false, "5,", raw(D))}}, 0))),
               Catch::Contains("its mtx must have 9 numbers, and is 'numbers of type >f8: save them as float64'"));
}

TEST_CASE("Bouguet's Calib_Results is read, of one camera and of two", "[foreign]")
{
    TemporaryFolder f;
    const auto camera = [](const std::string& e, double f0) {
        return variable("fc" + e, 2, 1, {f0, 1190.25}) + variable("cc" + e, 2, 1, {639.25, 481.5}) + variable("kc" + e, 5, 1, D)
            + variable("alpha_c" + e, 1, 1, {0});
    };
    for (bool smaller : {false, true})
    {
        const std::string one = variable("nx", 1, 1, {1280}) + variable("ny", 1, 1, {960});
        const ForeignRig rig = rigOf(f, mat(smaller ? compressed(variable("fc", 2, 1, {1210.5, 1190.25})) + compressed(variable("cc", 2, 1,
                                    {639.25, 481.5})) + compressed(variable("kc", 5, 1, D)) + one : camera("", 1210.5) + one));
        requireSame(rig);
        CHECK(rig.cameras[0]->imageSize() == cv::Size(1280, 960));
    }
    const ForeignRig pair = rigOf(f, mat(camera("_left", 1210.5) + camera("_right", 1000)
                                        + variable("R", 3, 3, {0.8, 0, -0.6, 0, 1, 0, 0.6, 0, 0.8}) + variable("T", 3, 1, {-60, 1, 2})));
    REQUIRE(pair.cameras.size() == 2);
    requireSame(pair);
    requireLens(pair.cameras[1], BROWN, 1000, 1190.25, 639.25, 481.5);
    CHECK(cv::norm(pair.Rs[1], cv::Mat(cv::Matx33d(0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8))) < 1e-15);
    CHECK_THAT(refusal(saved(f, "x", mat(variable("fc", 2, 1, {1000, 1000}) + variable("cc", 2, 1, {500, 400})))),
               Catch::Contains("looks like Bouguet's Calib_Results, but there is no 'kc'"));
}

TEST_CASE("MATLAB's parameters are read as structs: pixels from 1, matrices for rows", "[foreign]")
{
    TemporaryFolder f;
    // The transpose of K: by columns that is K by rows.
    const std::vector<std::string> names = {"RadialDistortion", "TangentialDistortion", "ImageSize", "IntrinsicMatrix"};
    const std::string members = variable("", 1, 3, {-0.11, 0.07, 0.013}) + variable("", 1, 2, {0.001, -0.002}) + variable("", 1, 2, {960,
                                                                                                                                     1280})
        + variable("", 3, 3, K);
    const ForeignRig rig = rigOf(f, mat(structure("p", names, members)));
    requireSame(rig, 1.);
    CHECK(rig.cameras[0]->imageSize() == cv::Size(1280, 960));
    const ForeignRig pair = rigOf(f, mat(structure("stereo", {"CameraParameters1", "CameraParameters2", "RotationOfCamera2",
                                                             "TranslationOfCamera2"},
        structure("", names, members) + structure("", {"RadialDistortion", "TangentialDistortion", "K"}, variable("", 1, 2, {0, 0})
            + variable("", 1, 2, {0, 0}) + variable("", 3, 3, {900, 0, 0, 0, 901, 0, 320, 240, 1}))
        + variable("", 3, 3, {0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8}) + variable("", 1, 3, {-60, 1, 2}))));
    REQUIRE(pair.cameras.size() == 2);
    requireSame(pair, 1.);
    requireLens(pair.cameras[1], brown(0, 0, 0, 0), 900, 901, 319, 239);
    // x2 = x1 R + t, a row, with R as MATLAB has it: by columns 0.8 0 0.6 ...
    const cv::Matx33d R(0.8, 0, -0.6, 0, 1, 0, 0.6, 0, 0.8);
    CHECK(cv::norm(pair.Rs[1], cv::Mat(R.t())) < 1e-15);
    CHECK(cv::norm(pair.Ts[1], cv::Mat(cv::Vec3d(-60, 1, 2))) < 1e-12);
    const std::string object = element(14, element(6, raw(std::vector<uint32_t>{17, 0})) + element(1, "params") + element(1, "MCOS"));
    CHECK_THAT(refusal(saved(f, "x", mat(object))), Catch::Contains("'params' is an object of a class")
               && Catch::Contains("toStruct(params)"));
    CHECK_THAT(refusal(saved(f, "x", "MATLAB 7.3 MAT-file, Platform")), Catch::Contains("looks like MATLAB's file")
               && Catch::Contains("save -v7"));
    CHECK_THAT(refusal(saved(f, "x", mat(structure("p", names, members)).substr(0, 300))), Catch::Contains("cut short"));
}

TEST_CASE("COLMAP's cameras are read, as text and as bytes; what OpenCV has no equal of is named", "[foreign]")
{
    TemporaryFolder f;
    struct Model
    {
        const char* name;
        int id;
        std::vector<double> parameters;
        Distortion distortion;
        double fy;
    };
    const std::vector<Model> models = {
        {"SIMPLE_PINHOLE", 0, {1000, 640, 480}, brown(0, 0, 0, 0), 1000},
        {"PINHOLE", 1, {1000, 900, 640, 480}, brown(0, 0, 0, 0), 900},
        {"SIMPLE_RADIAL", 2, {1000, 640, 480, -0.1}, brown(-0.1, 0, 0, 0), 1000},
        {"RADIAL", 3, {1000, 640, 480, -0.1, 0.05}, brown(-0.1, 0.05, 0, 0), 1000},
        {"OPENCV", 4, {1000, 900, 640, 480, -0.1, 0.05, 0.001, -0.002}, brown(-0.1, 0.05, 0.001, -0.002), 900},
        {"OPENCV_FISHEYE", 5, {1000, 900, 640, 480, 0.02, -0.01, 0.003, 0.001}, equidistant(0.02, -0.01, 0.003, 0.001), 900},
        {"FULL_OPENCV", 6, {1000, 900, 640, 480, -0.1, 0.05, 0.001, -0.002, 0.01, 0.1, 0.02, 0.003},
         brown(-0.1, 0.05, 0.001, -0.002, 0.01, 0.1, 0.02, 0.003), 900},
        {"SIMPLE_RADIAL_FISHEYE", 8, {1000, 640, 480, 0.02}, equidistant(0.02, 0, 0, 0), 1000},
        {"RADIAL_FISHEYE", 9, {1000, 640, 480, 0.02, -0.01}, equidistant(0.02, -0.01, 0, 0), 1000}};
    std::string text = "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n",
        binary = raw((uint64_t)models.size());
    for (const Model& m : models)
    {
        text += std::to_string(m.id + 1) + " " + m.name + " 1280 960";
        for (double p : m.parameters)
            text += cv::format(" %.17g", p);
        text += "\n";
        binary += colmapRecord(m.id + 1, m.id, m.parameters);
    }
    for (const std::string& bytes : {text, binary})
    {
        const ForeignRig rig = rigOf(f, bytes);
        REQUIRE(rig.cameras.size() == models.size());
        for (size_t i = 0; i < models.size(); i++)      // a pixel's corner is (0, 0) there, and its centre here
            requireLens(rig.cameras[i], models[i].distortion, 1000, models[i].fy, 640 - 0.5, 480 - 0.5);
    }
    CHECK(refusal(saved(f, "x", "1 FOV 1280 960 1000 1000 640 480 0.9\n")) == "'" + f/"x"
          + "' looks like COLMAP's cameras.txt, but its camera "
          "model FOV has no equal among OpenCV's: undistort the images there, or calibrate with OPENCV, FULL_OPENCV or OPENCV_FISHEYE");
    CHECK_THAT(refusal(saved(f, "x", text.substr(0, text.rfind(' ')))), Catch::Contains("RADIAL_FISHEYE has 5 parameters, here are 4"));
    CHECK_THAT(refusal(saved(f, "x", binary.substr(0, binary.size() - 3))),
               Catch::Contains("looks like COLMAP's cameras.bin, but it ends too early"));
}

TEST_CASE("A file of another program that is cut or damaged anywhere is read or refused in a sentence", "[foreign]")
{
    TemporaryFolder f;
    int refused = 0;
    for (const auto& entry : std::filesystem::directory_iterator(paths::tests() + "/fuzz/corpus/foreign_rig"))
    {
        std::ifstream in(entry.path(), std::ios::binary);
        const std::string whole((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
        const std::string name = entry.path().filename().string();
        CAPTURE(name);
        CHECK((name == "camera.ori" ? refusal(entry.path().string()).find("put 'camera.addpar'") != std::string::npos
                                    : refusal(entry.path().string()) == "read"));
        for (size_t at = 0; at < whole.size(); at += 7)
            for (bool cut : {true, false})
            {
                std::string bytes = cut ? whole.substr(0, at) : whole;
                if (!cut)
                    bytes[at] ^= 0x55;
                const std::string said = refusal(saved(f, name, bytes));
                const bool isSentence = said.find("' looks like ") != std::string::npos && said.find(", but ") != std::string::npos;
                CAPTURE(at, cut, said);
                CHECK((said.empty() || said == "read" || isSentence));
                refused += isSentence;
            }
    }
    CHECK(refused > 300);
}
