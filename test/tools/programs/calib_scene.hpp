// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_CALIB_SCENE_HPP
#define REFRACT_TEST_CALIB_SCENE_HPP

#include "run_tool.hpp"
#include "scenes.hpp"
#include <opencv2/calib3d.hpp>
#include <iomanip>
#include <sstream>

/* Corners files with known truth for refract_calib, and the commands that take them. */
namespace calib_scene {

using namespace cv;
using namespace cv::refract;

const double SIGMA = 0.1;
const Size IMAGE(1280, 1024), BOARD(6, 5);
const double SQUARE = 39.;
const char* const TARGET = " --pattern=chessboard --size=6x5 --square=39 --image-size=1280x1024";

//! The paper's windows before its left camera, twice almost.
struct PaperRig
{
    Mat K[2] = {Mat(paper::K1),
                Mat(Matx33d(2437.50, 0, 640.00, 0, 2437.60, 510.00, 0, 0, 1))};
    Mat dist = Mat(paper::D1, true);
    Vec3d normal[2] = {normalize(paper::NORMAL1), normalize(paper::NORMAL2)};
    Vec3d rvec{0.02, 0.35, 0.01}, T{-220, 5, 40};

    GlassWindow window(int camera) const { return paper::pane(50, normal[camera]); }
};

struct SceneOptions
{
    int views = 10;
    bool direct = true, stereo = false;
    double missing = 0.;                            // share of corners that are not seen
    double wrong = 0.;                              // share of corners that are 5 to 20 px off
    std::function<GlassWindow(int)> window;         // default: the rig's
};

inline std::vector<Point3d> boardPoints()
{
    std::vector<Point3d> points;
    for (int row = 0; row < BOARD.height; row++)
        for (int column = 0; column < BOARD.width; column++)
            points.emplace_back(SQUARE*column, SQUARE*row, 0);
    return points;
}

//! Writes direct1.vnl, glass1.vnl (, direct2.vnl, glass2.vnl) and camera1.yml, camera2.yml into a folder.
inline void writeScene(const TemporaryFolder& folder, const SceneOptions& options, unsigned salt)
{
    const PaperRig rig;
    scenes::Random random(salt);
    const std::vector<Point3d> object = boardPoints();
    std::ostringstream files[2][2];
    for (int m = 0; m < options.views; m++)
    {
        const Vec3d rvec = random.vector(0.4);
        Matx33d board, R;
        Rodrigues(rvec, board);
        const Vec3d middle(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(560, 660));
        const Vec3d tvec = middle - board*Vec3d(2.5*SQUARE, 2*SQUARE, 0);
        for (int c = 0; c < (options.stereo ? 2 : 1); c++)
        {
            Vec3d rvecC = rvec, tvecC = tvec;
            if (c == 1)
                composeRT(rvec, tvec, rig.rvec, rig.T, rvecC, tvecC);
            for (int through = 0; through < 2; through++)
            {
                if (!through && !options.direct)
                    continue;
                const GlassWindow window = !through ? GlassWindow() : options.window ? options.window(c) : rig.window(c);
                std::vector<Point2d> pixels;
                refractiveProjectPoints(object, rvecC, tvecC, rig.K[c], rig.dist, window, pixels);
                std::ostringstream& file = files[c][through];
                for (const Point2d& p : pixels)
                {
                    file << (through ? "glass" : "direct") << c + 1 << "/view" << std::setfill('0') << std::setw(2) << m << ".png ";
                    Point2d seen(p.x + random.normal(SIGMA), p.y + random.normal(SIGMA));
                    if (options.wrong > 0 && random.uniform(0, 1) < options.wrong)
                        seen.x += random.uniform(5, 20);
                    if (random.uniform(0, 1) < options.missing || !Rect2d(0, 0, IMAGE.width, IMAGE.height).contains(seen))
                        file << "- - -\n";
                    else
                        file << std::setprecision(10) << seen.x << ' ' << seen.y << " 0\n";
                }
            }
        }
    }
    for (int c = 0; c < 2; c++)
    {
        for (int through = 0; through < 2; through++)
            std::ofstream(folder/format("%s%d.vnl", through ? "glass" : "direct", c + 1))
                << "# filename x y level\n" << files[c][through].str();
        FileStorage out(folder/format("camera%d.yml", c + 1), FileStorage::WRITE);
        out << "camera_matrix" << rig.K[c] << "distortion_coefficients" << rig.dist
            << "image_width" << IMAGE.width << "image_height" << IMAGE.height;
    }
}

//! The command that calibrates it. @param more what to add
inline std::string brief(const TemporaryFolder& f, const std::string& more = "", bool direct = true)
{
    return std::string("refract_calib") + TARGET + (direct ? " --direct=" + f / "direct1.vnl" : "") + " --glass="
        + f / "glass1.vnl" + " --exact --out=" + f / "calib.yml" + ' ' + more;     // the scenes are
}

//! The same with all tables.
inline std::string inputs(const TemporaryFolder& f, const std::string& more = "", bool direct = true)
{
    return brief(f, more, direct) + (mentions(more, "--quiet") ? "" : " --verbose");
}

inline std::string images2(const TemporaryFolder& f) { return " --direct2=" + f / "direct2.vnl" + " --glass2=" + f / "glass2.vnl "; }

inline std::string stereoInputs(const TemporaryFolder& f, const std::string& more) { return inputs(f, images2(f) + more); }

inline std::string lens(const TemporaryFolder& f) { return " --camera=" + f / "camera1.yml"; }

const char* const PANE = " --thickness=20 --index=1.5437";

} // namespace calib_scene

#endif // REFRACT_TEST_CALIB_SCENE_HPP
