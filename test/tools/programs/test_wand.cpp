// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_bundle with images of a wand with two balls, as a user gives them.
#include "../target/drawn_balls.hpp"
#include "wand_scene.hpp"
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <filesystem>

using namespace cv;
using namespace cv::refract;
using namespace wand;

namespace {

//! What is in the pictures beside two equal balls that glow.
struct Scene
{
    double radiusA = 6, radiusB = 6;        //!< mm
    double blur = 0.8, noise = 2;
    double level = 190, shading = 0, from = 15, to = 40;        //!< of balls, and of the tank
    bool lamps = true;
    int hidden = 0, mirrored = 0;           //!< of so many moments one has a ball hidden from camera 2, a third ball in camera 1
    int late = 0;                           //!< images, of the last camera
    int flashed = 0;                        //!< of so many moments one has a bright bar; images have 16 bits then
};

Mat pictureOf(Wand& wand, int camera, int moment, const Scene& scene, Mat image)
{
    const drawn_balls::View view = {wand.truth.cameras[camera], Matx33d(wand.truth.Rs[camera]), Vec3d(wand.truth.Ts[camera])};
    for (int end : {0, 1})
        if (!(scene.hidden && moment % scene.hidden == 0 && end && camera == 1))
            drawn_balls::draw({wand.points[2*moment + end], end ? scene.radiusB : scene.radiusA, scene.level, scene.shading}, view,
                              scene.blur, image);
    return drawn_balls::exposed(image, scene.noise, wand.random);
}

void writePictures(const TemporaryFolder& f, Wand& wand, const Scene& scene)
{
    const std::vector<int> fast = {IMWRITE_PNG_COMPRESSION, 1};
    const int moments = (int)wand.points.size()/2;
    for (int c = 0; c < (int)wand.truth.cameras.size(); c++)
    {
        std::filesystem::create_directories(f / format("cam%d", c + 1));
        std::vector<Point2d> lamps;
        if (scene.lamps)
            lamps = {Point2d(200 + 40.*c, 150), Point2d(1000, 800 - 30.*c)};
        const Mat tank = drawn_balls::tank(SIZE, scene.from, scene.to, lamps);
        for (int m = 0; m < moments; m++)
        {
            Mat image = tank.clone();
            const bool isLast = c + 1 == (int)wand.truth.cameras.size();
            if (scene.mirrored && m % scene.mirrored == 0 && c == 0)
                circle(image, Point(500 + 7*m, 300 + 3*m), 8, Scalar(120), -1, LINE_AA);
            image = pictureOf(wand, c, isLast ? (m + moments - scene.late) % moments : m, scene, image);
            if (scene.flashed)
            {
                if (m % scene.flashed == 0)
                    rectangle(image, Rect(100, 900, 400, 8), Scalar(255), -1);
                image.convertTo(image, CV_16U, 200);
            }
            imwrite(f / format("cam%d/m%03d.png", c + 1, m), image, fast);
        }
    }
}

//! Each image of a camera gets the name of that so many moments later; the last ones those of the first.
void makeLater(const TemporaryFolder& f, int camera, int moments, int later)
{
    const std::string folder = f / format("cam%d", camera);
    for (int m = 0; m < moments; m++)
        std::filesystem::rename(folder + format("/m%03d.png", m), folder + format("/%03d", (m + later) % moments));
    for (int m = 0; m < moments; m++)
        std::filesystem::rename(folder + format("/%03d", m), folder + format("/m%03d.png", m));
}

std::string imagesOf(const TemporaryFolder& f, int cameras)
{
    std::string text;
    for (int c = 1; c <= cameras; c++)
        text += " '" + f / format("cam%d/*.png", c) + "'";
    return text;
}

ToolResult bundleImages(const TemporaryFolder& f, int cameras, const std::string& options = "")
{
    return runTool("refract_bundle " + f / "start.yml" + format(" --wand=%g,%g", WAND, WAND_STD) + imagesOf(f, cameras) + " --out="
                   + f / "calib.yml --points-out=" + f / "points.csv " + options);
}

//! Errors over what is stated.
struct Ratio
{
    double squares = 0, worst = 0;
    int count = 0;

    void add(double z)
    {
        squares += z*z;
        worst = std::max(worst, std::abs(z));
        count++;
    }
    double value() const { return std::sqrt(squares/count); }
};

void addRig(const Wand& wand, const Rig& found, Ratio& ratio)
{
    const std::map<std::string, double> is = found.parameters(), std = found.deviations();
    for (const auto& parameter : wand.truth.parameters())
        if (parameter.first.find("normal[2]") == std::string::npos)
            ratio.add((is.at(parameter.first) - parameter.second)/std.at(parameter.first));
}

/** Of pixels against where the balls' centres are; which ball is a is not known of equal ones.
@param ratio of all that, to what is stated */
double pixelError(const Wand& wand, const std::vector<Row>& rows, Ratio& ratio)
{
    std::vector<std::vector<Point2d> > exact(wand.truth.cameras.size());
    for (size_t c = 0; c < exact.size(); c++)
        refractiveProjectPoints(wand.points, wand.truth.Rs[c], wand.truth.Ts[c], wand.truth.cameras[c], exact[c]);
    double squares = 0;
    int count = 0;
    for (const Row& row : rows)
        for (size_t c = 0; c < exact.size(); c++)
        {
            const Point2d seen(row.numbers[2*c], row.numbers[2*c + 1]);
            const int m = std::stoi(row.image.substr(1));
            if (std::isnan(seen.x))
                continue;
            const double off = std::min(norm(seen - exact[c][2*m]), norm(seen - exact[c][2*m + 1]));
            const double std = row.numbers[2*exact.size() + c];
            squares += off*off/2;
            count++;
            ratio.squares += off*off/(std*std);
            ratio.count += 2;
        }
    return std::sqrt(squares/count);
}

} // namespace

TEST_CASE("refract_bundle calibrates a rig from images of a wand with two balls", "[tools][bundle][wand]")
{
    const std::vector<Scene> scenes = {Scene(), {4, 9, 1.1, 4, 190, 90, 20, 60}, {8, 8, 0.6, 1.5, 70, 20, 180, 210}};
    Ratio ratio, ofPixels;
    const int trials = scenes::trials((int)scenes.size());
    for (int trial = 0; trial < trials; trial++)
    {
        const int cameras = trial % 3 == 1 ? 3 : 2;
        Wand wand(4560 + trial, cameras, 30);
        const TemporaryFolder f;
        wand.write(f);
        writePictures(f, wand, scenes[trial % scenes.size()]);
        const ToolResult result = bundleImages(f, cameras);
        CAPTURE(scenes::seed(), trial, result.out, result.err);
        REQUIRE(result.code == 0);
        addRig(wand, Rig::read(f / "calib.yml"), ratio);
        std::cout << "[numbers] wand " << trial << ": pixels " << pixelError(wand, rowsOf(f / "points.csv"), ofPixels) << " px off\n"
                  << result.out << std::endl;
    }
    std::cout << "[numbers] rigs from images of wands, seed " << scenes::seed() << ": error over stated " << ratio.value() << " (worst "
              << ratio.worst << "), of pixels " << ofPixels.value() << std::endl;
    CHECK(ratio.value() > 0.4);             // of few wands, whose numbers share errors
    CHECK(ratio.value() < 1.4);
    CHECK(ratio.worst < 5);
    CHECK(ofPixels.value() > 0.9);
    CHECK(ofPixels.value() < 1.1);
}

TEST_CASE("Of a wand's images what is hidden, mirrored or not clear is left out and counted, and points.csv can be read again",
          "[tools][bundle][wand]")
{
    Wand wand(4570, 2, 24);
    const TemporaryFolder f;
    wand.write(f);
    Scene scene;
    scene.hidden = 6;
    scene.mirrored = 4;
    writePictures(f, wand, scene);
    const ToolResult result = bundleImages(f, 2, "--summary=" + f / "summary.json");
    CAPTURE(scenes::seed(), result.out, result.err);
    REQUIRE(result.code == 0);
    CHECK(mentions(result.out, " of 24 moments; left out: "));
    CHECK(mentions(result.out, "where two cameras do not see two balls"));
    const nlohmann::json counts = nlohmann::json::parse(readFile(f / "summary.json"))["wand"];
    CHECK(counts["moments"] == 24);
    CHECK(counts["moments_unseen"] >= 4);
    CHECK(counts["moments_used"].get<int>() + counts["moments_unseen"].get<int>() + counts["moments_unfit"].get<int>()
          + counts["moments_unclear"].get<int>() == 24);
    std::vector<Row> rows = rowsOf(f / "points.csv");
    CHECK(rows.size() > 2*12);
    Ratio ratio;
    CHECK(pixelError(wand, rows, ratio) < 0.02);
    for (const Row& row : rows)
        CHECK(std::stoi(row.image.substr(1)) % 6 != 0);
    writeFile(f / "lengths.csv", format("id1,id2,length,std\na,b,%g,%g\n", WAND, WAND_STD));
    const ToolResult again = runTool("refract_bundle " + f / "start.yml --points=" + f / "points.csv --lengths=" + f / "lengths.csv --out="
                                     + f / "again.yml");
    CAPTURE(again.out, again.err);
    CHECK(again.code == 0);
    CHECK(result.out.substr(result.out.find('\n') + 1) == again.out);
}

TEST_CASE("A flash leaves 16-bit images of a wand as they are", "[tools][bundle][wand]")
{
    Wand wand(4575, 2, 16);
    const TemporaryFolder f;
    wand.write(f);
    Scene scene = {8, 8, 0.8, 1, 60, 0, 20, 40, false};
    scene.flashed = 3;
    writePictures(f, wand, scene);
    const ToolResult result = bundleImages(f, 2);
    CAPTURE(scenes::seed(), result.out, result.err);
    REQUIRE(result.code == 0);
    const std::vector<Row> rows = rowsOf(f / "points.csv");
    int flashed = 0;
    for (const Row& row : rows)
        flashed += std::stoi(row.image.substr(1)) % scene.flashed == 0;
    CHECK(flashed >= 2*5);              // of six moments
    Ratio ratio;
    CHECK(pixelError(wand, rows, ratio) < 0.06);
}

TEST_CASE("refract_bundle says what is wrong with images of a wand", "[tools][bundle][wand]")
{
    Wand wand(4580, 2, 16);
    const TemporaryFolder f;
    wand.write(f);
    Scene scene;
    scene.late = 2;
    writePictures(f, wand, scene);
    const ToolResult late = bundleImages(f, 2);
    CAPTURE(late.err);
    CHECK(late.code == 1);
    CHECK(mentions(late.err, "the images of camera 2 are of other moments than those of camera 1, which fit 2 images later"));
    makeLater(f, 2, 16, 4);             // 6 in all
    const ToolResult later = bundleImages(f, 2);
    CAPTURE(later.err);
    CHECK(later.code == 1);
    CHECK(mentions(later.err, "the images of camera 2 are of other moments than those of camera 1, which fit 6 images later"));
    scene.late = 0;
    writePictures(f, wand, scene);
    const std::string start = "refract_bundle " + f / "start.yml" + " --out=" + f / "calib.yml", images = imagesOf(f, 2);
    const ToolResult metres = runTool(start + " --wand=0.2" + images);
    CAPTURE(metres.err);
    CHECK(metres.code == 1);
    CHECK(mentions(metres.err, " apart (median), and --wand says 0.2: is that in the unit of T"));
    for (const char* length : {"0", "-3", "a", "200,", "200,0", "200,100", "1,2,3", "nan"})
    {
        CAPTURE(length);
        const ToolResult bad = runTool(start + " --wand=" + length + images);
        CHECK(bad.code == 1);
        CHECK(mentions(bad.err, "--wand"));
    }
    const ToolResult exchanged = runTool(start + " --wand=200 '" + f / "cam2/*.png' '" + f / "cam1/*.png'");
    CAPTURE(exchanged.out, exchanged.err);
    CHECK(exchanged.code == 1);
    CHECK(mentions(runTool(start + images).err, "images are for --wand=LENGTH"));
    CHECK(mentions(runTool(start + " --colmap=" + f / "sparse" + images).err, "images are for --wand=LENGTH"));
    CHECK(mentions(runTool(start + " --wand=200").err, "IMAGES"));
    CHECK(mentions(runTool(start + " --wand=200" + imagesOf(f, 1)).err, "has 2 cameras, and images of 1 are given"));
    CHECK(mentions(runTool(start + " --wand=200 '" + f / "cam1/m00[0-2].png' '" + f / "cam2/m00[0-2].png'").err, "and 8 are needed"));
}

TEST_CASE("refract_bundle names the one of three cameras whose images of a wand are no use", "[tools][bundle][wand]")
{
    Wand wand(4585, 3, 16);
    const TemporaryFolder f;
    wand.write(f);
    writePictures(f, wand, Scene());
    for (int late : {3, 1})
    {
        makeLater(f, late, 16, 2);
        const ToolResult result = bundleImages(f, 3);
        makeLater(f, late, 16, 14);
        CAPTURE(late, scenes::seed(), result.out, result.err);
        CHECK(result.code == 1);
        CHECK(mentions(result.err, format("the images of camera %d are of other moments than those of the others, which fit 2 images later",
                                          late)));
    }
    for (int m = 1; m < 16; m++)
        std::filesystem::copy_file(f / "cam3/m000.png", f / format("cam3/m%03d.png", m),
                                   std::filesystem::copy_options::overwrite_existing);
    const ToolResult blind = bundleImages(f, 3);
    CAPTURE(blind.out, blind.err);
    CHECK(blind.code == 1);
    CHECK(mentions(blind.err, "camera 3 sees the wand in 0 of 1"));
    for (int m = 3; m < 16; m++)
        std::filesystem::remove(f / format("cam3/m%03d.png", m));
    const ToolResult few = bundleImages(f, 3);
    CAPTURE(few.out, few.err);
    CHECK(few.code == 1);
    CHECK(mentions(few.err, "camera 3 has images of 3 moments"));
}

TEST_CASE("Where names of a wand's images do not say the moment clearly, --view-pattern does", "[tools][bundle][wand]")
{
    const std::string folder = paths::bundled() + "/balls";
    const TemporaryFolder f;
    std::filesystem::create_directories(f / "all");
    for (int m = 0; m < 30; m++)
        for (int c : {0, 1})
            std::filesystem::copy_file(folder + format("/%s/m%02d.jpg", c ? "right" : "left", m),
                                       f / format("all/%c%d_%02d_%d.jpg", c ? 'q' : 'p', 100 - m*(c + 1), m, 7*m + 50*c));
    const std::string command = "refract_bundle " + folder + "/start.yml --wand=200 '" + f / "all/p*.jpg' '" + f / "all/q*.jpg' --out="
        + f / "calib.yml";
    CHECK(runTool(command).code == 1);
    const ToolResult result = runTool(command + " --view-pattern='*_{}_*'");
    CAPTURE(result.out, result.err);
    CHECK(result.code == 0);
    CHECK(mentions(result.out, "wand: 23 of 30 moments"));
    CHECK(mentions(runTool(command + " --view-pattern='m{}'").err, "has no name of this form"));
    CHECK(mentions(runTool(command + " --view-pattern='*'").err, "{} must stand in it once"));
}

TEST_CASE("Where images of a wand leave a fit undetermined, what was seen of it is said", "[tools][bundle][wand]")
{
    const std::string folder = paths::bundled() + "/balls";
    const TemporaryFolder f;
    const ToolResult result = runTool("refract_bundle " + folder + "/start.yml --wand=200 '" + folder + "/left/*.jpg' '" + folder
                                      + "/right/*.jpg' --free=normal,extrinsics,distance,thickness,index --out=" + f / "calib.yml");
    CAPTURE(result.out, result.err);
    CHECK(result.code == 1);
    CHECK(mentions(result.err, "out of --free"));
    CHECK(mentions(result.err, "; wand: 23 of 30 moments; left out: 7 where"));
}

TEST_CASE("What the images of a wand do not tell ends in a sentence, not in an assertion", "[tools][bundle][wand]")
{
    const TemporaryFolder f;
    const std::string folder = paths::bundled() + "/balls";
    for (const char* free : {"index", "normal,extrinsics,index"})
    {
        const ToolResult result = runTool("refract_bundle " + folder + "/start.yml --wand=200,0.1 '" + folder + "/left/*' '" + folder
                                          + "/right/*' --free=" + free + " --out=" + f / "c.yml");
        CAPTURE(free, result.out, result.err);
        CHECK(result.code == 1);
        CHECK(mentions(result.err, "leave out of --free what the points hardly tell; wand: 23 of 30 moments"));
    }
}

TEST_CASE("The images of a wand of the guide are made anew", "[.wand-data]")
{
    const std::string known = paths::bundled() + "/wand", folder = paths::bundled() + "/balls";
    const Size size(320, 256);
    Wand wand(4590);
    wand.truth = Rig::read(known + "/truth.yml");
    wand.start = Rig::read(known + "/start.yml");
    wand.random = scenes::Random(4590);
    wand.length = WAND + wand.random.normal(0.1);
    wand.wave(30);
    for (Rig* rig : {&wand.truth, &wand.start})
        for (Ptr<RefractiveCamera>& camera : rig->cameras)
        {
            const GlassWindow window = camera->window();
            camera = RefractiveCamera::create(Matx33d(400, 0, 159.625, 0, 400, 127.625, 0, 0, 1), camera->distCoeffs(), window);
            camera->setImageSize(size);
        }
    writeRig(folder + "/start.yml", wand.start.cameras, wand.start.Rs, wand.start.Ts);
    std::string start = readFile(folder + "/start.yml");
    writeFile(folder + "/start.yml", start.insert(start.find("camera1"), "unit: mm\n"));
    Scene scene;
    scene.radiusA = scene.radiusB = 8;
    scene.noise = 1.5;
    scene.hidden = 10;
    for (int c = 0; c < 2; c++)
        for (int m = 0; m < (int)wand.points.size()/2; m++)
        {
            const Mat tank = drawn_balls::tank(size, scene.from, scene.to, {Point2d(50 + 10.*c, 40)});      // a lamp, in a pane
            const std::string ofCamera = folder + (c ? "/right" : "/left");
            std::filesystem::create_directories(ofCamera);
            imwrite(ofCamera + format("/m%02d.jpg", m), pictureOf(wand, c, m, scene, tank), {IMWRITE_JPEG_QUALITY, 88});
        }
}
