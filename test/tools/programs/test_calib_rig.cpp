// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_calib and refract_measure of more than two cameras, as a user runs them: points of any target, walls, known poses.
#include "run_tool.hpp"
#include "scenes.hpp"
#include "truth_file.hpp"
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <iostream>

using namespace cv;
using namespace cv::refract;

namespace {

const double SIGMA = 0.1;
const Size IMAGE(1280, 1024);

//! Cameras round a tank of water, a few before each of its walls; dots on five planes in its middle. Length in mm.
struct Tank
{
    std::vector<Ptr<RefractiveCamera>> cameras;
    std::vector<Matx33d> Rs;        // camera 1 -> each
    std::vector<Vec3d> Ts;
    std::vector<int> walls;
    std::vector<Point3d> dots;      // in the target's frame
    Matx33d R1;                     // target -> camera 1
    Vec3d t1;

    Tank(int count, int camerasPerWall, scenes::Random& random)
    {
        const Mat dist = (Mat_<double>(1, 5) << -0.12, 0.08, 0.0005, -0.0003, 0.);
        std::vector<Vec3d> normals;
        for (int wall = 0; wall*camerasPerWall < count; wall++)
        {
            const double angle = wall*CV_PI/2;
            normals.push_back(normalize(Vec3d(-std::sin(angle), 0, std::cos(angle)) + 0.03*random.vector(1.)));
        }
        for (int c = 0; c < count; c++)
        {
            const int wall = c/camerasPerWall, place = c % camerasPerWall;
            const double angle = wall*CV_PI/2;
            const Vec3d out(std::sin(angle), 0, -std::cos(angle)), side(std::cos(angle), 0, std::sin(angle));
            const Vec3d centre = 480.*out + (140.*(place % 2) - 70.)*side + Vec3d(0, 100.*(place/2) - 40., 0)
                                 + 10.*random.vector(1.);
            const Vec3d z = normalize(10.*random.vector(1.) - centre), x = normalize(Vec3d(0, 1, 0).cross(z)), y = z.cross(x);
            const Matx33d R(x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]);
            const Vec3d t = -(R*centre);
            const double f = 1500. + 20.*c;
            const Mat K = (Mat_<double>(3, 3) << f, 0, 640 + 3*c, 0, f + 2, 512 - 2*c, 0, 0, 1);
            const double distance = -200. - normals[wall].dot(centre);
            cameras.push_back(RefractiveCamera::create(K, dist, GlassWindow(R*normals[wall], 12., 1.49, distance, 1.333)));
            cameras.back()->setImageSize(IMAGE);
            if (c == 0)
            {
                R1 = R;
                t1 = t;
            }
            Rs.push_back(R*R1.t());
            Ts.push_back(t - Rs.back()*t1);
            walls.push_back(wall + 1);
        }
        for (int plane = -2; plane <= 2; plane++)
            for (int row = -2; row <= 2; row++)
                for (int column = -3; column <= 3; column++)
                    dots.emplace_back(20*column, 20*row, 30*plane);
    }

    int count() const { return (int)cameras.size(); }

    Vec3d inCamera1(const Point3d& X) const { return R1*Vec3d(X) + t1; }

    //! NaN outside the image.
    std::vector<Point2d> project(int c, const std::vector<Point3d>& points) const
    {
        std::vector<Point3d> inFirst;
        for (const Point3d& X : points)
            inFirst.push_back(inCamera1(X));
        std::vector<Point2d> pixels;
        refractiveProjectPoints(inFirst, Mat(Rs[c]), Ts[c], cameras[c], pixels);
        for (Point2d& p : pixels)
            if (!Rect2d(0, 0, IMAGE.width, IMAGE.height).contains(p))
                p = Point2d(NAN, NAN);
        return pixels;
    }

    //! points1.csv, camera1.yml and so on: what each camera sees, nine dots of ten.
    void write(const TemporaryFolder& folder, scenes::Random& random) const
    {
        for (int c = 0; c < count(); c++)
        {
            std::ofstream out(folder/format("points%d.csv", c + 1));
            out << "view,x,y,z,u,v\n";
            const std::vector<Point2d> pixels = project(c, dots);
            for (size_t i = 0; i < dots.size(); i++)
                if (pixels[i].x == pixels[i].x && random.uniform(0, 1) < 0.9)
                    out << format("cal,%g,%g,%g,%.6f,%.6f\n", dots[i].x, dots[i].y, dots[i].z, pixels[i].x + random.normal(SIGMA),
                                  pixels[i].y + random.normal(SIGMA));
            FileStorage lens(folder/format("camera%d.yml", c + 1), FileStorage::WRITE);
            lens << "camera_matrix" << cameras[c]->cameraMatrix() << "distortion_coefficients" << cameras[c]->distCoeffs()
                 << "image_width" << IMAGE.width << "image_height" << IMAGE.height;
        }
    }

    std::string inputs(const TemporaryFolder& folder) const
    {
        std::string text = "refract_calib --quiet --image-size=1280x1024 --thickness=12 --index=1.49 --outer-index=1.333 "
                           "--window-of-camera=";
        for (int c = 0; c < count(); c++)
            text += (c ? "," : "") + std::to_string(walls[c]);
        for (int c = 0; c < count(); c++)
        {
            const std::string number = c ? std::to_string(c + 1) : "";
            text += " --glass" + number + '=' + folder/format("points%d.csv", c + 1) + " --camera" + number + '='
                + folder/format("camera%d.yml", c + 1);
        }
        return text + " --out=" + folder / "calib.yml";
    }

    //! Angle between a window's normal as it is and as the file has it.
    double normalErrorDeg(const std::string& path, int c) const
    {
        const Vec3d a = RefractiveCamera::read(path, format("camera%d", c + 1))->window().normal, b = cameras[c]->window().normal;
        return std::atan2(norm(a.cross(b)), a.dot(b))*180/CV_PI;
    }
};

double largestNormalStdDeg(const nlohmann::json& summary, int c)
{
    const auto std = summary["cameras"][c]["window"]["normal_std_deg"].get<std::vector<double>>();
    return *std::max_element(std.begin(), std.end());
}

//! Columns of a CSV by name; nan is taken.
std::map<std::string, std::vector<double>> columnsOf(const std::string& text)
{
    std::istringstream in(text);
    std::string line, cell;
    std::vector<std::string> names;
    std::getline(in, line);
    for (std::istringstream cells(line); std::getline(cells, cell, ','); )
        names.push_back(cell);
    std::map<std::string, std::vector<double>> columns;
    while (std::getline(in, line))
    {
        std::istringstream cells(line);
        for (const std::string& name : names)
        {
            std::getline(cells, cell, ',');
            columns[name].push_back(name == "image" ? 0. : std::stod(cell));
        }
    }
    return columns;
}

} // namespace

TEST_CASE("Four cameras before two walls of a tank, from one view of a 3-D target, then points that are no target", "[calib_rig]")
{
    scenes::Random random(5100);
    CAPTURE(scenes::seed());
    const TemporaryFolder folder;
    const Tank tank(4, 2, random);
    tank.write(folder, random);
    const ToolResult calib = runTool(tank.inputs(folder) + " --report=" + folder / "report.html --summary=" + folder / "s.json");
    CAPTURE(calib.err);
    REQUIRE(calib.code == 0);

    const FileStorage file(folder / "calib.yml", FileStorage::READ);
    for (const char* key : {"camera4", "R", "T", "R3", "T3", "R4", "T4"})
        CHECK(!file[key].empty());
    CHECK(file["R2"].empty());
    CHECK(file["camera5"].empty());
    std::vector<Ptr<RefractiveCamera>> cameras;
    std::vector<Mat> Rs, Ts;
    std::vector<int> walls;
    Mat covariance;
    readRig(folder / "calib.yml", cameras, Rs, Ts, walls, covariance);
    CHECK(walls == tank.walls);
    Mat T4;
    file["T4"] >> T4;
    CHECK(norm(T4.reshape(1, 3), Mat(tank.Ts[3])) < 1.);
    const nlohmann::json summary = nlohmann::json::parse(readFile(folder / "s.json"));
    REQUIRE(summary["cameras"].size() == 4);
    for (int c = 0; c < 4; c++)
        CHECK(tank.normalErrorDeg(folder / "calib.yml", c) < 3.5*largestNormalStdDeg(summary, c));
    CHECK(summary["fit"]["sigma_px"].get<double>() == Approx(SIGMA).epsilon(0.15));
    CHECK(summary["cameras"][0]["corners"]["glass"].get<int>() > 100);
    const std::string page = readFile(folder / "report.html");
    for (const char* words : {"The rig from behind", "Which camera sees what", "Camera 4 (click)", "by 4 cameras"})
        CHECK(page.find(words) != std::string::npos);

    // Markers that took no part, each in some of the cameras, with names of their own.
    std::vector<Point3d> markers;
    std::vector<std::vector<Point2d>> seen(4);
    for (int i = 0; i < 40; i++)
        markers.emplace_back(random.uniform(-60, 60), random.uniform(-40, 40), random.uniform(-60, 60));
    for (int c = 0; c < 4; c++)
        seen[c] = tank.project(c, markers);
    std::ofstream out(folder / "markers.csv");
    out << "id,u1,v1,u2,v2,u3,v3,u4,v4\n";
    for (int i = 0; i < 40; i++)
    {
        out << 100 + i;
        for (int c = 0; c < 4; c++)
            if (c == i % 5 || std::isnan(seen[c][i].x) || (i == 39 && c > 0))
                out << ",,";
            else
                out << format(",%.6f,%.6f", seen[c][i].x + random.normal(SIGMA), seen[c][i].y + random.normal(SIGMA));
        out << '\n';
    }
    out.close();
    const ToolResult measure = runTool("refract_measure " + folder / "calib.yml --points=" + folder / "markers.csv --out="
                                       + folder / "points.csv");
    CAPTURE(measure.err, measure.out);
    REQUIRE(measure.code == 0);
    const std::string csv = readFile(folder / "points.csv");
    CHECK(csv.substr(0, csv.find('\n')) == "image,id,u1,v1,u2,v2,u3,v3,u4,v4,x,y,z,sx,sy,sz,status");
    auto columns = columnsOf(csv);
    REQUIRE(columns["x"].size() == 40);
    double squares = 0, stated = 0, ofLengths = 0;
    Vec3d last;
    for (int i = 0; i < 39; i++)
    {
        const Vec3d X(columns["x"][i], columns["y"][i], columns["z"][i]), error = X - tank.inCamera1(markers[i]);
        if (i > 0)
            ofLengths += std::pow(norm(X - last) - norm(markers[i] - markers[i - 1]), 2)/38;
        last = X;
        squares += error.dot(error)/39;
        stated += (std::pow(columns["sx"][i], 2) + std::pow(columns["sy"][i], 2) + std::pow(columns["sz"][i], 2))/39;
        CHECK(columns["id"][i] == 100 + i);
        CHECK(columns["status"][i] == 0);
    }
    CHECK(std::isnan(columns["x"][39]));                        // a single camera saw it
    CHECK(columns["status"][39] == REFRACT_NOT_FINITE);
    std::cout << "[numbers] markers that took no part, 4 cameras: " << std::sqrt(squares) << " mm 3-D RMS, stated "
              << std::sqrt(stated) << "; lengths between them " << std::sqrt(ofLengths) << " mm RMS" << std::endl;
    CHECK(squares < 2.5*2.5*stated);        // a calibration's error moves all of them together: one draw
    CHECK(std::sqrt(ofLengths) < 0.1);

    // The target's own points, matched between the cameras by their coordinates.
    std::string images;
    for (int c = 0; c < 4; c++)
        images += ' ' + folder/format("points%d.csv", c + 1);
    const ToolResult target = runTool("refract_measure " + folder / "calib.yml" + images + " --out=" + folder / "target.csv");
    CAPTURE(target.err);
    CHECK(target.code == 0);
    CHECK(columnsOf(readFile(folder / "target.csv"))["x"].size() == tank.dots.size());
}

TEST_CASE("Known poses, exact and uncertain, serve a rig", "[calib_rig]")
{
    scenes::Random random(5200);
    CAPTURE(scenes::seed());
    const TemporaryFolder folder;
    const Tank tank(3, 2, random);
    tank.write(folder, random);
    Vec3d rvec;
    Rodrigues(tank.R1, rvec);
    rvec *= 180/CV_PI;
    const std::string pose = format("cal,%.12g,%.12g,%.12g,%.12g,%.12g,%.12g", rvec[0], rvec[1], rvec[2], tank.t1[0], tank.t1[1],
                                    tank.t1[2]);
    std::ofstream(folder / "exact.csv") << "view,rx_deg,ry_deg,rz_deg,tx_mm,ty_mm,tz_mm\n" << pose << '\n';
    std::ofstream(folder / "uncertain.csv") << "view,rx_deg,ry_deg,rz_deg,tx_mm,ty_mm,tz_mm,sigma_deg,sigma_mm\n" << pose
                                            << ",0.01,0.1\n";
    double distanceStd[3], firstTilt[3];
    const char* const files[] = {"", "uncertain.csv", "exact.csv"};
    for (int i = 0; i < 3; i++)
    {
        const std::string poses = *files[i] ? " --poses=" + folder / files[i] : "";
        const ToolResult calib = runTool(tank.inputs(folder) + poses + " --summary=" + folder / "s.json");
        CAPTURE(files[i], calib.err);
        REQUIRE(calib.code == 0);
        const nlohmann::json summary = nlohmann::json::parse(readFile(folder / "s.json"));
        for (int c = 0; c < tank.count(); c++)
        {
            const double stated = largestNormalStdDeg(summary, c);
            CAPTURE(c, stated);
            CHECK(tank.normalErrorDeg(folder / "calib.yml", c) < 3.5*stated);
            CHECK(stated < 0.3);
        }
        firstTilt[i] = largestNormalStdDeg(summary, 0);
        distanceStd[i] = summary["cameras"][0]["window"]["distance"]["std"].get<double>();
        CHECK(summary["fit"]["sigma_px"].get<double>() == Approx(SIGMA).epsilon(0.15));
    }
    for (const double* std : {distanceStd, firstTilt})
    {
        CHECK(std[1] < std[0]);
        CHECK(std[2] < std[1]);
    }
}

TEST_CASE("What does not fit a rig is refused in a sentence", "[calib_rig]")
{
    scenes::Random random(5300);
    const TemporaryFolder folder;
    const Tank tank(3, 2, random);
    tank.write(folder, random);
    const std::string calib = "refract_calib --quiet --thickness=12 --index=1.49 --outer-index=1.333 --out=" + folder / "out.yml";
    const std::string first = " --glass=" + folder / "points1.csv", second = " --glass2=" + folder / "points2.csv",
                      third = " --glass3=" + folder / "points3.csv", size = " --image-size=1280x1024";
    std::ofstream(folder / "poses.csv") << "view,rx_deg,ry_deg,rz_deg,tx,ty,tz\nother,0,0,0,0,0,500\n";
    std::ofstream(folder / "behind.csv") << "view,rx_deg,ry_deg,rz_deg,tx,ty,tz\ncal,0,0,0,0,0,-500\n";
    const struct { std::string arguments, words; } cases[] = {
        {first + third + size, "no --glass2"},
        {first + second, "--image-size"},
        {first + second + size + " --window-of-camera=1", "there are 2 cameras"},
        {first + second + size + " --window-of-camera=1,1.5", "whole numbers"},
        {first + second + size + " --window-of-camera=1,1 --shared-window", "excludes"},
        {first + second + size + " --shared-window --bow-std=2", "--wedge-std=0"},
        {" --glass='*.png'", "--size"},
        {first + size + " --poses=" + folder / "poses.csv", "no pose of view 'cal'"},
        {first + size + " --poses=" + folder / "behind.csv --camera=" + folder / "camera1.yml", "no image through the window at the start"},
        {first + size + " --glass17=" + folder / "points3.csv", "glass17"},
        {first + " --image-size=300x200", "outside of an image of 300x200"}};
    for (const auto& k : cases)
    {
        const ToolResult result = runTool(calib + k.arguments);
        CAPTURE(k.arguments, result.err);
        CHECK(result.code == 1);
        CHECK(result.err.find(k.words) != std::string::npos);
    }
    std::ofstream(folder / "u.csv") << "id,u1,v1,u2,v2\na,1,2,3,\n";
    REQUIRE(runTool(tank.inputs(folder)).code == 0);
    std::string text = readFile(folder / "calib.yml");
    const size_t key = text.find("window_of_camera: [");
    REQUIRE(key != std::string::npos);
    std::ofstream(folder / "short.yml") << text.replace(key, text.find(']', key) + 1 - key, "window_of_camera: [ 1, 1 ]");
    const ToolResult cut = runTool("refract_measure " + folder / "short.yml --points=" + folder / "u.csv");
    CHECK(cut.code == 1);
    CHECK(cut.err.find("window_of_camera must have one whole number for each of 3 cameras") != std::string::npos);
    const ToolResult half = runTool("refract_measure " + folder / "calib.yml --points=" + folder / "u.csv");
    CHECK(half.code == 1);
    CHECK(half.err.find("line 2: u2 and v2") != std::string::npos);
}

namespace {

//! A scene file of cameras side by side that look at a chessboard through windows of their own, images of 320 x 240.
void writeWallOfCameras(const std::string& path, int count, int pairs, int seed)
{
    scenes::Random random(seed);
    FileStorage fs(path, FileStorage::WRITE);
    Matx33d R1;
    Vec3d t1;
    std::vector<Matx33d> Rs;
    std::vector<Vec3d> Ts;
    for (int c = 0; c < count; c++)
    {
        const Vec3d centre(80.*(c % 4) - 120., 80.*(c/4) - 40., 0), z = normalize(Vec3d(0, 0, 620) - centre);
        const Vec3d x = normalize(Vec3d(0, 1, 0).cross(z)), y = z.cross(x);
        const Matx33d R(x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]);
        const Vec3d t = -(R*centre);
        if (c == 0)
        {
            R1 = R;
            t1 = t;
        }
        Rs.push_back(R*R1.t());
        Ts.push_back(t - Rs.back()*t1);
        const Mat K = (Mat_<double>(3, 3) << 560, 0, 160 + 0.2*c, 0, 560, 120, 0, 0, 1);
        const GlassWindow window(Vec3d(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 1), 20., 1.5, 60.);
        const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, Mat((Mat_<double>(4, 1) << -0.1, 0.05, 0, 0)), window);
        camera->setImageSize(Size(320, 240));
        fs << format("camera%d", c + 1) << "{";
        camera->write(fs);
        fs << "}";
    }
    for (int c = 1; c < count; c++)
    {
        const std::string number = c == 1 ? "" : std::to_string(c + 1);
        fs << "R" + number << Mat(Rs[c]) << "T" + number << Mat(Ts[c]);
    }
    fs << "target" << "{" << "pattern" << "chessboard" << "size" << "6x5" << "square" << 26. << "}";
    fs << "exposure" << "{" << "noise" << 1. << "blur" << 0.6 << "vignetting" << 0. << "}" << "seed" << seed;
    fs << "poses" << "{" << "pair" << "{" << "count" << pairs << "distance" << "[" << 560. << 700. << "]" << "tilt_deg" << "["
       << 10. << 30. << "]" << "roll_deg" << 10. << "margin" << 4. << "}" << "}";
    fs << "sets" << "{" << "direct" << "{" << "window" << 0 << "poses" << "[" << "pair" << "]" << "}"
       << "glass" << "{" << "window" << 1 << "poses" << "[" << "pair" << "]" << "}" << "}";
}

std::string rigImages(const std::string& folder, int count)
{
    std::string text;
    for (int c = 1; c <= count; c++)
    {
        const std::string number = c == 1 ? "" : std::to_string(c), folders = std::to_string(c) + "/*.png'";
        text += " --direct" + number + "='" + folder + "/direct" + folders + " --glass" + number + "='" + folder + "/glass" + folders;
    }
    return text;
}

//! RMS difference of the R and T of all cameras to those of the truth: degrees, and in the unit of length.
std::pair<double, double> placeErrors(const std::string& path, const std::string& truthPath, int count)
{
    const FileStorage file(path, FileStorage::READ), truth(truthPath, FileStorage::READ);
    double degrees = 0, lengths = 0;
    for (int c = 1; c < count; c++)
    {
        const std::string number = c == 1 ? "" : std::to_string(c + 1);
        Mat R, T, trueR, trueT;
        file["R" + number] >> R;
        file["T" + number] >> T;
        truth["R" + number] >> trueR;
        truth["T" + number] >> trueT;
        Vec3d turn;
        Rodrigues(Mat(R*trueR.t()), turn);
        degrees += turn.dot(turn)/(count - 1);
        lengths += std::pow(norm(T.reshape(1, 3), trueT.reshape(1, 3)), 2)/(count - 1);
    }
    return {std::sqrt(degrees)*180/CV_PI, std::sqrt(lengths)};
}

} // namespace

TEST_CASE("Four simulated cameras from images to measured points", "[calib_rig]")
{
    const TemporaryFolder folder;
    writeWallOfCameras(folder / "RIG.yml", 4, 5, 11);
    REQUIRE(runTool("refract_simulate " + folder / "RIG.yml --quiet --out-dir=" + folder.path().string()).code == 0);
    const ToolResult calib = runTool("refract_calib --quiet --no-cross-validation --lens=opencv4 --size=6x5 --square=26 "
                                     "--thickness=20 --index=1.5" + rigImages(folder.path().string(), 4)
                                     + " --out=" + folder / "calib.yml");
    CAPTURE(calib.err);
    REQUIRE(calib.code == 0);
    const auto errors = placeErrors(folder / "calib.yml", folder / "truth.yml", 4);
    CAPTURE(errors.first, errors.second);
    CHECK(errors.first < 0.5);
    CHECK(errors.second < 5.);
    std::string images;
    for (int c = 1; c <= 4; c++)
        images += " '" + folder/format("glass%d/*.png'", c);
    const ToolResult measure = runTool("refract_measure " + folder / "calib.yml" + images + " --size=6x5 --square=26 --out="
                                       + folder / "points.csv");
    CAPTURE(measure.err, measure.out);
    REQUIRE(measure.code == 0);
    auto columns = columnsOf(readFile(folder / "points.csv"));
    REQUIRE(columns["u4"].size() == 150);
    CHECK(std::count(columns["status"].begin(), columns["status"].end(), 0.) >= 148);
}

TEST_CASE("Sixteen simulated cameras with known poses, exact and uncertain", "[.calib_rig16]")
{
    const int CAMERAS = 16;
    const TemporaryFolder folder;
    writeWallOfCameras(folder / "RIG.yml", CAMERAS, 6, 12);
    REQUIRE(runTool("refract_simulate " + folder / "RIG.yml --quiet --out-dir=" + folder.path().string()).code == 0);
    const std::string calib = "refract_calib --lens=opencv4 --size=6x5 --square=26 --thickness=20 --index=1.5"
                              + rigImages(folder.path().string(), CAMERAS);
    // What the robot says: the truth, and the truth with its deviations.
    std::ifstream truth(folder / "poses.csv");
    std::ofstream noisy(folder / "noisy.csv");
    scenes::Random random(5400);
    std::string line;
    std::getline(truth, line);
    noisy << line << ",sigma_deg,sigma\n";
    while (std::getline(truth, line))
    {
        std::istringstream cells(line);
        std::string view, cell;
        std::getline(cells, view, ',');
        std::vector<double> numbers;
        while (std::getline(cells, cell, ','))
            numbers.push_back(std::stod(cell));
        const double degree = CV_PI/180;
        Matx33d R, turn;
        Rodrigues(Vec3d(numbers[0], numbers[1], numbers[2])*degree, R);
        Rodrigues(Vec3d(random.normal(0.01), random.normal(0.01), random.normal(0.01))*degree, turn);
        Vec3d r;
        Rodrigues(turn*R, r);
        noisy << view;
        for (int i = 0; i < 3; i++)
            noisy << format(",%.12g", r[i]/degree);
        for (int i = 3; i < 6; i++)
            noisy << format(",%.12g", numbers[i] + random.normal(0.1));
        noisy << ",0.01,0.1\n";
    }
    noisy.close();
    for (const std::string poses : {"", "poses.csv", "noisy.csv"})
    {
        const ToolResult result = runTool(calib + (poses.empty() ? "" : " --poses=" + folder / poses) + " --report="
                                          + folder / "report.html --out=" + folder / "calib.yml");
        CAPTURE(poses, result.err);
        CHECK(result.code == 0);
        const auto errors = placeErrors(folder / "calib.yml", folder / "truth.yml", CAMERAS);
        std::cout << "[numbers] 16 cameras, poses " << (poses.empty() ? "unknown" : poses == "poses.csv" ? "exact"
                  : "within 0.1 mm and 0.01 deg") << ": R within " << errors.first << " deg, T within " << errors.second
                  << " mm RMS" << std::endl;
        CHECK(errors.first < 0.5);
        CHECK(errors.second < 5.);
    }
}

TEST_CASE("Too few points of a view are refused with camera, view and count", "[calib_rig]")
{
    const auto csvOf = [](int points) {
        std::string text = "view,x,y,z,u,v\n";
        for (const char* name : {"a", "b"})
            for (int i = 0; i < points; i++)
                text += format("%s,%d,%d,0,%d,%d\n", name, 40*(i % 2), 30*(i/2), 200 + 60*(i % 2), 200 + 50*(i/2));
        return text;
    };
    const TemporaryFolder folder;
    writeFile(folder / "few.csv", csvOf(3));
    writeFile(folder / "points.csv", csvOf(6));
    const std::string calib = "refract_calib --quiet --image-size=640x480 --thickness=10 --index=1.5 --out=" + folder / "c.yml";
    const ToolResult glass = runTool(calib + " --free=intrinsics --glass=" + folder / "few.csv");
    CHECK(glass.code == 1);
    CHECK_THAT(glass.err, Catch::Contains("camera 1, --glass=") && Catch::Contains("view 'a' has 3 points, but")
                          && !Catch::Contains("objectPoints"));
    const ToolResult direct = runTool(calib + " --glass=" + folder / "points.csv --direct=" + folder / "few.csv");
    CHECK(direct.code == 1);
    CHECK_THAT(direct.err, Catch::Contains("camera 1, --direct=") && Catch::Contains("view 'a' has 3 points"));
    CHECK(folder.count() == 2);
}
