// Against mrcal, which this project did not write. Skipped where mrcal or its data are missing.
#include "scenes.hpp"

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
    const char* name;
    std::vector<double> intrinsics;
};

std::vector<Model> models()
{
    const std::vector<double> core = { 1500, 1510, 960.5, 540.25 };
    std::vector<Model> all = {
        { "LENSMODEL_PINHOLE", {} },
        { "LENSMODEL_OPENCV4", { -0.28, 0.09, 7e-4, -4e-4 } },
        { "LENSMODEL_OPENCV5", { -0.3, 0.12, 1e-3, -5e-4, -0.01 } },
        { "LENSMODEL_OPENCV8", { 0.5, 0.03, 1e-4, -2e-4, 1e-4, 0.8, 0.1, 0.002 } },
        { "LENSMODEL_OPENCV12", { 0.4, 0.02, 2e-4, -1e-4, 1e-4, 0.7, 0.08, 0.001, 1e-3, -2e-4, -8e-4, 1e-4 } } };
    for (Model& m : all)
        m.intrinsics.insert(m.intrinsics.begin(), core.begin(), core.end());
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
Vec2d compare(const Model& m, double halfField, Random& random)
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::createMrcal(m.name, m.intrinsics);
    std::vector<Vec3d> points, origins, directions;
    for (int i = 0; i < 5000; i++)
        points.push_back(random.logUniform(1, 1e4)*randomNormal(random, halfField));
    std::vector<Vec2d> ours, theirs = mrcalProject(m, points), again;
    std::vector<uchar> status;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, ours, status);
    CHECK(std::count(status.begin(), status.end(), REFRACT_OK) == (int)points.size());
    refractiveUnprojectPoints(ours, origins, directions, camera, status);
    // How far apart the two unprojections are, in pixels: project mrcal's direction with our lens.
    const std::vector<Vec3d> bearings = mrcalUnproject(m, ours);
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

const double FIELDS[] = { 60, 40, 42, 60, 45 };

bool haveData(const std::string& path)
{
    if (std::ifstream(path).good())
        return true;
    WARN("SKIPPED: " << path << " is not there; set REFRACT_DATA_DIR");
    return false;
}

std::string dataFile(const char* name) { return std::string(REFRACT_DATA_DIR) + "/mrcal/" + name; }

} // namespace

TEST_CASE("Without window: mrcal_project and mrcal_unproject", "[against_mrcal]")
{
    CAPTURE(seed());
    Random random;
    int i = 0;
    for (const Model& m : models())
    {
        CAPTURE(m.name);
        const Vec2d worst = compare(m, FIELDS[i++], random);
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
    for (const char* file : { "cam0.opencv8.cameramodel", "cam1.opencv8.cameramodel", "opencv8-0.cameramodel", "opencv8-1.cameramodel" })
    {
        const std::string path = dataFile(file);
        if (!haveData(path))
            return;
        CAPTURE(file);
        mrcal_cameramodel_t* theirs = mrcal_read_cameramodel_file(path.c_str());
        REQUIRE(theirs);
        const Ptr<RefractiveCamera> ours = RefractiveCamera::read(path);
        Model m = { "LENSMODEL_OPENCV8", std::vector<double>(theirs->intrinsics, theirs->intrinsics + 12) };
        CHECK(theirs->lensmodel.type == MRCAL_LENSMODEL_OPENCV8);
        CHECK(ours->lensModel() == m.name);
        CHECK(ours->imageSize() == Size((int)theirs->imagersize[0], (int)theirs->imagersize[1]));
        CHECK(largestDifference(ours->lensParameters(), m.intrinsics) == 0);
        mrcal_free_cameramodel(&theirs);

        // Every hundredth pixel of the whole image.
        std::vector<Vec2d> pixels, again, projected;
        for (int y = 0; y < ours->imageSize().height; y += 100)
            for (int x = 0; x < ours->imageSize().width; x += 100)
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

TEST_CASE("A lens that is not known is refused by its name", "[against_mrcal]")
{
    const std::string path = dataFile("splined-0.cameramodel");
    if (!haveData(path))
        return;
    CHECK_THAT(thrown([&] { RefractiveCamera::read(path); }), Catch::Matchers::Contains("LENSMODEL_SPLINED_STEREOGRAPHIC"));
}

TEST_CASE("A pane in air leaves mrcal's bearing as it is", "[against_mrcal]")
{
    CAPTURE(seed());
    Random random;
    double worst = 0;
    int i = 0;
    for (const Model& m : models())
    {
        const double field = FIELDS[i++];
        std::vector<Vec3d> bearings;
        for (int k = 0; k < 3000; k++)
            bearings.push_back(randomNormal(random, field));
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

#else

TEST_CASE("Against mrcal", "[against_mrcal]")
{
    WARN("SKIPPED: mrcal was not found when the tests were configured (Debian: libmrcal-dev)");
}

#endif
