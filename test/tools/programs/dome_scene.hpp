// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_DOME_SCENE_HPP
#define REFRACT_TEST_DOME_SCENE_HPP

#include "run_tool.hpp"
#include <catch2/catch.hpp>

/* Cameras in domes, to render. */
namespace dome_scene {

//! Two cameras in water, each in a dome of its own; given values are those of a data sheet, the domes as delivered.
inline std::string scene(const std::string& center1 = "[ 3., -2., 6. ]", const std::string& center2 = "[ -4., 1., 5. ]",
                  const std::string& radius = "50.06", const std::string& sets = "")
{
    const auto camera = [&](const std::string& name, const std::string& f, const std::string& c, const std::string& center) {
        return name + ":\n   image_width: 800\n   image_height: 640\n   camera_matrix: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ "
            + f + ", 0., " + c + ", 0., " + f + ", 316., 0., 0., 1. ] }\n   distortion_coefficients: !!opencv-matrix { rows: 4, cols: 1, "
            "dt: d, data: [ -0.1, 0.05, 0.0005, -0.0005 ] }\n   glass_window: { shape: dome, center: " + center
            + ", radius: " + radius + ", thickness: [ 4.95 ], index: [ 1.4906 ], outer_index: 1.3334 }\n";
    };
    return "%YAML:1.0\n---\ntarget: { pattern: chessboard, size: \"9x6\", square: 25.003 }\n"
        + camera("camera1", "720.", "404.", center1) + camera("camera2", "728.", "396.", center2)
        + "R: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 0.97534, 0., -0.220713, 0., 1., 0., 0.220713, 0., 0.97534 ] }\n"
          "T: [ -120., 2., 15. ]\nexposure: { noise: 2., blur: 0.7, vignetting: 0.2 }\nseed: 5\nposes:\n"
          "   air: { count: 8, distance: [ 400., 600. ], tilt_deg: [ 10., 35. ], roll_deg: 30., margin: 8. }\n"
          "   pair: { count: 6, distance: [ 380., 650. ], tilt_deg: [ 5., 30. ], roll_deg: 20., margin: 8. }\n"
          "   test: { count: 3, distance: [ 380., 650. ], tilt_deg: [ 0., 30. ], roll_deg: 20., margin: 8. }\n"
          "sets:\n   direct: { window: 0, poses: [ air, pair ] }\n   glass: { window: 1, poses: [ pair ], "
          "motion: { rvec: [ 0., 0., 0. ], tvec: [ 0.02, -0.015, 0.02 ] } }\n"
          "   measure: { window: 1, poses: [ test ] }\n" + sets;
}

const char* const BOARD = " --size=9x6 --square=25";

//! A rendered rig and its folder.
struct Rendered
{
    TemporaryFolder folder;

    explicit Rendered(const std::string& text)
    {
        writeFile(folder / "rig.yml", text);
        const ToolResult r = runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / "img") + " --quiet");
        INFO(r.err);
        REQUIRE(r.code == 0);
    }
    std::string set(const std::string& name) const { return "'" + (folder / "img/") + name + "/*.png'"; }
    std::string pairsOf(const std::string& camera, const std::string& option) const
    {
        return " --direct" + option + "=" + set("direct" + camera) + " --glass" + option + "=" + set("glass" + camera);
    }
    std::string calib() const { return "refract_calib" + std::string(BOARD) + pairsOf("1", "") + pairsOf("2", "2"); }
    //! Of a rig of one camera.
    std::string one() const
    {
        return "refract_calib" + std::string(BOARD) + pairsOf("", "");
    }
    std::string out(const std::string& name) const { return folder / name; }
};

const char* const DOME = " --window=dome --radius=50 --thickness=5 --index=1.49 --outer-index=1.333 ";

} // namespace dome_scene

#endif // REFRACT_TEST_DOME_SCENE_HPP
