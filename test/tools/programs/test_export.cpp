// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_export as a user runs it: what it writes is read by others, or as they would.
#include "run_tool.hpp"
#include "paths.hpp"
#include <opencv2/refract.hpp>
#include <catch2/catch.hpp>
#include <opencv2/calib3d.hpp>
#include <cmath>
#include <map>
#ifdef HAVE_MRCAL
extern "C" {       // mrcal.h has none of its own
#include <mrcal/mrcal.h>
}
#endif

using namespace cv;
using namespace cv::refract;

namespace {

const std::string CALIB = paths::bundled() + "/stereo/truth.yml", RANGE = " --depth=550,900";

//! The true rig, and points that both cameras see.
struct Rig
{
    Rig()
    {
        readRig(CALIB, cameras, Rs, Ts);
        RNG rng(3);
        while (points.size() < 40)
        {
            const Point3d X(rng.uniform(-150., 150.), rng.uniform(-150., 150.), rng.uniform(600., 850.));
            std::vector<Point2d> pixel[2];
            for (int c = 0; c < 2; c++)
                refractiveProjectPoints(std::vector<Point3d>{ X }, Rs[c], Ts[c], cameras[c], pixel[c]);
            const Rect2d image(0, 0, 1279, 1023);
            if (!image.contains(pixel[0][0]) || !image.contains(pixel[1][0]))
                continue;
            points.push_back(X);
            pixels[0].push_back(pixel[0][0]);
            pixels[1].push_back(pixel[1][0]);
        }
    }
    std::vector<Ptr<RefractiveCamera> > cameras;
    std::vector<Mat> Rs, Ts;
    std::vector<Point3d> points;
    std::vector<Point2d> pixels[2];
};

//! Largest distance, in pixels.
double worst(const std::vector<Point2d>& a, const std::vector<Point2d>& b)
{
    double most = 0;
    for (size_t i = 0; i < a.size(); i++)
        most = std::max(most, norm(a[i] - b[i]));
    return most;
}

std::vector<std::string> linesOf(const std::string& path)
{
    std::vector<std::string> lines;
    std::istringstream in(readFile(path));
    for (std::string line; std::getline(in, line); )
        if (line.empty() || line[0] != '#')
            lines.push_back(line);
    return lines;
}

std::vector<double> numbersOf(const std::string& line)
{
    std::vector<double> numbers;
    std::istringstream in(line);
    for (std::string word; in >> word; )
        numbers.push_back(std::atof(word.c_str()));
    return numbers;
}

} // namespace

TEST_CASE("refract_export says the unit of its lengths", "[tools][export]")
{
    const TemporaryFolder folder;
    writeFile(folder / "calib.yml", readFile(CALIB) + "unit: cm\n");
    const ToolResult result = runTool("refract_export " + folder / "calib.yml" + " --to=opencv" + RANGE + " --out="
                                      + folder / "central.yml");
    CAPTURE(result.out, result.err);
    REQUIRE(result.code == 0);
    CHECK(mentions(result.out, "rms, px  max, px  rms, cm  max, cm  moved by, cm\n"));
}

TEST_CASE("refract_export writes OpenCV's cameras, which see the points within the stated error", "[tools][export]")
{
    const TemporaryFolder folder;
    const std::string file = folder / "central.yml";
    const ToolResult result = runTool("refract_export " + CALIB + " --to=opencv" + RANGE + " --out=" + file);
    CAPTURE(result.out, result.err);
    REQUIRE(result.code == 0);
    CHECK(result.out.find("camera2") != std::string::npos);
    CHECK(mentions(result.out, "rms, px  max, px  rms, length  max, length  moved by\n"));        // CALIB does not say its unit
    CHECK(mentions(result.out, "Written: '" + file + "'"));
    const Rig rig;
    FileStorage fs(file, FileStorage::READ);
    for (int c = 0; c < 2; c++)
    {
        const FileNode node = fs[c ? "camera2" : "camera1"];
        Mat K, distortion, R, T, rvec;
        node["camera_matrix"] >> K;
        node["distortion_coefficients"] >> distortion;
        node["central_R"] >> R;
        node["central_T"] >> T;
        Rodrigues(R, rvec);
        std::vector<Point2d> seen;
        projectPoints(rig.points, rvec, T, K, distortion, seen);
        const double stated = node["central_error"]["max_px"];
        CHECK(worst(seen, rig.pixels[c]) < 1.05*stated);
        CHECK(stated < 1);
        // Whoever thinks that the true lens stands where the true camera is, is off by far more.
        refractiveProjectPoints(rig.points, rig.Rs[c], rig.Ts[c], rig.cameras[c]->cameraMatrix(), rig.cameras[c]->distCoeffs(),
                                GlassWindow(), seen);
        CHECK(worst(seen, rig.pixels[c]) > 5*stated);
    }
    // R, T from the one to the other.
    std::vector<Ptr<RefractiveCamera> > cameras;
    std::vector<Mat> Rs, Ts;
    readRig(file, cameras, Rs, Ts);
    const auto place = [&](int c, const char* key) {
        Mat m;
        fs[c ? "camera2" : "camera1"][key] >> m;
        return m;
    };
    CHECK(norm(Rs[1]*place(0, "central_R") - place(1, "central_R")) < 1e-12);
    CHECK(norm(Rs[1]*place(0, "central_T") + Ts[1] - place(1, "central_T")) < 1e-9);
}

TEST_CASE("refract_export writes mrcal's models", "[tools][export]")
{
    const TemporaryFolder folder;
    const ToolResult result = runTool("refract_export " + CALIB + " --to=mrcal" + RANGE + " --out-dir=" + (folder / "m"));
    CAPTURE(result.out, result.err);
    REQUIRE(result.code == 0);
    CHECK(mentions(result.out, "Written: '" + (folder / "m/camera1.cameramodel") + "', '" + (folder / "m/camera2.cameramodel") + "'"));
    const ToolResult same = runTool("refract_export " + CALIB + " --to=opencv" + RANGE + " --out=" + (folder / "c.yml"));
    REQUIRE(same.code == 0);
    const Ptr<RefractiveCamera> read = RefractiveCamera::read(folder / "m/camera2.cameramodel");
    CHECK(norm(read->lensParameters(), RefractiveCamera::read(folder / "c.yml", "camera2")->lensParameters(), NORM_INF) < 1e-9);
    CHECK(read->imageSize() == Size(1280, 1024));
#ifdef HAVE_MRCAL
    mrcal_cameramodel_t* model = mrcal_read_cameramodel_file((folder / "m/camera2.cameramodel").c_str());
    REQUIRE(model);
    const Rig rig;
    Matx33d R;
    Rodrigues(Vec3d(model->rt_cam_ref), R);
    double most = 0;
    for (size_t i = 0; i < rig.points.size(); i++)
    {
        const Vec3d X = R*Vec3d(rig.points[i]) + Vec3d(model->rt_cam_ref + 3);
        const mrcal_point3_t p = { { X[0], X[1], X[2] } };
        mrcal_point2_t q;
        REQUIRE(mrcal_project(&q, NULL, NULL, &p, 1, &model->lensmodel, model->intrinsics));
        most = std::max(most, norm(Point2d(q.x, q.y) - rig.pixels[1][i]));
    }
    CHECK(most < 1);
    mrcal_free_cameramodel(&model);
#endif
}

TEST_CASE("refract_export leaves the splined lens of a camera without a window splined for mrcal", "[tools][export]")
{
    const TemporaryFolder folder;
    std::vector<double> intrinsics(4 + 2*12*10, 0.);
    std::copy_n(std::vector<double>{ 700, 702, 640, 510 }.begin(), 4, intrinsics.begin());
    for (size_t k = 4; k < intrinsics.size(); k++)
        intrinsics[k] = 0.01*std::sin(0.7*(double)k);
    const Ptr<RefractiveCamera> camera = RefractiveCamera::createMrcal(
        "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=12_Ny=10_fov_x_deg=110", intrinsics);
    camera->setImageSize(Size(1280, 1024));
    camera->save(folder / "calib.yml");
    const ToolResult result = runTool("refract_export " + (folder / "calib.yml") + " --to=mrcal" + RANGE + " --out-dir=" + (folder / "m"));
    CAPTURE(result.out, result.err);
    REQUIRE(result.code == 0);
    const Ptr<RefractiveCamera> ours = RefractiveCamera::read(folder / "m/camera1.cameramodel");
    CHECK(ours->lensModel().find("LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=12_Ny=10_") == 0);
#ifdef HAVE_MRCAL
    mrcal_cameramodel_t* model = mrcal_read_cameramodel_file((folder / "m/camera1.cameramodel").c_str());
    REQUIRE(model);
    const mrcal_point3_t p = { { 100, -60, 700 } };
    mrcal_point2_t q;
    REQUIRE(mrcal_project(&q, NULL, NULL, &p, 1, &model->lensmodel, model->intrinsics));
    std::vector<Point2d> pixel;
    refractiveProjectPoints(std::vector<Vec3d>{ Vec3d(p.x, p.y, p.z) }, Vec3d(), Vec3d(), ours, pixel);
    CHECK(norm(pixel[0] - Point2d(q.x, q.y)) < 1e-9);
    mrcal_free_cameramodel(&model);
#endif
}

TEST_CASE("refract_export writes COLMAP's model, whose points and pixels belong together exactly", "[tools][export]")
{
    const TemporaryFolder folder;
    const Rig rig;
    std::ofstream csv(folder / "points.csv");
    csv << "image,id,u1,v1,u2,v2,x,y,z,sx,sy,sz,status\n";
    csv.precision(12);
    for (size_t i = 0; i < rig.points.size(); i++)
        csv << (i % 2 ? "a" : "b") << "," << i << "," << rig.pixels[0][i].x << "," << rig.pixels[0][i].y << "," << rig.pixels[1][i].x << ","
            << rig.pixels[1][i].y << "," << rig.points[i].x << "," << rig.points[i].y << "," << rig.points[i].z << ",1,1,1,0\n";
    csv << "a,99,10,10,,,nan,nan,nan,nan,nan,nan,7\n";      // without a place
    csv.close();
    const ToolResult result = runTool("refract_export " + CALIB + " --to=colmap" + RANGE + " --coefficients=8 --points="
                                      + (folder / "points.csv") + " --image-extension=.png --out-dir=" + (folder / "m"));
    CAPTURE(result.out, result.err);
    REQUIRE(result.code == 0);
    CHECK_THAT(readFile(folder / "m/images.txt"), Catch::Contains(" camera1/a.png\n") && Catch::Contains(" camera2/b.png\n"));
    const std::vector<std::string> cameras = linesOf(folder / "m/cameras.txt"), images = linesOf(folder / "m/images.txt"),
                                   points = linesOf(folder / "m/points3D.txt");
    REQUIRE(cameras.size() == 2);
    REQUIRE(images.size() == 2*4);      // two views, two cameras; two lines each
    REQUIRE(points.size() == rig.points.size());
    std::map<int, Point3d> places;
    for (const std::string& line : points)
    {
        const std::vector<double> n = numbersOf(line);
        places[(int)n[0]] = Point3d(n[1], n[2], n[3]);
        CHECK(n[7] < 1e-6);             // exact pixels have no error
    }
    int observed = 0;
    for (size_t i = 0; i < images.size(); i += 2)
    {
        const std::vector<double> head = numbersOf(images[i]), seen = numbersOf(images[i + 1]);
        const std::vector<double> camera = numbersOf(cameras[(int)head[8] - 1]);
        CHECK(cameras[(int)head[8] - 1].find("FULL_OPENCV 1280 1024") != std::string::npos);
        const Matx33d K(camera[4], 0, camera[6], 0, camera[5], camera[7], 0, 0, 1);
        const std::vector<double> distortion(camera.begin() + 8, camera.end());
        const Vec3d axis(head[2], head[3], head[4]);
        const Vec3d rvec = norm(axis) > 0 ? axis*(2*std::atan2(norm(axis), head[1])/norm(axis)) : Vec3d();
        for (size_t k = 0; k + 2 < seen.size(); k += 3)
        {
            std::vector<Point2d> expected;
            projectPoints(std::vector<Point3d>{ places.at((int)seen[k + 2]) }, rvec, Vec3d(head[5], head[6], head[7]), K, distortion,
                          expected);
            CHECK(norm(expected[0] - Point2d(seen[k], seen[k + 1])) < 1e-5);
            observed++;
        }
    }
    CHECK(observed == 2*(int)rig.points.size());
}

TEST_CASE("refract_export writes ROS's CameraInfo of a pair with its rectification", "[tools][export]")
{
    const TemporaryFolder folder;
    const ToolResult result = runTool("refract_export " + CALIB + " --to=ros --coefficients=8" + RANGE + " --out-dir=" + (folder / "m"));
    CAPTURE(result.out, result.err);
    REQUIRE(result.code == 0);
    const std::string text = readFile(folder / "m/camera2.yaml");
    for (const char* part : { "image_width: 1280", "image_height: 1024", "camera_name: camera2", "distortion_model: rational_polynomial",
                              "distortion_coefficients:\n  rows: 1\n  cols: 8\n", "rectification_matrix:\n  rows: 3\n  cols: 3\n",
                              "projection_matrix:\n  rows: 3\n  cols: 4\n", "rms " })
        CHECK(text.find(part) != std::string::npos);
    // Tx = -fx B of the second camera is what stereo nodes read.
    const std::string data = text.substr(text.find("data: [", text.find("projection_matrix")) + 7);
    double P[4];
    CHECK(std::sscanf(data.c_str(), "%lf, %lf, %lf, %lf", P, P + 1, P + 2, P + 3) == 4);
    const Rig rig;
    CHECK(std::abs(P[3]/P[0]) == Approx(norm(rig.Ts[1])).epsilon(0.05));
}

TEST_CASE("refract_export says what it cannot do, and leaves nothing behind", "[tools][export]")
{
    const TemporaryFolder folder;
    const std::string out = " --out=" + (folder / "c.yml"), call = "refract_export " + CALIB;
    const auto refused = [&](const std::string& options, const std::string& why) {
        const ToolResult result = runTool(call + options);
        CAPTURE(options, result.err);
        CHECK(result.code == 1);
        CHECK(result.err.find(why) != std::string::npos);
        CHECK(folder.count() == 0);
    };
    refused(" --to=opencv --depth=900,550" + out, "--depth");
    refused(" --to=opencv --depth=550" + out, "--depth");
    refused(" --to=opencv --depth=1,40" + out, "beyond its window");
    refused(" --to=opencv --depth=1e-9,1e9" + out, "beyond its window");
    refused(" --to=opencv" + RANGE, "--out=FILE");
    refused(" --to=mrcal" + RANGE + out, "--out-dir=DIR");
    refused(" --to=mrcal --coefficients=14" + RANGE + " --out-dir=" + (folder / "m"), "--coefficients=14");
    refused(" --to=opencv --points=x.csv" + RANGE + out, "--points");
    refused(" --to=colmap --points=" + (folder / "none.csv") + RANGE + " --out-dir=" + (folder / "m"), "none.csv");
    refused(" --to=nobody" + RANGE + out, "--to");
    CHECK(runTool(call + " --to=opencv --max-error=1e-6" + RANGE + out).code == 2);
    CHECK(folder.count() == 1);
}

TEST_CASE("refract_export tells COLMAP for cameras under water what each camera saw, as it is", "[tools][export]")
{
    const TemporaryFolder folder;
    const Rig rig;
    for (const Ptr<RefractiveCamera>& camera : rig.cameras)
    {
        GlassWindow window = camera->window();
        window.wedge.clear();
        camera->setWindow(window);
    }
    writeRig(folder / "calib.yml", rig.cameras, rig.Rs, rig.Ts);
    std::ofstream csv(folder / "points.csv");
    csv.precision(12);
    csv << "image,id,u1,v1,u2,v2,x,y,z,sx,sy,sz,status\n";
    for (size_t i = 0; i < rig.points.size(); i++)
        csv << "a," << i << "," << rig.pixels[0][i].x << "," << rig.pixels[0][i].y << "," << rig.pixels[1][i].x << ","
            << rig.pixels[1][i].y << "," << rig.points[i].x << "," << rig.points[i].y << "," << rig.points[i].z << ",1,1,1,0\n";
    csv.close();
    const ToolResult result = runTool("refract_export " + (folder / "calib.yml") + " --to=colmap-underwater --points="
                                      + (folder / "points.csv") + " --out-dir=" + (folder / "m"));
    CAPTURE(result.err);
    REQUIRE(result.code == 0);
    const std::vector<std::string> cameras = linesOf(folder / "m/cameras.txt"), images = linesOf(folder / "m/images.txt");
    REQUIRE(cameras.size() == 2);
    CHECK_THAT(cameras[1], Catch::Contains(" FLATPORT ") && !Catch::EndsWith(" "));
    REQUIRE(images.size() == 2*2);
    for (int c = 0; c < 2; c++)
    {
        const std::vector<double> seen = numbersOf(images[2*c + 1]);
        REQUIRE(seen.size() == 3*rig.points.size());
        for (size_t i = 0; i < rig.points.size(); i++)
            CHECK(norm(Point2d(seen[3*i], seen[3*i + 1]) - Point2d(0.5, 0.5) - rig.pixels[c][i]) < 1e-6);
    }
}

TEST_CASE("refract_export tells programs that have windows of lenses and windows exactly, or refuses", "[tools][export]")
{
    const std::string target = GENERATE("calibmar", "colmap-underwater"), to = " --to=" + target + " --out-dir=";
    const std::string file = target == "calibmar" ? "/camera1.yaml" : "/cameras.txt";
    const TemporaryFolder folder;
    const Matx33d K(900, 0, 640, 0, 910, 480, 0, 0, 1);
    GlassWindow flat(Vec3d(0.1, -0.05, 1), 12, 1.52, 30, 1.333), surface(Vec3d(0, 0.1, 1), 0, 1, 40, 1.333);
    surface.thickness.clear();
    surface.index.clear();
    const std::vector<Ptr<RefractiveCamera>> cameras = {
        RefractiveCamera::create(K, std::vector<double>{-0.1, 0.05, 0.001, -0.002, 0.01}, flat),
        RefractiveCamera::createFisheye(K, std::vector<double>{0.02, -0.01, 0.003, 0.001},
                                        GlassWindow::dome({1, -2, 3}, 50, 7, 1.49, 1.333)),
        RefractiveCamera::create(K, std::vector<double>{-0.1, 0.05, 0.001, -0.002}, surface), RefractiveCamera::create(K, noArray())};
    for (const Ptr<RefractiveCamera>& camera : cameras)
    {
        camera->setImageSize(Size(1280, 960));
        camera->save(folder / "calib.yml");
        const ToolResult result = runTool("refract_export " + (folder / "calib.yml") + to + (folder / "m"));
        CAPTURE(result.err);
        REQUIRE(result.code == 0);
        // Read again by the reader whose tests have their own formula.
        const ToolResult again = runTool("refract_export " + (folder / "m" + file) + to + (folder / "n"));
        REQUIRE(again.code == 0);
        std::string first = readFile(folder / "m" + file), second = readFile(folder / "n" + file);
        CHECK(first.substr(first.find('\n')) == second.substr(second.find('\n')));
        CHECK_THAT(first, Catch::Contains(target == "calibmar" ? "640.5, 480.5" : "640.5 480.5"));
    }
    GlassWindow wedged = flat;
    wedged.wedge = {Vec2d(1e-4, 0)};
    cameras[0]->setWindow(wedged);
    cameras[0]->save(folder / "calib.yml");
    const ToolResult refused = runTool("refract_export " + (folder / "calib.yml") + to + (folder / "m"));
    CHECK(refused.code == 1);
    CHECK(mentions(refused.err, "camera1 looks through a window with a wedge"));
    CHECK(runTool("refract_export " + CALIB + to + (folder / "x") + RANGE).code == 1);
    CHECK(runTool("refract_export " + CALIB + " --to=ros --out-dir=" + (folder / "x")).code == 1);
}
