// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Scenes, rigs and ranges of many kinds without any mistake: refract_stereo takes them without a word.
#include "calibrate/calib_file.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/rig_model.hpp"
#include "programs/run_tool.hpp"
#include "depth_comparison.hpp"
#include "scenes.hpp"
#include "stereo/depth_picture.hpp"
#include <catch2/catch.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <iostream>
#include <random>

namespace fs = std::filesystem;
using namespace tools;
using cv::Mat;
using cv::Vec3d;

namespace {

class RandomScene
{
public:
    explicit RandomScene(unsigned seed) : random_(seed) {}

    double between(double least, double most) { return std::uniform_real_distribution<double>(least, most)(random_); }
    double normal(double sigma) { return sigma*std::normal_distribution<double>()(random_); }

    //! A RIG.yml: two cameras before one place, each behind its own pane; planes and spheres.
    std::string rig()
    {
        const double outer = between(0, 1) < 0.25 ? 1.333 : 1, base = between(50, 160), verged = between(0, 0.8)*base/800;
        std::string text = "%YAML:1.0\n---\n";
        for (int c = 1; c <= 2; c++)
            text += cv::format("camera%d:\n", c) + camera(outer);
        Mat R;
        cv::Rodrigues(Vec3d(normal(0.01), verged + normal(0.005), normal(0.01)), R);
        text += "R: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ ";
        for (int i = 0; i < 9; i++)
            text += cv::format("%.12f%s", R.at<double>(i/3, i % 3), i < 8 ? ", " : " ] }\n");
        text += cv::format("T: [ %.6f, %.6f, %.6f ]\n", -base, normal(3), normal(5));
        text += cv::format("exposure: { dark: 15., light: %.1f, background: 90., blur: %.2f, noise: %.2f, vignetting: 0.1 }\n",
                           between(140, 240), between(0.4, 0.9), between(0.3, 2.5));
        text += cv::format("seed: %d\ntexture: { size: %.1f, contrast: %.2f, octaves: 7 }\nscene:\n", (int)between(1, 1e6),
                           between(40, 110), between(0.5, 0.98));
        const double wall = between(650, 1300);
        text += cv::format("   - { shape: plane, point: [ 0., 0., %.1f ], normal: [ %.3f, %.3f, -1. ] }\n", wall, normal(0.1), normal(0.1));
        for (int k = (int)between(0, 4); k > 0; k--)
        {
            const double z = wall*between(0.6, 0.95);
            text += cv::format("   - { shape: sphere, center: [ %.1f, %.1f, %.1f ], radius: %.1f }\n", z*normal(0.12), z*normal(0.1), z,
                               z*between(0.05, 0.15));
        }
        return text + "sets:\n   glass: { window: 1, scene: 1 }\n";
    }

private:
    std::string camera(double outer)
    {
        const double focal = between(330, 450), tiltX = between(-0.22, 0.22), tiltY = between(-0.22, 0.22);
        std::string text = "   image_width: 320\n   image_height: 240\n";
        text += cv::format("   camera_matrix: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ %.2f, 0., %.2f, 0., %.2f, %.2f, 0., 0., "
                           "1. ] }\n", focal, 160 + normal(4), focal*1.001, 120 + normal(4));
        text += cv::format("   distortion_coefficients: !!opencv-matrix { rows: 4, cols: 1, dt: d, data: [ %.4f, %.4f, 0., 0. ] }\n",
                           between(-0.2, 0), between(0, 0.1));
        text += cv::format("   glass_window: { normal: [ %.6f, %.6f, %.8f ], distance: %.1f, thickness: [ %.2f ], index: [ %.3f ], "
                           "outer_index: %.3f }\n", tiltX, tiltY, std::sqrt(1 - tiltX*tiltX - tiltY*tiltY), between(20, 80),
                           between(4, 30), between(1.46, 1.6), outer);
        return text;
    }

    std::mt19937 random_;
};

//! The rig as a calibration might have found it: off by what its covariance says.
void disturb(Calibration& rig, RandomScene& scene)
{
    RigModel model = modelOf(rig);
    const int count = columnCount(model), place = extrinsicsColumn(model, 1);
    const double FOCAL = 0.3, CENTRE = 0.3, TILT = 0.002, THICKER = 0.05, TURN = 3e-4, SHIFT = 0.1;
    rig.covariance = Mat::zeros(count, count, CV_64F);
    const auto drawn = [&](int column, double sigma) {
        rig.covariance.at<double>(column, column) = sigma*sigma;
        return scene.normal(sigma);
    };
    for (int c = 0; c < 2; c++)
    {
        const ParameterColumns columns = columnsOf(model, c);
        auto& camera = rig.cameras[c].camera;
        const cv::Size size = camera->imageSize();
        Mat lens = camera->lensParameters();
        for (int k = 0; k < 4; k++)
            lens.at<double>(k) += drawn(columns.lens + k, k < 2 ? FOCAL : CENTRE);
        cv::refract::GlassWindow window = camera->window();
        const Vec3d n = window.normal, a = cv::normalize(n.cross(Vec3d(0, 1, 0))), b = n.cross(a);
        const cv::Matx33d C = TILT*TILT*(a*a.t() + b*b.t());
        Mat(C).copyTo(rig.covariance(cv::Rect(columns.normal, columns.normal, 3, 3)));
        window.normal = cv::normalize(n + scene.normal(TILT)*a + scene.normal(TILT)*b);
        window.thickness[0] += drawn(columns.thickness, THICKER);
        camera = copyWithWindow(camera, window);
        camera->setLensParameters(lens);
        camera->setImageSize(size);
    }
    RigidTransform& T = rig.extrinsics[1];
    Vec3d rvec = rotationVector(T.R);
    for (int k = 0; k < 3; k++)
    {
        rvec[k] += drawn(place + k, TURN);
        T.t[k] += drawn(place + 3 + k, SHIFT);
    }
    Mat R;
    cv::Rodrigues(rvec, R);
    T.R = cv::Matx33d(R.ptr<double>());
}

struct Sum
{
    int scenes = 0, refused = 0, warned = 0, exact = 0;
    double written = 0, wrong = 0, worst = 0;       // the last two of exact calibrations
};

//! Half of the calibrations are exact, the others are off by what their covariance says; a third of the ranges is searched.
void tryScene(unsigned seed, Sum& sum)
{
    const TemporaryFolder folder;
    RandomScene scene(seed);
    writeFile(folder / "rig.yml", scene.rig());
    const ToolResult rendered = runTool("refract_simulate " + (folder / "rig.yml") + " --out-dir=" + (folder / "s"));
    CAPTURE(seed, rendered.err);
    REQUIRE(rendered.code == 0);
    const Mat truth = cv::imread(folder / "s/glass1/scene_depth.tiff", cv::IMREAD_UNCHANGED);
    const std::vector<float> depths = sortedDepths(truth);
    Calibration rig = readCalibration(folder / "s/truth.yml");
    const bool isExact = seed % 2;
    if (!isExact)
        disturb(rig, scene);
    writeCalibration(folder / "calib.yml", rig);
    const double near = depths.front()/scene.between(1.02, 1.5), far = depths.back()*scene.between(1.02, 2);
    const std::string depth = seed % 3 == 0 ? "" : cv::format(" --depth=%.4g,%.4g", near, far);
    const ToolResult result = runTool("refract_stereo " + (folder / "calib.yml") + " " + (folder / "s/glass1/scene.png") + " "
                                      + (folder / "s/glass2/scene.png") + depth + " --depth-map=" + (folder / "d.tiff"));
    sum.scenes++;
    sum.refused += result.code == 1;
    sum.warned += result.code != 1 && (result.code != 0 || !result.err.empty());
    if (result.code != 0 || !result.err.empty())
        std::cout << "seed " << seed << (isExact ? "" : ", disturbed") << depth << ", scene " << depths.front() << " to "
                  << depths.back() << ": exit " << result.code << ", " << result.err;
    if (result.code == 1)
        return;
    const DepthComparison comparison = compareDepths(cv::imread(folder / "d.tiff", cv::IMREAD_UNCHANGED), truth);
    sum.written += (double)comparison.matched/comparison.known;
    if (!isExact)
        return;
    const double wrong = (double)comparison.wrong/comparison.matched;
    sum.exact++;
    sum.wrong += wrong;
    sum.worst = std::max(sum.worst, wrong);
}

Sum tryScenes(int count)
{
    const char* given = std::getenv("REFRACT_TEST_SEED");
    const unsigned first = given ? (unsigned)std::stoul(given) : 1;
    std::cout << "seeds from " << first << "\n";
    Sum sum;
    for (int i = 0; i < count; i++)
        tryScene(first + (unsigned)i, sum);
    std::cout << cv::format("[numbers] refract_stereo, %d scenes without a mistake: %d refused, %d warned of; %.1f %% written; of that of "
                            "exact calibrations %.2f %% wrong, at most %.2f %%\n", sum.scenes, sum.refused, sum.warned,
                            100*sum.written/sum.scenes, 100*sum.wrong/sum.exact, 100*sum.worst);
    return sum;
}

} // namespace

TEST_CASE("refract_stereo takes scenes without a mistake without a word", "[tools][stereo]")
{
    const Sum sum = tryScenes(6);
    CHECK(sum.refused + sum.warned == 0);
    CHECK(sum.written > 0.5*sum.scenes);
}

TEST_CASE("Of 100 scenes without a mistake at most one is refused or warned of", "[.monte-carlo][stereo]")
{
    const Sum sum = tryScenes(scenes::trials(100));
    CHECK(100*(sum.refused + sum.warned) <= sum.scenes);
}
