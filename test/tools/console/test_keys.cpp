// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/calib_file.hpp"
#include "console/failure.hpp"
#include "console/keys.hpp"
#include "paths.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <fstream>
#include <regex>
#include <sstream>

using namespace tools;

TEST_CASE("A misspelled key is refused, one of another program not", "[keys]")
{
    const std::vector<std::string> known = {"camera_matrix", "lens_model", "R"};
    const auto check = [&known](const std::string& key) {
        const cv::FileStorage fs("%YAML:1.0\n---\n" + key + ": 1\n", cv::FileStorage::READ | cv::FileStorage::MEMORY);
        requireNoMisspelling(fs.root(), known, "rig.yml");
    };
    for (const std::string key : {"camera_matrix", "camera_matrix2", "camera_name", "lens", "R3", "Rs", "nframes"})
    {
        CAPTURE(key);
        CHECK_NOTHROW(check(key));
    }
    for (const std::string key : {"camera_matrx", "cameramatrix", "camera_martix", "lens_modl", "lensmodel"})
    {
        CAPTURE(key);
        CHECK_THROWS_WITH(check(key), Catch::Contains("'" + key + "'") && Catch::Contains("is it '"));
    }
    const cv::FileStorage shorter("%YAML:1.0\n---\nseedx: 1\n", cv::FileStorage::READ | cv::FileStorage::MEMORY);
    CHECK_THROWS_WITH(requireNoMisspelling(shorter.root(), {"seed"}, "rig.yml", 4), Catch::Contains("is it 'seed'"));
    CHECK_NOTHROW(requireNoMisspelling(shorter.root(), {"sets", "seek"}, "rig.yml", 4));
    CHECK_NOTHROW(requireNoMisspelling(cv::FileNode(), known, "rig.yml"));
}

TEST_CASE("A calibration that a misspelled key makes contradict itself is refused by the key", "[keys]")
{
    std::ifstream in(paths::bundled() + "/stereo/truth.yml");
    std::stringstream text;
    text << in.rdbuf();
    const TemporaryFolder folder;
    const std::string path = folder / "typo.yml";
    // Without its windows a rig has fewer parameters than its covariance.
    std::ofstream(path) << std::regex_replace(text.str(), std::regex("glass_window:"), "glas_window:")
                        << "covariance: !!opencv-matrix\n   rows: 1\n   cols: 1\n   dt: d\n   data: [ 1. ]\n";
    CHECK_THROWS_WITH(readCalibration(path), Catch::Contains("'glas_window'") && Catch::Contains("is it 'glass_window'"));
}
