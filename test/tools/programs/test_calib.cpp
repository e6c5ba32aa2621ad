// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_calib as a user runs it: on corners files with known truth, on wrong input, on real images.
#include "calib_scene.hpp"
#include "paths.hpp"
#include <nlohmann/json.hpp>
#include <map>
#include <set>

using namespace cv;
using namespace cv::refract;
using namespace calib_scene;

namespace {

double degreesBetween(const Vec3d& a, const Vec3d& b) { return std::atan2(norm(a.cross(b)), a.dot(b))*180/CV_PI; }

//! RMS of glass1.vnl behind a window, each board where it fits best.
double rmsThrough(const TemporaryFolder& f, const GlassWindow& window)
{
    const std::vector<Point3d> object = boardPoints();
    std::map<std::string, std::vector<Point2d>> views;
    std::ifstream file(f / "glass1.vnl");
    std::string line, name;
    std::getline(file, line);       // the heading
    for (double x, y, level; file >> name >> x >> y >> level;)
        views[name].emplace_back(x, y);
    const PaperRig rig;
    double squares = 0;
    for (const auto& view : views)
    {
        Vec3d rvec, tvec;
        std::vector<double> error;
        REQUIRE(refractiveSolvePnP(object, view.second, rig.K[0], rig.dist, window, rvec, tvec, false, error));
        squares += 2*error[0]*error[0];
    }
    return std::sqrt(squares/views.size());
}

} // namespace

TEST_CASE("refract_calib finds the normal from pairs and says how well", "[calib_tool]")
{
    const TemporaryFolder f;
    writeScene(f, {}, 101);
    const ToolResult r = runTool(inputs(f, PANE + lens(f)));
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);

    const FileStorage file(f / "calib.yml", FileStorage::READ);
    GlassWindow window;
    file["glass_window"] >> window;
    std::vector<double> std;
    file["glass_window_std"]["normal_deg"] >> std;
    REQUIRE(std.size() == 2);
    CHECK(std[0] == Approx(0.0165).epsilon(0.6));       // physics: 0.016 for ten pairs
    CHECK(degreesBetween(window.normal, PaperRig().normal[0]) < 4*std[0]);
    CHECK(window.thickness == std::vector<double>{20.});
    CHECK(window.index == std::vector<double>{1.5437});
    CHECK((double)file["rms"] == Approx(SIGMA*std::sqrt(2.)).epsilon(0.15));
    CHECK((int)file["image_width"] == IMAGE.width);
    CHECK((std::string)file["lens_model"] == "opencv");
    CHECK(file["covariance"].isMap());
    CHECK((std::string)file["unit"] == "mm");
    CHECK((double)file["target_square"] == SQUARE);
    CHECK(mentions(r.out, "the square of 39 mm"));
    CHECK(mentions((std::string)file["command"], "--thickness=20"));

    CHECK(mentions(r.out, "+-"));
    CHECK(mentions(r.out, "pinhole through glass"));
    CHECK(mentions(r.out, "The data cannot tell"));
    CHECK(r.err.empty());
}

//! fx that refract_calib finds from 14 views without a lens from a file; the normal is checked here.
static double focalLengthOf(SceneOptions options, unsigned salt, const std::string& more)
{
    const TemporaryFolder f;
    options.views = 14;
    writeScene(f, options, salt);
    const ToolResult r = runTool(inputs(f, std::string(PANE) + " --lens=opencv4" + more));
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    const Ptr<RefractiveCamera> camera = RefractiveCamera::read(f / "calib.yml");
    CHECK(degreesBetween(camera->window().normal, PaperRig().normal[0]) < 0.1);
    return camera->cameraMatrix().at<double>(0, 0);
}

static GlassWindow windowOf(const TemporaryFolder& f)
{
    return RefractiveCamera::read(f / "calib.yml")->window();
}

TEST_CASE("refract_calib takes the name of a material where an index stands, and says which it took", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    const double index = refractiveIndex("N-BK7", 600.);
    options.window = [=](int) { return GlassWindow(PaperRig().normal[0], 20., index, 50.); };
    writeScene(f, options, 118);
    const std::string pane = lens(f) + " --no-cross-validation --thickness=20 --index=";
    const ToolResult byNumber = runTool(inputs(f, pane + format("%.17g", index)));
    REQUIRE(byNumber.code == 0);
    const GlassWindow given = windowOf(f);
    CHECK_FALSE(mentions(byNumber.out, "N-BK7"));

    const ToolResult byName = runTool(inputs(f, pane + "N-BK7 --wavelength=600"));
    INFO(byName.out << byName.err);
    REQUIRE(byName.code == 0);
    CHECK(windowOf(f).index == given.index);
    CHECK(windowOf(f).normal == given.normal);
    CHECK(mentions(byName.out, format("the index of N-BK7 at 600 nm: %.5f", index)));

    // Only ratios count: in thinner air the pane's index is higher.
    const std::string hot = "air:T=40,P=90000";
    const ToolResult inHotAir = runTool(inputs(f, pane + "N-BK7 --wavelength=600 --inner-index=" + hot + " --outer-index=" + hot));
    INFO(inHotAir.out << inHotAir.err);
    REQUIRE(inHotAir.code == 0);
    CHECK(mentions(inHotAir.out, "the index of N-BK7, relative to " + hot + ", at 600 nm: 1.51"));
    CHECK(mentions(inHotAir.out, "the index of " + hot + ", which all are relative to, at 600 nm: 1.00000"));
    CHECK(windowOf(f).innerIndex == 1.);
    CHECK(windowOf(f).outerIndex == 1.);
    CHECK(windowOf(f).index[0] == Approx(index/refractiveIndex(hot, 600.)).epsilon(1e-15));
    CHECK(windowOf(f).index[0] > index + 5e-5);
}

TEST_CASE("refract_calib takes the lens from the direct images and lives with missing corners", "[calib_tool]")
{
    SceneOptions options;
    options.missing = 0.15;
    CHECK(focalLengthOf(options, 102, "") == Approx(2438.).epsilon(0.01));
}

TEST_CASE("refract_calib chooses as many lens coefficients as the images determine, and says it", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.views = 14;
    writeScene(f, options, 119);
    const std::string summary = " --no-cross-validation --summary=" + f / "summary.json";
    const ToolResult chosen = runTool(inputs(f, PANE + summary));
    INFO(chosen.out << chosen.err);
    REQUIRE(chosen.code == 0);
    CHECK(mentions(chosen.out, "Lens: opencv, 2 coefficients (k1, k2), chosen by held-out images: 0."));
    const nlohmann::json lens = nlohmann::json::parse(readFile(f / "summary.json"))["lens_choice"];
    CHECK(lens["model"] == "opencv");
    CHECK(lens["coefficients"] == 2);
    CHECK(lens["held_out"] == "images");
    CHECK(lens["images"] == "direct images");
    REQUIRE(lens["candidates"].size() == 8);
    CHECK(lens["candidates"][0]["rms_px"].get<double>() > 2*lens["candidates"][2]["rms_px"].get<double>());
    const Mat coefficients = RefractiveCamera::read(f / "calib.yml")->distCoeffs();
    REQUIRE(coefficients.total() == 5);         // what is left out is 0 as well as the images tell it
    CHECK(coefficients.at<double>(0) == Approx(-0.408).margin(0.03));
    CHECK(coefficients.at<double>(2) == Approx(0).margin(3e-4));
    CHECK(coefficients.at<double>(3) == Approx(0).margin(3e-4));
    CHECK(coefficients.at<double>(2) != 0);

    const ToolResult named = runTool(inputs(f, PANE + summary + " --lens=opencv5"));
    INFO(named.out << named.err);
    REQUIRE(named.code == 0);
    CHECK_FALSE(mentions(named.out, "Lens: "));
    CHECK(nlohmann::json::parse(readFile(f / "summary.json"))["lens_choice"].is_null());
    CHECK(RefractiveCamera::read(f / "calib.yml")->distCoeffs().total() == 5);
}

TEST_CASE("refract_calib chooses the lens through the window where there is no other image", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.views = 20;
    writeScene(f, options, 120);
    const ToolResult r = runTool(inputs(f, std::string(PANE) + " --free=intrinsics --no-cross-validation", false));
    INFO(r.out << r.err);
    REQUIRE(r.code != 1);
    CHECK(mentions(r.out, "chosen by held-out images through the window: 0."));
    CHECK(mentions(r.out, "Lens: opencv, "));
}

TEST_CASE("refract_calib ends with 2 if a limit is not met, and still writes the file", "[calib_tool]")
{
    const TemporaryFolder f;
    writeScene(f, {}, 103);
    const ToolResult rms = runTool(inputs(f, PANE + lens(f) + " --max-rms=0.01"));
    CHECK(rms.code == 2);
    CHECK(mentions(rms.err, "--max-rms"));
    CHECK(std::filesystem::exists(f / "calib.yml"));
    const ToolResult normal = runTool(inputs(f, PANE + lens(f) + " --max-normal-std=0.001 --quiet"));
    CHECK(normal.code == 2);
    CHECK(mentions(normal.err, "--max-normal-std"));
    CHECK(normal.out.empty());
    CHECK(runTool(inputs(f, PANE + lens(f) + " --max-rms=0.2 --max-normal-std=0.1")).code == 0);
}

TEST_CASE("refract_calib is not plainly good if no board could check the +-", "[calib_tool]")
{
    const TemporaryFolder f;
    const struct { int pairs; std::string options, why; } cases[] = {
        {10, " --lens=opencv4", ""},
        {10, lens(f), "below the noise of the pixels"},     // with a known lens ten pairs leave little to see
        {10, lens(f) + " --no-cross-validation", "with --no-cross-validation all boards took part"}};
    for (const auto& c : cases)
    {
        SceneOptions options;
        options.views = c.pairs;
        writeScene(f, options, 117);
        const ToolResult r = runTool(inputs(f, PANE + c.options + " --summary=" + f / "summary.json"));
        INFO(r.out << r.err);
        REQUIRE(r.code == 0);
        const nlohmann::json json = nlohmann::json::parse(readFile(f / "summary.json"));
        CHECK(json["not_checked"].is_null() == c.why.empty());
        if (c.why.empty())
        {
            CHECK(json["held_out"]["error_over_stated"].is_number());
            continue;
        }
        CHECK(mentions(json["not_checked"], c.why));
        CHECK(mentions(json["verdict"], "Good, but not checked: "));
        CHECK(mentions(json["verdict"], c.why));
        CHECK(mentions(r.out, "whether the stated +- is true: "));
    }
}

TEST_CASE("refract_calib says what glass-only views cannot tell", "[calib_tool]")
{
    const TemporaryFolder f;
    writeScene(f, {}, 104);
    const ToolResult r = runTool(inputs(f, PANE + lens(f), false));
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    CHECK(mentions(r.out, "30 to 90 times"));
    const FileStorage file(f / "calib.yml", FileStorage::READ);
    std::vector<double> std;
    file["glass_window_std"]["normal_deg"] >> std;
    CHECK(std[0] > 0.2);                                // physics: 0.5

    // Equal names that mean nothing are glass-only views too.
    const ToolResult unpaired = runTool(inputs(f, std::string(PANE) + " --unpaired --lens=opencv4"));
    INFO(unpaired.out << unpaired.err);
    CHECK(unpaired.code == 0);
    CHECK(mentions(unpaired.out, "30 to 90 times"));
}

TEST_CASE("refract_calib tells of a second solution that fits as well, and not with pairs", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.views = 1;
    const std::string summary = " --no-cross-validation --no-robust --summary=" + f / "summary.json";
    ToolResult r{-1, "", ""};
    for (unsigned salt = 119; salt < 139 && !mentions(r.out, "a second solution"); salt++)     // not every board has one
    {
        writeScene(f, options, salt);
        r = runTool(inputs(f, PANE + lens(f) + summary, false));
    }
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    CHECK(mentions(r.out, "a second solution fits nearly as well: normal ("));
    CHECK(mentions(r.out, "second solution: normal; RMS, px"));
    const nlohmann::json camera = nlohmann::json::parse(readFile(f / "summary.json"))["cameras"][0];
    const nlohmann::json second = camera["window"]["second_solution"];
    REQUIRE(second.is_object());
    CHECK(second["excluded"] == false);
    CHECK(second["standard_deviations_worse"].get<double>() < 3);

    // What it says is so: with the window tilted that way, the best poses leave this RMS.
    GlassWindow window = RefractiveCamera::read(f / "calib.yml")->window();
    const Vec3d found = window.normal;
    for (int i = 0; i < 3; i++)
        window.normal[i] = second["normal"][i].get<double>();
    window.normal = normalize(window.normal);       // six digits
    CHECK(degreesBetween(window.normal, found) > 0.5);
    const double there = rmsThrough(f, window), here = rmsThrough(f, RefractiveCamera::read(f / "calib.yml")->window());
    CHECK(second["rms_px"].get<double>() == Approx(there).epsilon(1e-3));
    CHECK(camera["rms_px"]["glass"].get<double>() == Approx(here).epsilon(1e-3));
    CHECK(there >= here);

    const ToolResult paired = runTool(inputs(f, PANE + lens(f) + summary));
    INFO(paired.out << paired.err);
    REQUIRE(paired.code == 0);
    CHECK_FALSE(mentions(paired.out, "second solution"));
    CHECK(nlohmann::json::parse(readFile(f / "summary.json"))["cameras"][0]["window"]["second_solution"].is_null());
}

TEST_CASE("refract_calib warns that thickness and index are tied", "[calib_tool]")
{
    const TemporaryFolder f;
    writeScene(f, {}, 105);
    const ToolResult r = runTool(inputs(f, PANE + lens(f) + " --free=thickness,index"));
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    CHECK(mentions(r.out, "thickness and index apart: only thickness x (1 - 1/index) = "));
}

TEST_CASE("refract_calib finds the distance of a water surface", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.window = [](int) {
        GlassWindow water;
        water.normal = normalize(Vec3d(0.05, -0.08, 1));
        water.outerIndex = 1.333;
        water.distance = 150.;
        return water;
    };
    writeScene(f, options, 106);
    const ToolResult r = runTool(inputs(f, " --outer-index=1.333" + lens(f)));     // not given, so estimated
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    const GlassWindow window = RefractiveCamera::read(f / "calib.yml")->window();
    CHECK(window.distance == Approx(150.).margin(1.));
    CHECK(degreesBetween(window.normal, normalize(Vec3d(0.05, -0.08, 1))) < 0.1);
}

TEST_CASE("Floats on the water's surface tell refract_calib its normal and distance; wrong ones are named", "[calib_tool]")
{
    const TemporaryFolder f;
    const Vec3d normal = normalize(Vec3d(0.05, -0.08, 1));
    SceneOptions options;
    options.window = [&](int) {
        GlassWindow water;
        water.normal = normal;
        water.outerIndex = 1.333;
        water.distance = 150.;
        return water;
    };
    writeScene(f, options, 106);
    const auto floats = [&](double distance, double std) {
        scenes::Random random(4560);
        const Vec3d x = normalize(normal.cross(Vec3d(0, 1, 0))), y = normal.cross(x);
        std::ofstream table(f / "floats.csv");
        table << "id,x,y,z\n";
        for (int i = 0; i < 6; i++)
        {
            const Vec3d X = distance*normal + (30. + 40*(i % 3))*x + 40.*(i/3)*y;
            table << format("%d,%.6f,%.6f,%.6f\n", i, X[0] + random.normal(std), X[1] + random.normal(std), X[2] + random.normal(std));
        }
        return " --outer-index=1.333" + lens(f) + " --pane-points=" + f / "floats.csv" + format(" --pane-points-std=%g", std);
    };
    const auto distanceStd = [&] { return (double)FileStorage(f / "calib.yml", FileStorage::READ)["glass_window_std"]["distance"]; };
    const ToolResult alone = runTool(inputs(f, " --outer-index=1.333" + lens(f)));
    REQUIRE(alone.code == 0);
    const double loose = distanceStd();
    const ToolResult r = runTool(inputs(f, floats(150, 0.02) + " --distance-std=0 --verbose"));
    INFO(scenes::seed() << r.out << r.err);
    REQUIRE(r.code == 0);
    const GlassWindow window = RefractiveCamera::read(f / "calib.yml")->window();
    const double known = distanceStd();
    CHECK(known < 0.7*loose);
    CHECK(std::abs(window.distance - 150.) < 4*known);
    CHECK(degreesBetween(window.normal, normal) < 0.05);
    CHECK(mentions(r.out, "  --pane-points"));

    CHECK_FALSE(mentions(r.out, "the distance, 0"));
    for (double distance : {153., 170.})        // there are images that such a distance cannot have
    {
        const ToolResult wrong = runTool(inputs(f, floats(distance, 0.02) + " --distance-std=0"));
        INFO(distance << wrong.out << wrong.err);
        CHECK(wrong.code == (distance < 160. ? 2 : 1));
        CHECK(mentions(wrong.err, "the images contradict --pane-points: set free, the window would be turned by"));
        CHECK(mentions(wrong.err, format("away and not %g", distance)));
    }
    CHECK(mentions(runTool(inputs(f, floats(150, 0.02) + " --distance=150")).err, "--distance"));
    CHECK(mentions(runTool(inputs(f, floats(150, 0.02) + " --free=distance")).err, "leave one out"));
}

TEST_CASE("The file of a lens serves for two cameras that have one like it", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.stereo = true;
    writeScene(f, options, 120);
    // Not the lens of camera 2: the images say so, and the file is not what is refused.
    const ToolResult r = runTool(stereoInputs(f, PANE + lens(f) + " --camera2=" + f / "camera1.yml"));
    INFO(r.out << r.err);
    CHECK_FALSE(mentions(r.err, "holds no camera"));
    CHECK(mentions(r.err, "the images contradict --camera2"));
    CHECK(mentions(r.out + r.err, "is also that of camera 1"));
}

TEST_CASE("A forgotten medium is named, of one camera too", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.window = [](int) { return GlassWindow(normalize(Vec3d(0.15, -0.1, 1)), 20., 1.5437, 60., 1.333); };
    writeScene(f, options, 119);
    const std::string more = std::string(PANE) + " --distance=60 --no-cross-validation --lens=opencv4 --unpaired";
    const ToolResult forgotten = runTool(inputs(f, more)), said = runTool(inputs(f, more + " --outer-index=1.333"));
    INFO(forgotten.out << forgotten.err << said.out << said.err);
    CHECK(forgotten.code == 1);
    CHECK(mentions(forgotten.err, "px with --outer-index=1.333 in place of 1 (the medium in which the board was)"));
    CHECK(said.code == 0);
}

TEST_CASE("refract_calib calibrates a stereo rig with a window for each camera", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.stereo = true;
    writeScene(f, options, 107);
    const ToolResult r = runTool(stereoInputs(f, PANE + lens(f) + " --camera2=" + f / "camera2.yml"));
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    const FileStorage file(f / "calib.yml", FileStorage::READ);
    Mat R, T, rvec;
    file["R"] >> R;
    file["T"] >> T;
    Rodrigues(R, rvec);
    CHECK(norm(rvec, Mat(PaperRig().rvec)) < 1e-3);
    CHECK(norm(T.reshape(1, 3), Mat(PaperRig().T)) < 0.3);
    for (int c = 0; c < 2; c++)
    {
        const Ptr<RefractiveCamera> camera = RefractiveCamera::read(f / "calib.yml", format("camera%d", c + 1));
        CHECK(degreesBetween(camera->window().normal, PaperRig().normal[c]) < 0.06);
    }
}

TEST_CASE("refract_calib calibrates two cameras behind one pane", "[calib_tool]")
{
    const TemporaryFolder f;
    const PaperRig rig;
    Matx33d R;
    Rodrigues(rig.rvec, R);
    SceneOptions options;
    options.stereo = true;
    options.window = [&](int c) {       // the same plane, seen from camera 2
        GlassWindow window(rig.normal[0], 20., 1.5437, 100.);
        if (c == 1)
        {
            window.normal = R*rig.normal[0];
            window.distance = 100. + window.normal.dot(rig.T);
        }
        return window;
    };
    writeScene(f, options, 108);
    const ToolResult r = runTool(stereoInputs(f, PANE + lens(f) + " --camera2=" + f / "camera2.yml"
                                                 + " --shared-window --distance=100"));
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    for (int c = 0; c < 2; c++)
    {
        const Ptr<RefractiveCamera> camera = RefractiveCamera::read(f / "calib.yml", format("camera%d", c + 1));
        CHECK(degreesBetween(camera->window().normal, options.window(c).normal) < 0.06);
        CHECK(camera->window().distance == Approx(options.window(c).distance).margin(1.));
    }
}

TEST_CASE("refract_calib refines the lens with --free=intrinsics", "[calib_tool]")
{
    CHECK(focalLengthOf({}, 109, " --free=intrinsics") == Approx(2438.).epsilon(0.005));
}

TEST_CASE("refract_calib says that the images contradict a wrong thickness, and which would be right", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.views = 14;
    writeScene(f, options, 112);
    const ToolResult far = runTool(inputs(f, " --thickness=40 --index=1.5437" + lens(f)));
    INFO(far.out << far.err);
    CHECK(far.code == 1);
    CHECK(mentions(far.err, "contradict --thickness=40: set free, the thickness would be 20.0"));
    const ToolResult liquid = runTool(inputs(f, " --thickness=20 --index=water --no-cross-validation" + lens(f)));
    INFO(liquid.out << liquid.err);
    CHECK(liquid.code != 0);
    CHECK(mentions(liquid.out + liquid.err, "--index=water: the window has the index 1.334, as a liquid"));
    for (const std::string wrong : {"19", "22", "26"})
        for (const std::string more : {" --lens=opencv4 --max-error-at=600:5", " --max-rms=50", " --no-robust"})
        {
            const ToolResult r = runTool(inputs(f, " --thickness=" + wrong + " --index=1.5437" + more
                                                   + (more == " --max-rms=50" ? lens(f) : "")));
            INFO(wrong << more << "\n" << r.out << r.err);
            CHECK(r.code == 2);
            CHECK(mentions(r.err, "contradict --thickness=" + wrong));
            CHECK(mentions(r.err, "thickness would be 20.0"));
            CHECK(mentions(r.out, more == " --no-robust" ? "Not usable" : "FAIL"));
            CHECK_FALSE(mentions(r.out, "Good"));
            CHECK_FALSE(mentions(r.out, "take pairs"));
        }
    // Known to 0.05, it would have to be twenty of these away.
    const ToolResult known = runTool(inputs(f, " --thickness=19 --thickness-std=0.05 --index=1.5437 --lens=opencv4"));
    INFO(known.out << known.err);
    CHECK(known.code == 2);
    CHECK(mentions(known.err, "contradict --thickness=19 +- 0.05: set free, the thickness would be 20.0"));
    const ToolResult within = runTool(inputs(f, " --thickness=19.9 --thickness-std=0.1 --wedge-std=1 --placement-std=0.01 --index=1.5437 "
                                                "--lens=opencv4"));
    INFO(within.out << within.err);
    CHECK(within.code == 0);
    CHECK_FALSE(mentions(within.out, "contradict"));
    CHECK_THAT(within.out, Catch::Matches("[^]*boards moved between direct and glass +0\\.01 mm [^]*"));
    // Whoever uses what came of it is told.
    runTool(inputs(f, " --thickness=26 --index=1.5437 --no-robust"));
    const std::string use = "refract_export " + f / "calib.yml" + " --to=opencv --depth=400,900 --out=" + f / "central.yml";
    const ToolResult user = runTool(use);
    INFO(user.out << user.err);
    CHECK(user.code == 0);
    CHECK(mentions(user.err, "not usable"));
    CHECK(mentions(user.err, "contradict --thickness=26"));
    const ToolResult right = runTool(inputs(f, std::string(PANE) + " --lens=opencv4"));
    INFO(right.out << right.err);
    CHECK(right.code == 0);
    CHECK(runTool(use).err.empty());
    CHECK_FALSE(mentions(right.out, "contradict"));
    CHECK(mentions(right.out, "refined"));
}

namespace {

//! What cannot be done, and a part of the one sentence that says so.
struct Refusal { std::string command, says; };

void checkRefusal(const Refusal& refusal)
{
    const ToolResult r = runTool(refusal.command);
    INFO(refusal.command << "\n" << r.out << r.err);
    CHECK(r.code == 1);
    CHECK(mentions(r.err, refusal.says));
    CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
}

} // namespace

TEST_CASE("refract_calib ends with 1 and the likely mistake if nothing fits", "[calib_tool][slow]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.views = 14;
    writeScene(f, options, 121);
    const std::string images = " --direct=" + f / "direct1.vnl" + " --glass=" + f / "glass1.vnl";
    const std::string out = " --out=" + f / "calib.yml", board = "refract_calib --size=6x5 --image-size=1280x1024", known = lens(f);
    const Refusal cases[] = {
        {board + " --square=3.9" + images + PANE + known + out, "in place of 3.9"},
        {board + " --square=39" + images + PANE + known + out + " --outer-index=1.333", "--outer-index=1 in place of 1.333"},
        {board + " --square=39 --direct=" + f / "glass1.vnl" + " --glass=" + f / "direct1.vnl" + PANE + known + out, "exchanged"},
        {board + " --square=39" + images + " --thickness=2 --index=1.5437 --exact" + known + out + " --no-robust", "in place of 2,"},
        {board + " --square=39 --direct=" + f / "direct1.vnl" + " --glass=" + f / "other.vnl" + PANE + known + out, "--unpaired"},
        {board + " --square=39 --direct=" + f / "direct1.vnl" + " --glass=" + f / "direct1.vnl" + PANE + known + out,
         "in the very pixels"},
    };
    const std::string glass = readFile(f / "glass1.vnl");       // under other names
    std::string other;
    for (char c : glass)
        other += c == 'v' ? 'w' : c;
    std::ofstream(f / "other.vnl") << other;
    // Only the ratio of the two shows.
    const ToolResult thin = runTool(board + " --square=39" + images + " --thickness=2 --index=1.5437" + known + " --no-robust --out="
                                    + f / "thin.yml");
    INFO(thin.out << thin.err);
    CHECK(thin.code == 1);
    CHECK(mentions(thin.err, "--thickness=20 in place of 2,"));
    CHECK(mentions(thin.err, "--square=3.9 in place of 39"));
    const size_t before = f.count();
    for (const Refusal& c : cases)
    {
        checkRefusal(c);
        CHECK(f.count() == before);
    }
}

TEST_CASE("refract_calib refuses with one sentence and writes nothing", "[calib_tool]")
{
    const TemporaryFolder f;
    writeScene(f, {}, 110);
    std::ofstream(f / "empty.vnl");
    std::ofstream(f / "random.yml") << "\x01\x02 this is no calibration";
    std::ofstream(f / "cut.png") << "\x89PNG\r\n";
    const size_t before = f.count();
    const Refusal cases[] = {
        {"refract_calib", "--glass"},
        {inputs(f, lens(f)), "--thickness"},
        {inputs(f, PANE + lens(f) + " --free=distance"), "no effect"},
        {inputs(f, lens(f) + " --thickness=20"), "--index"},
        {inputs(f, lens(f) + " --thickness=20,5 --index=1.5"), "--index"},
        {inputs(f, lens(f) + " --thickness=-20 --index=1.5"), "thickness"},
        {inputs(f, lens(f) + " --thickness=20 --index=0.5"), "index"},
        {inputs(f, lens(f) + " --thickness=x --index=1.5"), "--thickness"},
        {inputs(f, lens(f) + " --thickness=0 --index=1.5"), "leave --thickness and --index out"},
        {inputs(f, lens(f) + " --thickness=20 --index=1"), "that is air"},
        {inputs(f, lens(f) + " --thickness=20 --index=15.4"), "no material has the index 15.4"},
        {inputs(f, lens(f) + PANE + " --outer-index=13.3"), "--outer-index=13.3: no medium"},
        {inputs(f, lens(f) + PANE + " --outer-index=0.9"), "--outer-index=0.9: no medium"},
        {inputs(f, lens(f) + " --thickness=20 --index=N-BK8"), "--index=N-BK8: material is 'N-BK8', which is not known; "
            "nearest is 'N-BK7'"},
        {inputs(f, lens(f) + " --thickness=20 --index=diamond"), "'diamond', which is not known; those that are: N-BK7, K9, B270, "
            "soda-lime, borosilicate, fused-silica, sapphire, PMMA, polycarbonate, water, seawater, air; of any other give the index"},
        {inputs(f, lens(f) + " --thickness=20 --index=N-BK7 --wavelength=200"), "--wavelength=200: the index of N-BK7 is known "
            "from 300 to 2500 nm; wavelengthNm is 200; give nm"},
        {inputs(f, lens(f) + " --thickness=20 --index=1,5"), "--thickness has 1, --index 2"},
        {inputs(f, lens(f) + " --thickness=20 --index=water:T=12"), "without parameters"},
        {inputs(f, lens(f) + PANE + " --outer-index=seawater:T=99"), "T of seawater must be from 0 to 30"},
        {inputs(f, lens(f) + PANE + " --outer-index=1.3,1.4"), "give one number"},
        {inputs(f, lens(f) + PANE + " --wavelength=550"), "no material is named"},
        {inputs(f, lens(f) + PANE + " --free=colour"), "--free"},
        {inputs(f, lens(f) + " --outer-index=1.333 --free=thickness"), "--free=thickness"},
        {inputs(f, std::string(PANE), false), "--direct"},
        {inputs(f, PANE + std::string(" --camera=") + f / "random.yml"), "random.yml"},
        {inputs(f, PANE + std::string(" --camera=") + f / "none.yml"), "none.yml"},
        {inputs(f, PANE + lens(f) + " --direct2=" + f / "direct1.vnl"), "--glass2"},
        {inputs(f, PANE + lens(f) + " --shared-window"), "--glass2"},
        {inputs(f, PANE + lens(f) + " --partial"), "--unpaired"},
        {inputs(f, PANE + lens(f) + " --lens=fisheye"), "--lens=fisheye is for a lens that the images determine"},
        {inputs(f, PANE + lens(f) + " --thickness-std=inf"), "--thickness-std"},
        {inputs(f, PANE + lens(f) + " --wedge-std=-1"), "--wedge-std"},
        {inputs(f, PANE + lens(f) + " --distance-std=1"), "--distance-std: with the same medium"},
        {inputs(f, PANE + lens(f) + " --outer-index=1.333 --distance-std=1"), "add --distance"},
        {inputs(f, lens(f) + " --outer-index=1.333 --wedge-std=1"), "give --thickness and --index"},
        {inputs(f, PANE + lens(f) + " --free=distance"), "or say what the target was in"},
        {inputs(f, PANE + lens(f) + " --note=a=b --note=a=c"), "another note 'a'"},
        {"refract_calib --size=6x5 --square=39 --glass=" + f / "none-*.png" + " --out=" + f / "calib.yml" + PANE, "none-"},
        {"refract_calib --size=6x5 --square=39 --glass=" + f / "cut.png" + " --out=" + f / "calib.yml" + PANE, "cut.png"},
        {"refract_calib --size=6x5 --square=39 --glass=" + f / "glass1.vnl" + " --out=" + f / "calib.yml" + PANE, "--image-size"},
        {std::string("refract_calib") + TARGET + " --glass=" + f / "empty.vnl" + " --out=" + f / "calib.yml" + PANE, "empty.vnl"},
        {std::string("refract_calib --size=7x5 --square=39 --image-size=1280x1024 --glass=") + f / "glass1.vnl" + " --out="
            + f / "calib.yml" + PANE + lens(f), "glass1.vnl"},
        {std::string("refract_calib --size=6x5 --square=39 --image-size=640x480 --glass=") + f / "glass1.vnl" + " --out="
            + f / "calib.yml" + PANE + lens(f), "outside of an image of 640x480"},
    };
    for (const Refusal& c : cases)
    {
        checkRefusal(c);
        CHECK(f.count() == before);
    }
    const ToolResult r = runTool("refract_calib" + std::string(TARGET) + " --direct=" + f / "direct1.vnl" + " --glass="
                                 + f / "glass1.vnl" + PANE + lens(f) + " --out=" + f / "no/folder/calib.yml");
    CHECK(r.code == 1);
    CHECK(mentions(r.err, "no/folder"));
}

TEST_CASE("refract_calib says that direct and glass images are swapped, or no pairs", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.views = 6;
    writeScene(f, options, 113);
    const std::string out = PANE + lens(f) + " --out=" + f / "calib.yml";
    const ToolResult swapped = runTool("refract_calib" + std::string(TARGET) + " --direct=" + f / "glass1.vnl" + " --glass="
                                       + f / "direct1.vnl" + out);
    INFO(swapped.err);
    CHECK(swapped.code == 1);
    CHECK(mentions(swapped.err, "--direct and --glass exchanged"));

    const TemporaryFolder other;
    writeScene(other, options, 114);
    const ToolResult moved = runTool("refract_calib" + std::string(TARGET) + " --direct=" + other / "direct1.vnl" + " --glass="
                                     + f / "glass1.vnl" + " --no-robust" + out);
    INFO(moved.err);
    CHECK(moved.code == 1);
    CHECK(mentions(moved.err, "are not one place of the board"));
    CHECK(mentions(moved.err, "--unpaired"));
    CHECK(f.count() == 6);
}

//! What stands beside a picture's scale of colours: the texts right of the image.
static std::vector<std::string> colourTicks(const std::string& figure)
{
    const double RIGHT = 480.;
    std::vector<std::string> ticks;
    const std::string place = "translate(", before = "<text>";
    for (size_t at = figure.find(place); at != std::string::npos; at = figure.find(place, at + 1))
    {
        const size_t text = figure.find(before, at) + before.size();
        if (std::stod(figure.substr(at + place.size())) > RIGHT)
            ticks.push_back(figure.substr(text, figure.find('<', text) - text));
    }
    return ticks;
}

TEST_CASE("refract_calib's report is one self-contained page", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.views = 6;
    writeScene(f, options, 111);
    const ToolResult without = runTool(inputs(f, PANE + lens(f) + " --report=" + f / "report.html"), "PATH=/nonexistent");
    CHECK(without.code == 1);
    CHECK(mentions(without.err, "gnuplot-nox"));
    CHECK_FALSE(std::filesystem::exists(f / "calib.yml"));

    if (std::system("command -v gnuplot >/dev/null 2>&1") != 0)
    {
        WARN("SKIPPED: gnuplot is not installed");
        return;
    }
    const std::string command = inputs(f, PANE + lens(f) + " --report=" + f / "report.html");
    CHECK(mentions(runTool(command, "TMPDIR=/nonexistent").err, "TMPDIR is '/nonexistent'; make it"));
    const ToolResult r = runTool(command);
    INFO(r.err);
    REQUIRE(r.code == 0);
    const std::string page = readFile(f / "report.html");
    CHECK(mentions(page, "</html>"));
    CHECK(mentions(page, "What the data cannot tell"));
    CHECK(mentions(page, "--thickness=20"));
    size_t pictures = 0;
    for (size_t at = page.find("<svg"); at != std::string::npos; at = page.find("<svg", at + 1))
        pictures++;
    // 6 of the camera, one of the error over the range and one for each of the six ranges.
    CHECK(pictures == 13);
    // The first page on paper has the verdict, the error of a point, the given values and the next step.
    const size_t begin = page.find("<section class=\"first_page\">"), end = page.find("<h2>");
    REQUIRE(begin < end);
    const std::string first = page.substr(begin, end - begin);
    for (const char* part : {"Good, but not checked", "Expected error of a measured point", "<td>20 mm</td>", "<td>1.5437</td>",
                             "<td>exact</td>", "What to do next", "Newest of its images and files: 2"})
        CHECK(mentions(first, part));
    CHECK(mentions(page, "@page { size: A4"));
    CHECK(mentions(page, ".first_page { break-after: page; }"));
    CHECK(mentions(page, "The same input gives the same page, so it has no time of its making"));
    for (const char* axis : {"u, px", "v, px", "z, away from the camera, mm", "x, to the right, mm", "y, downwards, mm", "RMS, px",
                             "view (name of its images)", "turn of the normal, deg", "expected error, mm", "z from camera 1, mm"})
        CHECK(mentions(page, axis));
    // One scale of colours: the ticks of all maps of the expected error are the same.
    std::set<std::vector<std::string>> scales;
    for (size_t at = page.find("<h3>Expected error at z"); at != std::string::npos; at = page.find("<h3>Expected error at z", at + 1))
        scales.insert(colourTicks(page.substr(at, page.find("</figure>", at) - at)));
    CHECK(scales.size() == 1);
    for (const char* outside : {"src=\"http", "href=\"http", "<script", "url(http", "@import", "{{"})
        CHECK_FALSE(mentions(page, outside));
}

TEST_CASE("refract_calib's report shows the images with their points", "[calib_tool]")
{
    if (std::system("command -v gnuplot >/dev/null 2>&1") != 0)
    {
        WARN("SKIPPED: gnuplot is not installed");
        return;
    }
    const TemporaryFolder f;
    const std::string data = paths::bundled() + "/stereo";
    const ToolResult r = runTool("refract_calib --size=6x5 --square=39 --direct='" + data + "/direct1/*.jpg' --glass='" + data
        + "/glass1/*.jpg'" + PANE + " --no-cross-validation --verbose --out=" + f / "calib.yml" + " --report=" + f / "report.html");
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    CHECK(mentions(r.out, "lens coefficients left out"));       // a row of the budget: the choice is not exact
    const std::string page = readFile(f / "report.html");
    size_t photos = 0;
    for (size_t at = page.find("src=\"data:image/jpeg;base64,/9j/"); at != std::string::npos;
         at = page.find("src=\"data:image/jpeg;base64,/9j/", at + 1))
        photos++;
    CHECK(photos == 24);
    CHECK(mentions(page, "pair1, through the window: 30 points"));
    CHECK(mentions(page, "</b> up to 0.0"));
    CHECK(mentions(page, "<details"));
    CHECK_FALSE(mentions(page, " nan "));

    // Nothing that a terminal of 100 columns would break; the sentences below the tables may be longer.
    std::istringstream lines(r.out);
    for (std::string line; std::getline(lines, line) && line.compare(0, 8, "RMS over") != 0; )
        CHECK(line.size() <= 100);
    CHECK(mentions(r.out, "z = 490.7 mm"));
    CHECK(mentions(r.out, "boards moved between direct and glass"));
}

TEST_CASE("refract_calib's summary says for machines what the table says, with the caller's labels", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.stereo = true;
    writeScene(f, options, 113);
    const ToolResult r = runTool(stereoInputs(f, PANE + lens(f) + " --camera2=" + f / "camera2.yml" + " --summary="
        + f / "summary.json" + " --max-rms=0.2 --max-error-at=600:0.5 --max-error-at=600:0.001 --serial='W 7'"
        + " --note=customer='Tunnel & Sons' --note=shift=2"));
    INFO(r.out << r.err);
    REQUIRE(r.code == 2);
    CHECK(mentions(r.err, "--max-error-at=600:0.001"));
    CHECK_FALSE(mentions(r.err, "--max-rms"));
    CHECK(r.out.compare(0, 5, "FAIL\n") == 0);
    CHECK(mentions(r.out, "On boards that took no part"));
    CHECK(mentions(r.out, "What the next images would bring"));

    const nlohmann::json json = nlohmann::json::parse(readFile(f / "summary.json"));
    CHECK(json["verdict"] == "FAIL");
    CHECK(json["window_serial"] == "W 7");
    CHECK(json["notes"]["customer"] == "Tunnel & Sons");
    REQUIRE(json["limits"].size() == 3);
    CHECK(json["limits"][0]["met"] == true);
    CHECK(json["limits"][1]["met"] == true);
    CHECK(json["limits"][2]["met"] == false);
    REQUIRE(json["cameras"].size() == 2);
    CHECK(json["cameras"][0]["window"]["normal_std_deg"][0].get<double>() < 0.05);
    // Noise of 0.1 px a coordinate is 0.141 px RMS; a pose is fitted to each board, so a little less.
    CHECK(json["held_out"]["rms_px"].get<double>() == Approx(0.135).epsilon(0.1));
    CHECK(json["held_out"]["views_without_result"] == 0);
    CHECK(json["held_out"]["length_rms"].get<double>() < 0.1);
    CHECK(json["fit"]["sigma_px"].get<double>() == Approx(SIGMA).epsilon(0.1));
    // The worst point of now, in the range of the boards, is the worst of the table.
    double worst = 0.;
    for (int i : {1, 3})
        worst = std::max(worst, json["point_error"][i]["worst"].get<double>());
    CHECK(json["next_images"]["now"]["worst_point_error"].get<double>() == worst);
    // What is predicted is better than what is, and a pair better than one image of it.
    const auto worth = [](const nlohmann::json& w) { return w["calibration_part"].get<double>(); };
    const nlohmann::json& next = json["next_images"];
    REQUIRE(next["pairs"].size() == 3);
    CHECK(worth(next["pairs"][0]["predicted"]) < worth(next["now"]));
    CHECK(worth(next["pairs"][1]["predicted"]) < worth(next["pairs"][0]["predicted"]));
    for (const auto& other : next["instead_of_the_first"])
        CHECK(worth(other["predicted"]) > worth(next["pairs"][0]["predicted"]));

    const FileStorage file(f / "calib.yml", FileStorage::READ);
    CHECK((std::string)file["window_serial"] == "W 7");
    CHECK((std::string)file["notes"]["customer"] == "Tunnel & Sons");
    CHECK((double)file["residual_sigma"] == Approx(SIGMA).epsilon(0.1));
    CHECK((double)file["degrees_of_freedom"] > 1000);

    for (const char* wrong : {" --max-error-at=600", " --max-error-at=0:1", " --note=customer", " --note=1st=x"})
    {
        const ToolResult refused = runTool(inputs(f, PANE + lens(f) + wrong));
        INFO(wrong << refused.err);
        CHECK(refused.code == 1);
        CHECK(mentions(refused.err, std::string(wrong).substr(1, 6)));
    }
}

TEST_CASE("A focal length that is far from the images' is named", "[calib_tool][mistakes]")
{
    const TemporaryFolder f;
    writeScene(f, SceneOptions(), 117);
    for (const char* wrong : {"24380.7", "243.807", "8.4"})         // a decimal point elsewhere; millimetres
        for (bool paired : {true, false})
        {
            FileStorage camera(f / "wrong.yml", FileStorage::WRITE);
            Mat K = PaperRig().K[0].clone();
            K.at<double>(0, 0) = K.at<double>(1, 1) = std::stod(wrong);
            camera << "camera_matrix" << K << "distortion_coefficients" << PaperRig().dist << "image_width" << IMAGE.width
                   << "image_height" << IMAGE.height;
            camera.release();
            const std::string more = PANE + std::string(paired ? "" : " --unpaired") + " --camera=" + f / "wrong.yml";
            const ToolResult r = runTool(brief(f, more, paired));
            CAPTURE(wrong, paired, r.out, r.err);
            CHECK(r.code == 1);
            const bool isFreed = mentions(r.err, "contradict --camera: set free, the focal length would be ");
            CHECK((isFreed || mentions(r.err, std::string(" px in place of ") + wrong)));
            CHECK_FALSE(mentions(r.err, "--square"));
        }
}

TEST_CASE("refract_calib leaves wrong points and moved boards out, and names them", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.views = 12;
    options.wrong = 0.1;
    writeScene(f, options, 116);
    const ToolResult robust = runTool(inputs(f, PANE + lens(f) + " --no-cross-validation --summary=" + f / "summary.json"));
    INFO(robust.out << robust.err);
    REQUIRE(robust.code == 0);
    CHECK(degreesBetween(RefractiveCamera::read(f / "calib.yml")->window().normal, PaperRig().normal[0]) < 0.06);
    CHECK(mentions(robust.out, "Left out:"));
    const nlohmann::json json = nlohmann::json::parse(readFile(f / "summary.json"));
    CHECK(json["left_out"].size() > 10);
    CHECK(json["fit"]["sigma_px"].get<double>() == Approx(SIGMA).epsilon(0.15));

    const ToolResult plain = runTool(inputs(f, PANE + lens(f) + " --no-cross-validation --no-robust"));
    INFO(plain.out << plain.err);
    CHECK(plain.code == 0);
    CHECK_FALSE(mentions(plain.out, "Left out:"));
    CHECK(degreesBetween(RefractiveCamera::read(f / "calib.yml")->window().normal, PaperRig().normal[0]) > 0.06);
}

TEST_CASE("refract_calib writes the same bytes for the same input", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.stereo = true;
    options.views = 5;
    writeScene(f, options, 114);
    const bool gnuplot = std::system("command -v gnuplot >/dev/null 2>&1") == 0;
    const std::vector<std::string> names = gnuplot ? std::vector<std::string>{"calib.yml", "summary.json", "report.html"}
                                                   : std::vector<std::string>{"calib.yml", "summary.json"};
    std::vector<std::string> first;
    for (int run = 0; run < 2; run++)
    {
        const ToolResult r = runTool(stereoInputs(f, PANE + lens(f) + " --camera2=" + f / "camera2.yml" + " --quiet --summary="
            + f / "summary.json" + (gnuplot ? " --report=" + f / "report.html" : "")));
        INFO(r.err);
        REQUIRE(r.code == 0);
        for (size_t i = 0; i < names.size(); i++)
        {
            const std::string bytes = readFile(f/names[i]);
            CAPTURE(names[i]);
            if (run == 0)
                first.push_back(bytes);
            else
                CHECK(bytes == first[i]);
        }
    }
}

TEST_CASE("refract_calib says which combination of thickness and index is determined", "[calib_tool]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.views = 20;
    writeScene(f, options, 115);
    const ToolResult r = runTool(inputs(f, PANE + lens(f) + " --free=thickness,index --no-cross-validation"));
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    const size_t at = r.out.find("only thickness x (1 - 1/index) = ");
    REQUIRE(at != std::string::npos);
    double value = 0., std = 0.;
    REQUIRE(std::sscanf(r.out.c_str() + at, "only thickness x (1 - 1/index) = %lf +- %lf", &value, &std) == 2);
    CHECK(std < 0.1);
    CHECK(std::abs(value - 20*(1 - 1/1.5437)) < 4*std);
    CHECK_FALSE(mentions(r.out, "took no part"));
}

TEST_CASE("refract_calib on real images in air and water", "[calib_tool][real]")
{
    const std::string data = paths::data() + "/ouc_laser3d";
    if (!std::filesystem::exists(data))
    {
        WARN("SKIPPED: " << data << " is absent");
        return;
    }
    const TemporaryFolder f;
    const ToolResult r = runTool("refract_calib --size=8x7 --partial --square=33.8 --direct='" + data + "/air/*.png' "
        "--glass='" + data + "/water/*.png' --unpaired --outer-index=1.333 --free=distance --max-rms=0.30 --out="
        + f / "calib.yml");
    INFO(r.out << r.err);
    CHECK(r.code == 0);
    const double rms = (double)FileStorage(f / "calib.yml", FileStorage::READ)["rms"];
    std::cout << "[numbers] ouc_laser3d, water surface fitted to the water images: RMS " << rms << " px\n";
    CHECK(rms < 0.30);
}

TEST_CASE("In air, too, a wedge tells where the window is, and nobody need know it", "[tools][calib][wedge]")
{
    const double MINUTE = CV_PI/180/60;
    const TemporaryFolder f;
    SceneOptions options;
    options.window = [=](int camera) {
        GlassWindow window = PaperRig().window(camera);
        window.distance = 250;
        window.wedge = {Vec2d(3*MINUTE, -MINUTE)};
        return window; };
    const Vec3d normal = options.window(0).normal;
    for (unsigned salt : {211, 212, 213})
    {
        writeScene(f, options, salt);
        const auto deviationsOff = [&](const std::string& more) {
            const ToolResult r = runTool(brief(f, PANE + lens(f) + " --wedge-std=3 --no-cross-validation" + more));
            CAPTURE(r.err);
            CHECK(r.code == 0);
            const FileStorage fs(f / "calib.yml", FileStorage::READ);
            std::vector<double> stated;
            fs["glass_window_std"]["normal_deg"] >> stated;
            const Vec3d found = RefractiveCamera::read(f / "calib.yml")->window().normal;
            return std::asin(norm(found.cross(normal)))*180/CV_PI/stated[0]; };
        CAPTURE(salt);
        const double open = deviationsOff(""), given = deviationsOff(" --distance=250 --distance-std=1"),
                     atCamera = deviationsOff(" --distance=0 --distance-std=0");
        std::cout << cv::format("[numbers] a wedge of 3' in air, 250 mm away: normal off by %.1f standard deviations if nobody says where "
                                "it is, %.1f if it is given, %.1f if it is taken to be at the camera\n", open, given, atCamera);
        CHECK(open < 4);
        CHECK(given < 4);
        CHECK(atCamera > 4);
    }
}
