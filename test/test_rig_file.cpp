// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// readRig, writeRig: all cameras of a calibration file.
#include "scenes.hpp"
#include "temporary_file.hpp"
#include "temporary_folder.hpp"
#include "paths.hpp"

#include <fstream>
#ifndef _WIN32
#include <csignal>
#include <sys/resource.h>
#endif

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

struct Rig
{
    std::vector<Ptr<RefractiveCamera> > cameras;
    std::vector<Mat> Rs;
    std::vector<Vec3d> Ts;
    std::vector<int> windows;
    Mat covariance;
};

Rig makeRig(int count, Random& random)
{
    Rig rig;
    int parameters = 6*(count - 1);
    for (int c = 0; c < count; c++)
    {
        rig.cameras.push_back(makeCamera(allLenses()[c%allLenses().size()],
                                         makeWindow(allWindows()[c%allWindows().size()], random)));
        rig.cameras[c]->setImageSize(Size(1280 + c, 1024));
        Mat R;
        Rodrigues(c ? random.vector(0.5) : Vec3d(), R);
        rig.Rs.push_back(R);
        rig.Ts.push_back(c ? random.vector(300) : Vec3d());
        rig.windows.push_back(c/2);
        parameters += (int)rig.cameras[c]->parameterNames().size();
    }
    Mat root(parameters, parameters, CV_64F);
    for (double& number : Mat_<double>(root))
        number = random.normal(1e-3);
    rig.covariance = root*root.t();
    return rig;
}

Rig readAll(const std::string& path)
{
    Rig rig;
    readRig(path, rig.cameras, rig.Rs, rig.Ts, rig.windows, rig.covariance);
    return rig;
}

void checkSame(const Rig& a, const Rig& b)
{
    REQUIRE(a.cameras.size() == b.cameras.size());
    REQUIRE(a.Rs.size() == a.cameras.size());
    REQUIRE(a.Ts.size() == a.cameras.size());
    for (size_t c = 0; c < a.cameras.size(); c++)
    {
        CAPTURE(c);
        CHECK(a.cameras[c]->lensModel() == b.cameras[c]->lensModel());
        CHECK(a.cameras[c]->imageSize() == b.cameras[c]->imageSize());
        CHECK(largestDifference(a.cameras[c]->lensParameters(), b.cameras[c]->lensParameters()) == 0);
        CHECK(norm(a.cameras[c]->window().normal - b.cameras[c]->window().normal) < 1e-15);     // it is normalised
        CHECK(a.cameras[c]->window().shape == b.cameras[c]->window().shape);
        CHECK(a.cameras[c]->window().center == b.cameras[c]->window().center);
        CHECK(a.cameras[c]->window().radius == b.cameras[c]->window().radius);
        CHECK(a.cameras[c]->window().thickness == b.cameras[c]->window().thickness);
        CHECK(norm(a.Rs[c], b.Rs[c]) < 1e-15);     // the nearest rotation is taken
        CHECK(norm(a.Ts[c] - b.Ts[c]) == 0);
    }
    CHECK(a.windows == b.windows);
    REQUIRE(a.covariance.size() == b.covariance.size());
    CHECK((a.covariance.empty() || norm(a.covariance, b.covariance, NORM_INF) == 0));
}

std::string contentsOf(const std::string& path)
{
    std::ifstream file(path);
    return std::string(std::istreambuf_iterator<char>(file), {});
}

std::string replaced(std::string text, const std::string& from, const std::string& to)
{
    const size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

//! Three cameras without distortion in YAML, R and T as lists.
const std::string CAMERA = ":\n   camera_matrix: !!opencv-matrix\n      rows: 3\n      cols: 3\n      dt: d\n"
                           "      data: [ 1000., 0., 640., 0., 1000., 480., 0., 0., 1. ]\n";
const std::string THREE = "%YAML:1.0\n---\ncamera1" + CAMERA + "camera2" + CAMERA + "camera3" + CAMERA
    + "R: [ 0., 0.1, 0. ]\nT: [ -100., 0., 1. ]\nR3: [ 1., 0., 0., 0., 0., -1., 0., 1., 0. ]\nT3: [ 5., 6., 7. ]\n";

} // namespace

TEST_CASE("A rig of any number of cameras is read back to the last bit, in every format", "[rig_file]")
{
    CAPTURE(seed());
    const int count = GENERATE(1, 2, 3, 17);
    const std::string suffix = GENERATE(".yml", ".xml", ".json");
    CAPTURE(count, suffix);
    Random random(count);
    const TemporaryFile file(suffix, "what was there before");
    Rig rig = makeRig(count, random);
    writeRig(file.path, rig.cameras, rig.Rs, rig.Ts, rig.windows, rig.covariance);
    checkSame(readAll(file.path), rig);

    // Without what may be left out, and by the short form.
    writeRig(file.path, rig.cameras, rig.Rs, rig.Ts);
    rig.windows.clear();
    rig.covariance = Mat();
    checkSame(readAll(file.path), rig);
    Rig brief;
    readRig(file.path, brief.cameras, brief.Rs, brief.Ts);
    checkSame(brief, rig);
}

TEST_CASE("A rig's file is what RefractiveCamera::read and FileStorage read", "[rig_file]")
{
    Random random;
    const Rig rig = makeRig(4, random);
    const TemporaryFile file(".yml");
    writeRig(file.path, rig.cameras, rig.Rs, rig.Ts);
    const FileStorage fs(file.path, FileStorage::READ);
    for (int c = 0; c < 4; c++)
    {
        const std::string number = std::to_string(c + 1), own = c > 1 ? number : "";
        CHECK(RefractiveCamera::read(file.path, "camera" + number)->lensModel() == rig.cameras[c]->lensModel());
        Mat R, T;
        fs["R" + own] >> R;
        fs["T" + own] >> T;
        CHECK((c == 0 || norm(R, rig.Rs[c]) < 1e-15));
        CHECK((c == 0 || norm(T, Mat(rig.Ts[c])) == 0));
    }
    CHECK(fs["R1"].empty());
    CHECK(fs["R2"].empty());
    writeRig(file.path, { rig.cameras[1] }, noArray(), noArray());      // one camera: at the top level
    CHECK(RefractiveCamera::read(file.path)->lensModel() == rig.cameras[1]->lensModel());
    CHECK(FileStorage(file.path, FileStorage::READ)["camera1"].empty());
}

TEST_CASE("Rigs that the tools and mrcal write are read", "[rig_file]")
{
    const std::string path = paths::bundled() + "/stereo/truth.yml";
    const FileStorage fs(path, FileStorage::READ);
    REQUIRE(fs.isOpened());
    const Rig rig = readAll(path);
    REQUIRE(rig.cameras.size() == 2);
    Mat R, T;
    fs["R"] >> R;
    fs["T"] >> T;
    CHECK(norm(rig.Rs[1], R) < 1e-15);
    CHECK(norm(Mat(rig.Ts[1]), T) == 0);
    CHECK(norm(rig.Rs[0], Mat::eye(3, 3, CV_64F)) + norm(rig.Ts[0]) == 0);
    CHECK(largestDifference(rig.cameras[1]->lensParameters(), RefractiveCamera::read(path, "camera2")->lensParameters()) == 0);

    const TemporaryFile mrcal(".cameramodel", "{ 'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [ 1, 2, 3, 4 ] }");
    CHECK(readAll(mrcal.path).cameras.at(0)->lensModel() == "LENSMODEL_PINHOLE");
    CHECK(norm(readAll(mrcal.path).Rs.at(0), Mat::eye(3, 3, CV_64F)) == 0);
}

TEST_CASE("R and T may be lists and rotation vectors, as written by hand", "[rig_file]")
{
    const TemporaryFile file(".yml", THREE);
    const Rig rig = readAll(file.path);
    Mat R;
    Rodrigues(Vec3d(0, 0.1, 0), R);
    REQUIRE(rig.cameras.size() == 3);
    CHECK(norm(rig.Rs[1], R) < 1e-15);
    CHECK(rig.Rs[2].at<double>(2, 1) == 1);
    CHECK(rig.Ts[2] == Vec3d(5, 6, 7));
    CHECK(rig.windows.empty());
    CHECK(rig.covariance.empty());
}

TEST_CASE("A rig is read into lists of any kind, as a whole or not at all", "[rig_file]")
{
    const TemporaryFile file(".yml", THREE);
    const Rig rig = readAll(file.path);
    std::vector<Ptr<RefractiveCamera> > cameras;
    for (size_t before : { 0, 3, 7 })
    {
        std::vector<Vec3d> rvecs(before, Vec3d(1, 2, 3)), tvecs(before);
        REQUIRE_NOTHROW(readRig(file.path, cameras, rvecs, tvecs));
        REQUIRE((cameras.size() == 3 && rvecs.size() == 3 && tvecs.size() == 3));
        for (int c = 0; c < 3; c++)
        {
            Matx33d R;
            Rodrigues(rvecs[c], R);
            CHECK(norm(Mat(R), rig.Rs[c]) < 1e-14);
            CHECK(tvecs[c] == rig.Ts[c]);
        }
    }
    Mat rowOfR(1, 3, CV_64FC3), rowOfT(1, 3, CV_64FC3);
    readRig(file.path, cameras, rowOfR, rowOfT);
    CHECK((rowOfR.size() == Size(3, 1) && rowOfT.size() == Size(3, 1)));
    CHECK(rowOfT.at<Vec3d>(2) == rig.Ts[2]);
    std::vector<Vec3f> single;
    readRig(file.path, cameras, noArray(), single);
    CHECK((single.size() == 3 && single[2] == Vec3f(5, 6, 7)));

    std::vector<Matx33d> matrices(3);
    readRig(file.path, cameras, matrices, noArray());
    CHECK(norm(Mat(matrices[2]), rig.Rs[2]) < 1e-14);
    for (size_t wrong : { 0, 2 })
    {
        const Ptr<RefractiveCamera> mine = makeCamera(allLenses()[0], GlassWindow());
        std::vector<Vec3d> tvecs(1, Vec3d(1, 2, 3));
        std::vector<int> windows(1, 5);
        Mat covariance(1, 1, CV_64F, Scalar(9));
        matrices.assign(wrong, Matx33d::eye());
        cameras.assign(1, mine);
        const std::string text = thrown([&] { readRig(file.path, cameras, matrices, tvecs, windows, covariance); });
        CHECK_THAT(text, Contains("Rs must be") && Contains("Matx33d> of 3"));
        CHECK((cameras.size() == 1 && cameras[0] == mine && tvecs == std::vector<Vec3d>(1, Vec3d(1, 2, 3))));
        CHECK((windows == std::vector<int>(1, 5) && covariance.total() == 1 && covariance.at<double>(0) == 9));
    }
}

TEST_CASE("A file that is no rig is refused with its name and what is wrong", "[rig_file]")
{
    struct Bad { std::string text, what; };
    const Bad bads[] = {
        { "", "empty" },
        { "%YAML:1.0\n---\nother: 1\n", "camera" },
        { "%YAML:1.0\n---\n- 1\n", "camera" },
        { replaced(THREE, "T3: [ 5., 6., 7. ]\n", ""), "T3" },
        { replaced(THREE, "R:", "Q:"), "no R," },
        { replaced(THREE, "camera2:", "camera4:"), "no camera2" },
        { replaced(THREE, "camera1:", "camera0:"), "no camera1" },
        { replaced(THREE, "[ 5., 6., 7. ]", "[ 5., 6. ]"), "T3" },
        { replaced(THREE, "[ 5., 6., 7. ]", "[ 5., 6., .Nan ]"), "T3" },
        { replaced(THREE, "[ 5., 6., 7. ]", "here"), "T3" },
        { replaced(THREE, "-1., 0., 1., 0. ]", "1., 0., 1., 0. ]"), "R3" },
        { replaced(THREE, "1000., 0., 640.", "-1000., 0., 640."), "camera1" },
        { THREE + "window_of_camera: [ 0, 0 ]\n", "window_of_camera" },
        { THREE + "window_of_camera: [ 0, 0, 0.5 ]\n", "window_of_camera" },
        { THREE + "window_of_camera: none\n", "window_of_camera" },
        { THREE + "covariance: [ 1. ]\n", "covariance is 1x1" },
        { THREE + "covariance: one\n", "covariance" } };
    for (const Bad& bad : bads)
    {
        CAPTURE(bad.text, bad.what);
        const TemporaryFile file(".yml", bad.text);
        CHECK_THAT(thrown([&] { readAll(file.path); }), Contains(file.path) && Contains(bad.what));
    }
    CHECK_THAT(thrown([] { readAll("no/such/rig.yml"); }), Contains("no/such/rig.yml"));
}

TEST_CASE("A rig's file cut anywhere is read or refused by name; what is read is right", "[rig_file]")
{
    Random random;
    const Rig rig = makeRig(3, random);
    const std::string suffix = GENERATE(".yml", ".xml", ".json");
    const TemporaryFile file(suffix);
    writeRig(file.path, rig.cameras, rig.Rs, rig.Ts);
    const std::string text = contentsOf(file.path);
    for (size_t length = 0; length < text.size(); length += 83)
    {
        CAPTURE(suffix, length);
        const TemporaryFile cut(suffix, text.substr(0, length));
        std::vector<Ptr<RefractiveCamera> > cameras;
        std::vector<Mat> Rs, Ts;
        try { readRig(cut.path, cameras, Rs, Ts); }
        catch (const cv::Exception& e) { CHECK_THAT(e.what(), Contains(cut.path)); continue; }
        for (size_t c = 0; c < cameras.size(); c++)
            CHECK(norm(Rs[c], rig.Rs[c]) < 1e-15);
    }
}

TEST_CASE("A rig that cannot be written is named and leaves what was there", "[rig_file]")
{
    Random random;
    const Rig rig = makeRig(2, random);
    const TemporaryFolder folder;
    const std::string path = folder / "rig.yml";
    writeRig(path, rig.cameras, rig.Rs, rig.Ts);
    const std::string before = contentsOf(path);
    const auto refused = [&](const Rig& r)
    {
        const std::string sentence = thrown([&] { writeRig(path, r.cameras, r.Rs, r.Ts, r.windows, r.covariance); });
        CHECK(contentsOf(path) == before);
        CHECK(folder.count() == 1);
        return sentence;
    };
    Rig bad = rig;
    bad.cameras[1] = nullptr;
    CHECK_THAT(refused(bad), Contains("cameras[1] is empty"));
    bad = rig;
    bad.Rs.pop_back();
    CHECK_THAT(refused(bad), Contains("Rs has 1"));
    bad = rig;
    bad.Ts[0][2] = 3;
    CHECK_THAT(refused(bad), Contains("Ts[0]") && Contains("3"));
    bad = rig;
    bad.Rs[1] = Mat(rig.Rs[1]*2);
    CHECK_THAT(refused(bad), Contains("Rs[1] is not a rotation"));
    bad = rig;
    bad.windows = { 0 };
    CHECK_THAT(refused(bad), Contains("windowOfCamera has 1"));
    bad = rig;
    bad.covariance = Mat::eye(3, 3, CV_64F);
    CHECK_THAT(refused(bad), Contains("covariance is 3x3"));
    bad = rig;
    bad.covariance = rig.covariance.clone();
    bad.covariance.at<double>(1, 1) = NaN;
    CHECK_THAT(refused(bad), Contains("covariance"));
    bad.covariance = rig.covariance.clone();
    bad.covariance.at<double>(0, 1) += 0.1*std::sqrt(rig.covariance.at<double>(0, 0)*rig.covariance.at<double>(1, 1));
    CHECK_THAT(refused(bad), Contains("covariance is not symmetric"));
    CHECK_THAT(refused(Rig()), Contains("cameras is empty"));
    CHECK_THAT(thrown([&] { writeRig("no/such/folder/rig.yml", rig.cameras, rig.Rs, rig.Ts); }),
               Contains("no/such/folder/rig.yml"));
}

#ifndef _WIN32
TEST_CASE("A disk that is full is told, and leaves what was there", "[rig_file]")
{
    Random random;
    const Rig rig = makeRig(2, random);
    const TemporaryFolder folder;
    rlimit before;
    REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
    for (const char* name : { "rig.yml", "rig.xml", "rig.json", "rig.yml.gz" })
    {
        const std::string path = folder/name;
        writeRig(path, rig.cameras, rig.Rs, rig.Ts);
        const std::string old = contentsOf(path);
        const auto previous = std::signal(SIGXFSZ, SIG_IGN);
        const rlimit few = { 200, before.rlim_max };
        REQUIRE(setrlimit(RLIMIT_FSIZE, &few) == 0);
        const std::string sentence = thrown([&] { writeRig(path, rig.cameras, rig.Rs, rig.Ts, {}, rig.covariance); });
        setrlimit(RLIMIT_FSIZE, &before);
        std::signal(SIGXFSZ, previous);
        CAPTURE(name, old.size());
        CHECK_THAT(sentence, Contains(std::string(name) + " cannot be written"));
        CHECK(contentsOf(path) == old);
    }
    CHECK(folder.count() == 4);
}
#endif

TEST_CASE("A rig of mrcal is a numbered file for each camera", "[rig_file]")
{
    const TemporaryFolder folder;
    Random random;
    Rig rig;
    const Mat K = (Mat_<double>(3, 3) << 900, 0, 640, 0, 901, 512, 0, 0, 1);
    for (int c = 0; c < 3; c++)
    {
        rig.cameras.push_back(RefractiveCamera::create(K, std::vector<double>(c == 1 ? 8 : 4, 0.01*(c + 1))));
        rig.cameras[c]->setImageSize(Size(1280 + c, 1024));
        Mat R;
        Rodrigues(c ? random.vector(0.5) : Vec3d(), R);
        rig.Rs.push_back(R);
        rig.Ts.push_back(c ? random.vector(300) : Vec3d());
    }
    const std::string numbered = folder / "cam%d.cameramodel";
    writeRig(numbered, rig.cameras, rig.Rs, rig.Ts);
    CHECK(folder.count() == 3);
    CHECK(readAll(folder / "cam1.cameramodel").cameras.size() == 1);
    const Rig back = readAll(numbered);
    REQUIRE(back.cameras.size() == 3);
    for (int c = 0; c < 3; c++)
    {
        CHECK(norm(back.Rs[c], rig.Rs[c], NORM_INF) < 1e-14);
        CHECK(norm(back.Ts[c] - rig.Ts[c]) < 1e-11);
        CHECK(norm(back.cameras[c]->lensParameters(), rig.cameras[c]->lensParameters(), NORM_INF) == 0);
        CHECK(back.cameras[c]->imageSize() == rig.cameras[c]->imageSize());
    }
    // The frame that all share need not be camera 1's, nor need the numbers begin with 0.
    Matx33d R1;
    Rodrigues(Vec3d(0.3, -0.2, 0.1), R1);
    const Vec3d T1(10, 20, 30);
    for (int c = 0; c < 3; c++)
    {
        const Matx33d R = Matx33d(rig.Rs[c])*R1;
        const Vec3d T = Matx33d(rig.Rs[c])*T1 + rig.Ts[c];
        Vec3d rvec;
        Rodrigues(R, rvec);
        std::ofstream(folder / format("far%d.cameramodel", c + 1)) << format(
            "{'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [900, 901, 640, 512], "
            "'extrinsics': [%.17g, %.17g, %.17g, %.17g, %.17g, %.17g], 'imagersize': [1280, 1024]}",
            rvec[0], rvec[1], rvec[2], T[0], T[1], T[2]);
    }
    const Rig moved = readAll(folder / "far%d.cameramodel");
    REQUIRE(moved.cameras.size() == 3);
    for (int c = 0; c < 3; c++)
    {
        CHECK(norm(moved.Rs[c], rig.Rs[c], NORM_INF) < 1e-7);       // cv::Rodrigues
        CHECK(norm(moved.Ts[c] - rig.Ts[c]) < 1e-4);
    }
}

TEST_CASE("A rig that mrcal's files cannot state is refused, and none is written", "[rig_file]")
{
    const TemporaryFolder folder;
    Random random;
    const Rig rig = makeRig(2, random);
    const Mat K = Mat::eye(3, 3, CV_64F);
    std::vector<Ptr<RefractiveCamera> > plain(2);
    for (Ptr<RefractiveCamera>& camera : plain)
    {
        camera = RefractiveCamera::create(K, noArray());
        camera->setImageSize(Size(4, 4));
    }
    const std::string numbered = folder / "c%d.cameramodel", one = folder / "c.cameramodel";
    CHECK_THAT(thrown([&] { writeRig(numbered, rig.cameras, rig.Rs, rig.Ts); }), Contains("cannot state a window"));
    CHECK_THAT(thrown([&] { writeRig(one, plain, rig.Rs, rig.Ts); }), Contains("camera-%d.cameramodel"));
    plain[1]->setImageSize(Size());
    CHECK_THAT(thrown([&] { writeRig(numbered, plain, rig.Rs, rig.Ts); }), Contains("c1.cameramodel") && Contains("image size"));
    const Mat covariance = Mat::zeros(2*(4 + 6) + 6, 2*(4 + 6) + 6, CV_64F);
    CHECK_THAT(thrown([&] { writeRig(numbered, plain, rig.Rs, rig.Ts, {}, covariance); }), Contains("covariance"));
    CHECK(folder.count() == 0);
    CHECK_THAT(thrown([&] { readAll(numbered); }), Contains("c1.cameramodel"));
    std::ofstream(folder / "c0.cameramodel") << "{'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [9, 9, 6, 5], 'extrinsics': [1, 2]}";
    CHECK_THAT(thrown([&] { readAll(numbered); }), Contains("c0.cameramodel") && Contains("extrinsics"));
}
