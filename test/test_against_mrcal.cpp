// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Against mrcal, which this project did not write. Skipped where mrcal or its data are missing.
#include "scenes.hpp"
#include "temporary_file.hpp"
#include "paths.hpp"

#ifdef HAVE_MRCAL
extern "C" {        // mrcal 2.2 does not say so itself
#include <mrcal/mrcal.h>
#include <mrcal/triangulation.h>
}

#include <fstream>
#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

struct Model
{
    std::string name;
    std::vector<double> intrinsics;
    double halfField;           //!< degrees
};

//! OpenCV's with an own set of parameters, and all others that the tests of this project have.
std::vector<Model> models()
{
    const std::vector<double> core = { 1500, 1510, 960.5, 540.25 };
    std::vector<Model> all = {
        { "LENSMODEL_PINHOLE", {}, 60 },
        { "LENSMODEL_OPENCV4", { -0.28, 0.09, 7e-4, -4e-4 }, 40 },
        { "LENSMODEL_OPENCV5", { -0.3, 0.12, 1e-3, -5e-4, -0.01 }, 42 },
        { "LENSMODEL_OPENCV8", { 0.5, 0.03, 1e-4, -2e-4, 1e-4, 0.8, 0.1, 0.002 }, 60 },
        { "LENSMODEL_OPENCV12", { 0.4, 0.02, 2e-4, -1e-4, 1e-4, 0.7, 0.08, 0.001, 1e-3, -2e-4, -8e-4, 1e-4 }, 45 } };
    for (Model& m : all)
        m.intrinsics.insert(m.intrinsics.begin(), core.begin(), core.end());
    for (const LensKind& kind : allLenses())
        if (kind.isMrcal())
            all.push_back({ kind.model, kind.intrinsics(), kind.halfField });
    return all;
}

mrcal_lensmodel_t lensModel(const std::string& name)
{
    mrcal_lensmodel_t lens;
    REQUIRE(mrcal_lensmodel_from_name(&lens, name.c_str()));
    return lens;
}

std::vector<Vec2d> mrcalProject(const Model& m, const std::vector<Vec3d>& points)
{
    const mrcal_lensmodel_t lens = lensModel(m.name);
    std::vector<Vec2d> pixels(points.size());
    REQUIRE(mrcal_project((mrcal_point2_t*)pixels.data(), nullptr, nullptr, (const mrcal_point3_t*)points.data(),
                          (int)points.size(), &lens, m.intrinsics.data()));
    return pixels;
}

//! Unit directions; mrcal's are of any length, NaN where it found none.
std::vector<Vec3d> mrcalUnproject(const Model& m, const std::vector<Vec2d>& pixels)
{
    const mrcal_lensmodel_t lens = lensModel(m.name);
    std::vector<Vec3d> directions(pixels.size());
    REQUIRE(mrcal_unproject((mrcal_point3_t*)directions.data(), (const mrcal_point2_t*)pixels.data(), (int)pixels.size(),
                            &lens, m.intrinsics.data()));
    for (Vec3d& d : directions)
        d = normalize(d);
    return directions;
}

/* Compares both ways over the field; returns the worst projection and unprojection difference in pixels. */
Vec2d compare(const Model& m, Random& random)
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::createMrcal(m.name, m.intrinsics);
    std::vector<Vec3d> points, origins, directions;
    for (int i = 0; i < 5000; i++)
        points.push_back(random.logUniform(1, 1e4)*randomNormal(random, m.halfField));
    std::vector<Vec2d> ours, theirs = mrcalProject(m, points), again;
    std::vector<uchar> status;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, ours, status);
    CHECK(std::count(status.begin(), status.end(), REFRACT_OK) == (int)points.size());
    refractiveUnprojectPoints(ours, origins, directions, camera, status);
    // How far apart the two unprojections are, in pixels: project mrcal's direction with our lens.
    const mrcal_lensmodel_t lens = lensModel(m.name);
    const bool hasInverse = mrcal_lensmodel_metadata(&lens).has_gradients;      // CAHVORE of mrcal 2.2 has none
    const std::vector<Vec3d> bearings = hasInverse ? mrcalUnproject(m, ours) : directions;
    refractiveProjectPoints(bearings, Vec3d(), Vec3d(), camera, again);
    double worst = 0;
    for (size_t i = 0; i < ours.size(); i++)
    {
        REQUIRE(status[i] == REFRACT_OK);
        REQUIRE(norm(origins[i]) == 0);
        REQUIRE(norm(directions[i] - normalize(points[i])) < 1e-13);
        worst = std::max(worst, norm(again[i] - ours[i]));
    }
    return Vec2d(largestDifference(ours, theirs), worst);
}

bool haveData(const std::string& path)
{
    if (std::ifstream(path).good())
        return true;
    WARN("SKIPPED: " << path << " is not there; set REFRACT_DATA_DIR");
    return false;
}

std::string dataFile(const char* name) { return paths::data() + "/mrcal/" + name; }

} // namespace

TEST_CASE("Without window: mrcal_project and mrcal_unproject", "[against_mrcal]")
{
    CAPTURE(seed());
    Random random;
    for (const Model& m : models())
    {
        CAPTURE(m.name);
        const Vec2d worst = compare(m, random);
        CHECK(worst[0] < 1e-9);
        CHECK(worst[1] < 1e-7);
        printNumber(std::string("against mrcal, ") + m.name + ", project / unproject, worst",
                    std::to_string(worst[0]*1e12) + "e-12 / " + std::to_string(worst[1]*1e9) + "e-9", "px");
    }
}

TEST_CASE("mrcal's own camera models", "[against_mrcal]")
{
    CAPTURE(seed());
    Random random;
    for (const char* file : { "cam0.opencv8.cameramodel", "cam1.opencv8.cameramodel", "opencv8-0.cameramodel", "opencv8-1.cameramodel",
                              "cam0.splined.cameramodel", "cam1.splined.cameramodel", "splined-0.cameramodel",
                              "splined-1.cameramodel" })
    {
        const std::string path = dataFile(file);
        if (!haveData(path))
            return;
        CAPTURE(file);
        mrcal_cameramodel_t* theirs = mrcal_read_cameramodel_file(path.c_str());
        REQUIRE(theirs);
        const Ptr<RefractiveCamera> ours = RefractiveCamera::read(path);
        char name[128];
        REQUIRE(mrcal_lensmodel_name(name, sizeof(name), &theirs->lensmodel));
        const int count = mrcal_lensmodel_num_params(&theirs->lensmodel);
        const Model m = { name, std::vector<double>(theirs->intrinsics, theirs->intrinsics + count), 0 };
        CHECK(ours->lensModel() == m.name);
        CHECK(ours->imageSize() == Size((int)theirs->imagersize[0], (int)theirs->imagersize[1]));
        CHECK(largestDifference(ours->cameraMatrix(), Matx33d(m.intrinsics[0], 0, m.intrinsics[2], 0, m.intrinsics[1],
                                                              m.intrinsics[3], 0, 0, 1)) == 0);
        CHECK(largestDifference(ours->distCoeffs(), std::vector<double>(m.intrinsics.begin() + 4, m.intrinsics.end())) == 0);
        mrcal_free_cameramodel(&theirs);

        // Every hundredth pixel of the whole image; of the two that were fitted to images, where those had targets: at
        // the border their surfaces fold, and mrcal, too, finds no direction or one of several.
        const int border = std::string(file).find("splined-") == 0 ? 250 : 0;
        std::vector<Vec2d> pixels, again, projected;
        for (int y = border; y < ours->imageSize().height - border; y += 100)
            for (int x = border; x < ours->imageSize().width - border; x += 100)
                pixels.push_back(Vec2d(x, y));
        std::vector<Vec3d> origins, directions;
        std::vector<uchar> status;
        refractiveUnprojectPoints(pixels, origins, directions, ours, status);
        CHECK(std::count(status.begin(), status.end(), REFRACT_OK) == (int)pixels.size());
        refractiveProjectPoints(directions, Vec3d(), Vec3d(), ours, projected);
        CHECK(largestDifference(projected, mrcalProject(m, directions)) < 1e-9);
        CHECK(largestDifference(projected, pixels) < 1e-9);
        refractiveProjectPoints(mrcalUnproject(m, pixels), Vec3d(), Vec3d(), ours, again);
        const double worst = largestDifference(again, pixels);
        CHECK(worst < 1e-7);
        printNumber(std::string(file) + " against mrcal_unproject over the image, worst", worst, "px");
    }
}

TEST_CASE("mrcal reads what we save", "[against_mrcal]")
{
    using Catch::Matchers::Contains;
    for (const LensKind& kind : allLenses())
    {
        CAPTURE(kind.name);
        const TemporaryFile file(".cameramodel");
        const Ptr<RefractiveCamera> camera = makeCamera(kind, GlassWindow());
        CHECK_THAT(thrown([&] { camera->save(file.path); }), Contains(file.path) && Contains("setImageSize"));
        camera->setImageSize(Size(1280, 1024));
        if (!kind.isMrcal() && (kind.model != "opencv" || kind.coefficients.size() == 14))
        {
            CHECK_THAT(thrown([&] { camera->save(file.path); }), Contains(file.path) && Contains("mrcal has no lens"));
            continue;
        }
        camera->save(file.path);
        mrcal_cameramodel_t* theirs = mrcal_read_cameramodel_file(file.path.c_str());
        REQUIRE(theirs);
        CHECK(Size((int)theirs->imagersize[0], (int)theirs->imagersize[1]) == camera->imageSize());
        CHECK(norm(Vec6d(theirs->rt_cam_ref)) == 0);
        REQUIRE(mrcal_lensmodel_num_params(&theirs->lensmodel) == (int)kind.intrinsics().size());
        CHECK(std::equal(theirs->intrinsics, theirs->intrinsics + kind.intrinsics().size(), kind.intrinsics().begin()));
        mrcal_free_cameramodel(&theirs);
        const Ptr<RefractiveCamera> back = RefractiveCamera::read(file.path);
        CHECK(std::vector<double>(back->distCoeffs()) == kind.coefficients);
        CHECK(largestDifference(back->lensParameters(), camera->lensParameters()) == 0);
        camera->setWindow(GlassWindow(Vec3d(0, 0, 1), 10, 1.5, 50));
        CHECK_THAT(thrown([&] { camera->save(file.path); }), Contains("cannot state a window"));
    }
}

TEST_CASE("Derivatives by point and parameters as mrcal_project's", "[against_mrcal]")
{
    CAPTURE(seed());
    Random random;
    double worst = 0;
    for (const Model& m : models())
    {
        CAPTURE(m.name);
        const mrcal_lensmodel_t lens = lensModel(m.name);
        if (!mrcal_lensmodel_metadata(&lens).has_gradients)
            continue;
        const Ptr<RefractiveCamera> camera = RefractiveCamera::createMrcal(m.name, m.intrinsics);
        const int count = 1000, theirCount = (int)m.intrinsics.size(), ourCount = (int)camera->lensParameters().total();
        std::vector<Vec3d> points;
        for (int i = 0; i < count; i++)
            points.push_back(random.uniform(0.5, 2)*randomNormal(random, m.halfField));
        std::vector<Vec2d> pixels(count);
        Mat byPoint(2*count, 3, CV_64F), byIntrinsics(2*count, theirCount, CV_64F), J;
        REQUIRE(mrcal_project((mrcal_point2_t*)pixels.data(), byPoint.ptr<mrcal_point3_t>(), byIntrinsics.ptr<double>(),
                              (const mrcal_point3_t*)points.data(), count, &lens, m.intrinsics.data()));
        refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, pixels, noArray(), J);
        for (int i = 0; i < 2*count; i++)
        {
            worst = std::max(worst, norm(J.row(i).colRange(3, 6), byPoint.row(i))/norm(byPoint.row(i)));
            const Mat ofIntrinsics = byIntrinsics.row(i).colRange(0, ourCount);
            worst = std::max(worst, norm(J.row(i).colRange(6, 6 + ourCount), ofIntrinsics)/norm(ofIntrinsics));
        }
        CHECK(worst < 1e-9);
    }
    printNumber("derivatives against mrcal_project's, worst, relative", worst, "");
}

TEST_CASE("Derivatives by the control points of splines as mrcal_project's", "[against_mrcal]")
{
    CAPTURE(seed());
    Random random;
    double worst = 0;
    for (const Model& m : models())
    {
        if (m.name.find("SPLINED") == std::string::npos)
            continue;
        CAPTURE(m.name);
        const mrcal_lensmodel_t lens = lensModel(m.name);
        const Ptr<RefractiveCamera> camera = RefractiveCamera::createMrcal(m.name, m.intrinsics);
        const int count = 300, all = (int)m.intrinsics.size();
        std::vector<Vec3d> points;
        for (int i = 0; i < count; i++)
            points.push_back(random.uniform(0.5, 2)*randomNormal(random, m.halfField));
        std::vector<Vec2d> pixels(count);
        Mat byPoint(2*count, 3, CV_64F), theirs(2*count, all, CV_64F), which, weights;
        std::vector<uchar> status;
        REQUIRE(mrcal_project((mrcal_point2_t*)pixels.data(), byPoint.ptr<mrcal_point3_t>(), theirs.ptr<double>(),
                              (const mrcal_point3_t*)points.data(), count, &lens, m.intrinsics.data()));
        refractiveSplineWeights(points, Vec3d(), Vec3d(), camera, which, weights, status);
        for (int i = 0; i < count; i++)
        {
            REQUIRE(status[i] == REFRACT_OK);
            CHECK(std::abs(sum(weights.row(i))[0] - 1) < 1e-14);
            Mat ours = Mat::zeros(2, all, CV_64F);
            for (int k = 0; k < which.cols; k++)
                for (int axis = 0; axis < 2; axis++)
                    ours.at<double>(axis, 4 + 2*which.at<int>(i, k) + axis) = m.intrinsics[axis]*weights.at<double>(i, k);
            const Mat expected = theirs.rowRange(2*i, 2*i + 2);
            worst = std::max(worst, norm(ours.colRange(4, all), expected.colRange(4, all))/norm(expected.colRange(4, all)));
        }
    }
    CHECK(worst < 1e-9);
    printNumber("derivatives by control points against mrcal_project's, worst, relative", worst, "");
}

TEST_CASE("A pane in air leaves mrcal's bearing as it is", "[against_mrcal]")
{
    CAPTURE(seed());
    Random random;
    double worst = 0;
    for (const Model& m : models())
    {
        std::vector<Vec3d> bearings;
        for (int k = 0; k < 3000; k++)
            bearings.push_back(randomNormal(random, std::min(60., m.halfField)));     // less than what a tilted window hides
        const std::vector<Vec2d> pixels = mrcalProject(m, bearings);
        const Ptr<RefractiveCamera> camera = RefractiveCamera::createMrcal(m.name, m.intrinsics, makeWindow(PANE_IN_AIR, random));
        std::vector<Vec3d> origins, directions;
        std::vector<uchar> status;
        refractiveUnprojectPoints(pixels, origins, directions, camera, status);
        for (size_t k = 0; k < bearings.size(); k++)
        {
            CAPTURE(m.name, k);
            REQUIRE(status[k] == REFRACT_OK);
            worst = std::max(worst, norm(directions[k] - bearings[k]));
        }
    }
    CHECK(worst < 1e-12);
    printNumber("exit direction behind a pane in air against mrcal's bearing, worst", worst, "");
}

TEST_CASE("Refracted rays triangulate as with mrcal", "[against_mrcal]")
{
    CAPTURE(seed());
    Random random;
    double worstGeometric = 0, worstLindstrom = 0;
    for (WindowKind kind : allWindows())
    {
        CAPTURE(name(kind));
        const Model m = models()[1];
        const Ptr<RefractiveCamera> camera1 = RefractiveCamera::createMrcal(m.name, m.intrinsics, makeWindow(kind, random, 15));
        const Ptr<RefractiveCamera> camera2 = RefractiveCamera::createMrcal(m.name, m.intrinsics, makeWindow(kind, random, 15));
        Matx33d R;
        Rodrigues(Vec3d(0.02, -0.3, 0.01), R);
        const Vec3d T = -(R*Vec3d(220, 5, -30));
        std::vector<Vec3d> points, origins1, directions1, origins2, directions2, found;
        for (int i = 0; i < 300; i++)
            points.push_back(Vec3d(random.uniform(-80, 80), random.uniform(-80, 80), random.uniform(500, 900)));
        std::vector<Vec2d> pixels1, pixels2;
        std::vector<uchar> status1, status2, status;
        refractiveProjectPoints(points, Vec3d(), Vec3d(), camera1, pixels1, status1);
        refractiveProjectPoints(points, R, T, camera2, pixels2, status2);
        refractiveUnprojectPoints(pixels1, origins1, directions1, camera1);
        refractiveUnprojectPoints(pixels2, origins2, directions2, camera2);
        triangulateRefractive(camera1, camera2, R, T, pixels1, pixels2, found, status);
        int compared = 0;
        for (size_t i = 0; i < points.size(); i++)
        {
            if (status1[i] != REFRACT_OK || status2[i] != REFRACT_OK)
                continue;
            REQUIRE(status[i] == REFRACT_OK);
            // mrcal's cameras sit in the rays' origins: camera 0 in origin 1, camera 1 in origin 2.
            const Vec3d origin2 = R.t()*(origins2[i] - T), t01 = origin2 - origins1[i], v1 = R.t()*directions2[i];
            Vec3d geometric, lindstrom;
            const mrcal_point3_t g = mrcal_triangulate_geometric(nullptr, nullptr, nullptr, (const mrcal_point3_t*)&directions1[i],
                                                                 (const mrcal_point3_t*)&v1, (const mrcal_point3_t*)&t01);
            double Rt01[12];
            for (int k = 0; k < 9; k++)
                Rt01[k] = R.t().val[k];
            for (int k = 0; k < 3; k++)
                Rt01[9 + k] = t01[k];
            const mrcal_point3_t l = mrcal_triangulate_lindstrom(nullptr, nullptr, nullptr, (const mrcal_point3_t*)&directions1[i],
                                                                 (const mrcal_point3_t*)&directions2[i], (const mrcal_point3_t*)Rt01);
            geometric = Vec3d(g.x, g.y, g.z) + origins1[i];
            lindstrom = Vec3d(l.x, l.y, l.z) + origins1[i];
            worstGeometric = std::max(worstGeometric, norm(found[i] - geometric)/norm(points[i]));
            worstLindstrom = std::max(worstLindstrom, norm(found[i] - lindstrom)/norm(points[i]));
            compared++;
        }
        CHECK(compared > 50);
    }
    CHECK(worstGeometric < 1e-8);
    CHECK(worstLindstrom < 1e-8);
    printNumber("triangulation against mrcal_triangulate_geometric, worst share of the range", worstGeometric, "");
    printNumber("triangulation against mrcal_triangulate_lindstrom, worst share of the range", worstLindstrom, "");
}

namespace {

//! mrcal's place of a camera: reference -> camera.
struct Place { Matx33d R; Vec3d T; };

Place placeOf(const std::string& path)
{
    mrcal_cameramodel_t* model = mrcal_read_cameramodel_file(path.c_str());
    REQUIRE(model);
    Place place;
    Rodrigues(Vec3d(model->rt_cam_ref), place.R);
    place.T = Vec3d(model->rt_cam_ref + 3);
    mrcal_free_cameramodel(&model);
    return place;
}

} // namespace

TEST_CASE("Real correspondences triangulate as with mrcal", "[against_mrcal]")
{
    const std::string features = dataFile("features.imgany.inputimage.vnl");
    if (!haveData(features))
        return;
    const std::string lens = GENERATE("opencv8", "splined");
    const std::string path1 = dataFile((lens + "-0.cameramodel").c_str()), path2 = dataFile((lens + "-1.cameramodel").c_str());
    const Ptr<RefractiveCamera> camera1 = RefractiveCamera::read(path1), camera2 = RefractiveCamera::read(path2);
    const Place place1 = placeOf(path1), place2 = placeOf(path2);
    const Matx33d R = place2.R*place1.R.t(), R01 = R.t();
    const Vec3d T = place2.T - R*place1.T, t01 = -(R01*T);
    std::ifstream file(features);
    std::string head;
    std::getline(file, head);
    std::vector<Vec2d> pixels1, pixels2;
    for (Vec4d row; file >> row[0] >> row[1] >> row[2] >> row[3];)
    {
        pixels1.push_back(Vec2d(row[0], row[1]));
        pixels2.push_back(Vec2d(row[2], row[3]));
    }
    REQUIRE(pixels1.size() == 180);
    std::vector<Vec3d> origins, directions1, directions2, middles, likely;
    std::vector<uchar> status, likelyStatus;
    refractiveUnprojectPoints(pixels1, origins, directions1, camera1);
    refractiveUnprojectPoints(pixels2, origins, directions2, camera2);
    triangulateRefractive(camera1, camera2, R, T, pixels1, pixels2, middles, status, TRIANGULATE_MIDPOINT);
    triangulateRefractive(camera1, camera2, R, T, pixels1, pixels2, likely, likelyStatus);
    double worst = 0, worstLindstrom = 0;
    int compared = 0;
    for (size_t i = 0; i < pixels1.size(); i++)
    {
        CAPTURE(lens, i);
        const Vec3d v1 = R01*directions2[i];
        const mrcal_point3_t g = mrcal_triangulate_geometric(nullptr, nullptr, nullptr, (const mrcal_point3_t*)&directions1[i],
                                                             (const mrcal_point3_t*)&v1, (const mrcal_point3_t*)&t01);
        const Vec3d theirs(g.x, g.y, g.z);
        CHECK((status[i] == REFRACT_OK) == (norm(theirs) > 0));     // 0: the rays part
        if (status[i] != REFRACT_OK || norm(theirs) == 0)
            continue;
        compared++;
        worst = std::max(worst, norm(middles[i] - theirs)/norm(theirs));
        double Rt01[12];
        std::copy(R01.val, R01.val + 9, Rt01);
        std::copy(t01.val, t01.val + 3, Rt01 + 9);
        const mrcal_point3_t l = mrcal_triangulate_lindstrom(nullptr, nullptr, nullptr, (const mrcal_point3_t*)&directions1[i],
                                                             (const mrcal_point3_t*)&directions2[i], (const mrcal_point3_t*)Rt01);
        if (likelyStatus[i] == REFRACT_OK)
            worstLindstrom = std::max(worstLindstrom, norm(likely[i] - Vec3d(l.x, l.y, l.z))/norm(likely[i]));
    }
    CHECK(compared > 150);
    CHECK(worst < 1e-9);
    printNumber(lens + ", of 180 real correspondences triangulated", compared, "");
    printNumber(lens + ", TRIANGULATE_MIDPOINT against mrcal_triangulate_geometric, worst share of the range", worst, "");
    printNumber(lens + ", the most likely point in pixels against mrcal_triangulate_lindstrom's, worst share of the range",
                worstLindstrom, "");
}

#else

TEST_CASE("Against mrcal", "[against_mrcal]")
{
    WARN("SKIPPED: mrcal was not found when the tests were configured (Debian: libmrcal-dev)");
}

#endif
