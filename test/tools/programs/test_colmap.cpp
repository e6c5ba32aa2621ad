// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_bundle --colmap and refract_undistort --colmap as a user runs them, on a survey behind a flat port in water of which the truth is
// known.
#include "survey_scene.hpp"
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

using namespace survey_scene;

TEST_CASE("A bent model of COLMAP becomes points and poses within their +-", "[tools][bundle][colmap]")
{
    const int trials = scenes::trials(2);
    Ratio ofPoints, ofPoses;
    for (int trial = 0; trial < trials; trial++)
    {
        Network network(700 + trial);
        const TemporaryFolder f;
        network.write(f);
        const ToolResult result = survey(f, "--positions=" + f / "positions.csv");
        CAPTURE(scenes::seed(), trial, result.out, result.err);
        REQUIRE(result.code == 0);
        CHECK(mentions(result.out, " positions, +- "));
        CHECK(std::count(result.out.begin(), result.out.end(), '\n') <= 10);
        addErrors(network, f, ofPoints, ofPoses);
    }
    WARN("[numbers] refract_bundle --colmap, " << trials << " surveys, seed " << scenes::seed() << ": error over stated "
         << ofPoints.value() << " of points, " << ofPoses.value() << " of places");
    CHECK(ofPoints.value() > 0.8);
    CHECK(ofPoints.value() < 1.25);
    CHECK(ofPoses.value() > 0.8);
    CHECK(ofPoses.value() < 1.25);
}

TEST_CASE("Above --memory the +- of points are for known views, and it is said", "[tools][bundle][colmap]")
{
    Network network(710);
    const TemporaryFolder f;
    network.write(f);
    const auto stds = [&](const std::string& option) {
        const ToolResult result = survey(f, "--lengths=" + f / "lengths.csv" + option);
        CAPTURE(result.out, result.err);
        REQUIRE(result.code == 0);
        const bool isSaid = mentions(result.out, "not found (--memory)") && mentions(result.out, "if views were known");
        CHECK(isSaid == (option == " --memory=1e-6"));
        const nlohmann::json json = nlohmann::json::parse(readFile(f / "summary.json"));
        CHECK(json["points_in_known_views"] == isSaid);
        CHECK(json["scale_std"].is_null() == isSaid);
        for (const auto& row : tableOf(f / "poses.csv"))
            CHECK((std::isnan(row.second[15]) || row.second[15] == 0) == (isSaid || row.first == "left/000.png"));
        std::vector<double> all;
        for (const auto& row : tableOf(f / "points.csv"))
            if (row.second[8] == 0)
                all.push_back(row.second[3]);
        return all;
    };
    const std::vector<double> all = stds(""), enough = stds(" --memory=1"), alone = stds(" --memory=1e-6");
    CHECK(enough == all);
    REQUIRE(alone.size() == all.size());
    for (size_t i = 0; i < all.size(); i++)
        CHECK(alone[i] < all[i]);
}

TEST_CASE("Lengths, a base line or the window tell the scale of a model", "[tools][bundle][colmap]")
{
    for (const std::string by : {"lengths", "base line", "window"})
    {
        Network network(720, by == "base line" ? 2 : 1);
        const TemporaryFolder f;
        network.write(f);
        const ToolResult result = survey(f, by == "lengths" ? "--lengths=" + f / "lengths.csv" : by == "base line"
                                         ? "--images='left/*' --images='right/*' --free=normal" : "");
        CAPTURE(scenes::seed(), by, result.out, result.err);
        if (by == "window" && result.code == 1)         // of some draws
        {
            CHECK(mentions(result.err, "nothing tells the scale"));
            continue;
        }
        REQUIRE(result.code == 0);
        CHECK(mentions(result.out, by));
        const double std = nlohmann::json::parse(readFile(f / "summary.json"))["scale_std"];
        std::vector<Vec3d> found, truth;
        for (const auto& row : tableOf(f / "points.csv"))
            if (row.second[8] == 0)
            {
                found.push_back({row.second[0], row.second[1], row.second[2]});
                truth.push_back(network.points[std::atoi(row.first.c_str()) - 1]);
            }
        std::vector<double> ratios;
        for (size_t i = 0; i < found.size(); i++)
            for (size_t k = i + 1; k < found.size(); k += 7)
                ratios.push_back(norm(found[i] - found[k])/norm(truth[i] - truth[k]));
        std::nth_element(ratios.begin(), ratios.begin() + ratios.size()/2, ratios.end());
        const double off = ratios[ratios.size()/2] - 1;
        CAPTURE(off, std);
        CHECK(std::abs(off) < 4*std);
        CHECK(std < (by == "window" ? 0.3 : 0.02));
    }
}

TEST_CASE("Markers on the pane that a survey contradicts are named", "[tools][bundle][colmap]")
{
    Network network(740);
    const TemporaryFolder f;
    network.write(f);
    for (const double tilt : {0., 0.3})
    {
        const GlassWindow window = network.truth[0]->window();
        std::string table = "id,x,y,z\n";
        for (int i = 0; i < 6; i++)
        {
            const double x = 60*(i % 3) - 60, y = 80*(i/3) - 40;
            const double z = (window.distance - window.normal[0]*x - window.normal[1]*y)/window.normal[2] + tilt*x;
            table += format("%d,%g,%g,%.6f\n", i, x, y, z + network.random.normal(0.1));
        }
        writeFile(f / "pane.csv", table);
        const ToolResult result = survey(f, "--positions=" + f / "positions.csv" + " --pane-points=" + f / "pane.csv"
                                         + " --pane-points-std=0.1 --distance-std=0");
        CAPTURE(scenes::seed(), tilt, result.out, result.err);
        CHECK(result.code == (tilt > 0 ? 2 : 0));
        CHECK(mentions(result.err, "the matches contradict --pane-points of camera 1's window") == (tilt > 0));
    }
}

TEST_CASE("A window that tells no scale is not said to tell one", "[tools][bundle][colmap]")
{
    for (unsigned salt : {760, 761, 762})
    {
        Network network(salt, 1, 0, -1, 0.02);
        const TemporaryFolder f;
        network.write(f);
        const ToolResult result = survey(f, "");
        CAPTURE(scenes::seed(), salt, result.out, result.err);
        if (result.code == 1)
        {
            CHECK(mentions(result.err, "nothing tells the scale"));
            continue;
        }
        const double std = nlohmann::json::parse(readFile(f / "summary.json"))["scale_std"];
        std::vector<double> ratios;
        const auto table = tableOf(f / "points.csv");
        for (const auto& a : table)
            for (const auto& b : table)
                if (a.first < b.first && a.second[8] == 0 && b.second[8] == 0)
                    ratios.push_back(norm(Vec3d(a.second.data()) - Vec3d(b.second.data()))
                                     /norm(network.points[std::atoi(a.first.c_str()) - 1]
                                           - network.points[std::atoi(b.first.c_str()) - 1]));
        std::nth_element(ratios.begin(), ratios.begin() + ratios.size()/2, ratios.end());
        const double off = std::log(ratios[ratios.size()/2]);
        CAPTURE(off, std);
        CHECK(std::abs(off) < 4*std);
        CHECK(mentions(result.out, "hardly determined: the scale"));
    }
}

TEST_CASE("A view of which every observation is wrong is left out by name", "[tools][bundle][colmap]")
{
    Network network(770, 1, 0, 7);
    const TemporaryFolder f;
    network.write(f);
    for (const std::string by : {"positions", "lengths"})
    {
        const ToolResult result = survey(f, "--" + by + "=" + f / (by + ".csv") + " --colmap-out=" + f / "refracted");
        CAPTURE(scenes::seed(), by, result.out, result.err);
        REQUIRE(result.code == 0);
        CHECK(mentions(result.out, "images left out: left/007.png (no pose fits)"));
        CHECK_FALSE(mentions(readFile(f / "refracted/images.txt"), "nan"));
        CHECK_FALSE(mentions(readFile(f / "refracted/images.txt"), "left/007.png"));
        CHECK_FALSE(mentions(readFile(f / "refracted/frames.txt"), "nan"));
        CHECK(mentions(readFile(f / "refracted/frames.txt"), "\n18 1 "));
    }
}

TEST_CASE("Wrong observations of a model are left out, and few others", "[tools][bundle][colmap]")
{
    Network network(730, 1, 0.1);
    const TemporaryFolder f;
    network.write(f);
    const ToolResult result = survey(f, "--positions=" + f / "positions.csv");
    CAPTURE(scenes::seed(), result.out, result.err);
    REQUIRE(result.code == 0);
    Ratio ofPoints, ofPoses;
    addErrors(network, f, ofPoints, ofPoses);
    CHECK(ofPoses.value() < 2);
    CHECK(ofPoses.count >= 3*17);     // one may show too few points
    CHECK(ofPoints.value() < 2);
}

TEST_CASE("Wrong observations that are to be taken as right are told", "[tools][bundle][colmap]")
{
    for (const bool areMany : {false, true})
    {
        Network network(731, 1, areMany ? 0.05 : 0.);
        if (!areMany)
            network.images[5].pixels[20].first.y += 60;
        const TemporaryFolder f;
        network.write(f);
        const ToolResult result = survey(f, "--no-robust --positions=" + f / "positions.csv");
        CAPTURE(scenes::seed(), areMany, result.out, result.err);
        CHECK(result.code == 2);
        CHECK(mentions(result.err, " pixels are wrong"));
        CHECK(mentions(result.err, "correct them, or leave out --no-robust"));
    }
}

TEST_CASE("A refined model gives images of a pinhole without window", "[tools][undistort][colmap]")
{
    Network network(740);
    const TemporaryFolder f;
    network.write(f);
    const ToolResult bundle = survey(f, "--positions=" + f / "positions.csv --colmap-out=" + f / "refracted");
    CAPTURE(scenes::seed(), bundle.out, bundle.err);
    REQUIRE(bundle.code == 0);
    // Their grey value is the column.
    Mat ramp(SIZE, CV_16U);
    for (int x = 0; x < SIZE.width; x++)
        ramp.col(x) = 1000 + 64*x;
    std::filesystem::create_directories(f.path()/"images/left");
    for (const Image& image : network.images)
        imwrite(f / ("images/" + image.name), ramp);
    const ToolResult result = runTool("refract_undistort " + f / "again.yml" + " --colmap=" + f / "refracted" + " --image-dir="
                                      + f / "images" + " --out-dir=" + f / "dense --summary=" + f / "undistorted.json");
    CAPTURE(result.out, result.err);
    REQUIRE(result.code == 0);
    CHECK(mentions(result.out, " images written to "));
    CHECK(std::filesystem::exists(f / "dense/sparse/points3D.bin"));
    CHECK(mentions(readFile(f / "dense/stereo/patch-match.cfg"), "left/000.png\n__auto__, 20\n"));
    // Its own reader takes the model, and a bundle of it without a window is as good.
    const Ptr<RefractiveCamera> found = RefractiveCamera::read(f / "again.yml");
    found->setWindow(GlassWindow());
    const Mat image = imread(f / "dense/images/left/004.png", IMREAD_UNCHANGED);
    REQUIRE(image.type() == CV_16U);
    CHECK(image.size() == SIZE);
    CHECK(std::abs(image.at<ushort>(240, 320) - (1000 + 64*320)) < 64*60);
    const std::string camera = readFile(f / "dense/sparse/cameras.bin");
    REQUIRE(camera.size() == 8 + 4 + 4 + 16 + 4*8);
    double K[4];
    std::memcpy(K, camera.data() + 32, sizeof K);
    double worst = 0;
    int count = 0;
    const Image& shown = network.images[4];
    std::vector<Point2d> raw;
    Vec3d rvec;
    Rodrigues(shown.R, rvec);
    refractiveProjectPoints(network.points, rvec, shown.t, network.truth[0], raw);
    for (const auto& pixel : shown.pixels)
    {
        const Vec3d X = shown.R*Vec3d(network.points[pixel.second]) + shown.t;
        const Point2d p(K[0]*X[0]/X[2] + K[2] - 0.5, K[1]*X[1]/X[2] + K[3] - 0.5);
        if (!(p.x > 2 && p.y > 2 && p.x < SIZE.width - 3 && p.y < SIZE.height - 3))
            continue;
        const double value = image.at<ushort>(cvRound(p.y), cvRound(p.x)), column = (value - 1000)/64;
        const double slope = (image.at<ushort>(cvRound(p.y), cvRound(p.x) + 1) - value)/64;
        worst = std::max(worst, std::abs(column + slope*(p.x - cvRound(p.x)) - raw[pixel.second].x));
        count++;
    }
    CAPTURE(worst, count);
    CHECK(count > 20);
    CHECK(worst < 4);           // the window as found, the depth between points
    CHECK(std::filesystem::is_directory(f.path()/"dense/stereo/depth_maps/left"));
    const auto refusal = [&](const std::string& calibration, const std::string& model) {
        const ToolResult run = runTool("refract_undistort " + f / calibration + " --colmap=" + f / model + " --image-dir=" + f / "images"
                                       + " --out-dir=" + f / "wrong");
        CAPTURE(calibration, model, run.out);
        CHECK(run.code == 1);
        CHECK_FALSE(std::filesystem::exists(f / "wrong"));
        return run.err;
    };
    // Near its origin, which the summary says; and each image in its place.
    const nlohmann::json origin = nlohmann::json::parse(readFile(f / "summary.json"))["colmap_origin"];
    CHECK(std::abs(origin[1].get<double>() - FAR[1]) < 200);
    CHECK(mentions(readFile(f / "refracted/points3D.txt"), "less "));
    const nlohmann::json undistorted = nlohmann::json::parse(readFile(f / "undistorted.json"));
    CHECK(undistorted["images"] >= 17);        // one may show too few points
    CHECK(mentions(refusal("again.yml", "sparse"), "half of the model's points "));       // bent, in another unit
    network.start[0]->setWindow(GlassWindow(Vec3d(0.2, 0, 1), 60, 1.49, 60, 1.333));
    writeRig(f / "other.yml", network.start, network.Rs, network.Ts);
    CHECK(mentions(refusal("other.yml", "refracted"), "of the model's points are more than "));
    std::filesystem::remove(f.path()/"images/left/004.png");
    CHECK(mentions(refusal("again.yml", "refracted"), "left/004.png', an image of the model"));
}

TEST_CASE("What refract_bundle --colmap cannot do is said in a sentence", "[tools][bundle][colmap]")
{
    Network network(750);
    const TemporaryFolder f;
    network.write(f);
    const auto refusal = [&](const std::string& options, const std::string& model = "sparse") {
        const ToolResult result = survey(f, options, model);
        CAPTURE(options, result.out, result.err);
        CHECK(result.code == 1);
        CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
        return result.err;
    };
    CHECK(mentions(refusal("", "nothing"), "has no cameras.bin and no cameras.txt: give the folder of a COLMAP model"));
    CHECK(mentions(refusal("--images='none/*'"), "no image of the model is of --images=none/*: its names are like 'left/000.png'"));
    CHECK(mentions(refusal("--images='left/*' --images='right/*'"), "--images is given 2 times, and the calibration has 1 camera"));
    writeFile(f / "l.csv", "id1,id2,length,std\n9998,9999,20,0.1\n");
    CHECK(mentions(refusal("--lengths=" + f / "l.csv"), "has no point '9998'"));
    writeFile(f / "p.csv", "image,x,y,z,std\na.png,1,2,3,1\n");
    CHECK(mentions(refusal("--positions=" + f / "p.csv"), "has positions of 0 of the model's images, at least three are needed"));
    writeFile(f / "sparse/cameras.txt", "1 OPENCV 1280 960 1000 1000 640 480 0 0 0 0\n");
    CHECK(mentions(refusal("--lengths=" + f / "lengths.csv"), "is of 1280x960 pixels, and camera 1 was calibrated with 640x480"));
    const std::string images = readFile(f / "sparse/images.txt");
    writeFile(f / "sparse/images.txt", images.substr(0, images.size()/2));
    CHECK(mentions(refusal(""), "images.txt' looks like COLMAP's, but line "));
}
