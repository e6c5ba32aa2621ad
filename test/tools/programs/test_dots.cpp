// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_calib with a target of dots on several levels: from images, from tables of pixels, and of a real tank.
#include "../target/drawn_dots.hpp"
#include "paths.hpp"
#include "run_tool.hpp"
#include "wand_scene.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <filesystem>
#include <iomanip>

using namespace cv;
using namespace cv::refract;

namespace {

const std::vector<Point3d> DOTS = drawn_dots::threeLevels();
const char* const WINDOW = " --thickness=6 --index=1.5 --outer-index=1.333 --distance=100 --exact --no-cross-validation";

//! Two cameras before the two sides of a tank, and places of the target.
struct Tank
{
    Ptr<RefractiveCamera> cameras[2];
    Vec3d rvec[2], tvec[2];                 //!< of the target's first place, in each camera

    explicit Tank(const TemporaryFolder& f)
    {
        const Vec3d normals[2] = {normalize(Vec3d(0.15, -0.05, 1)), normalize(Vec3d(-0.1, 0.08, 1))};
        for (int c = 0; c < 2; c++)
        {
            const Matx33d K(2600, 0, 640, 0, 2600, 512, 0, 0, 1);
            RefractiveCamera::create(K, noArray())->save(f / format("k%d.yml", c + 1));
            cameras[c] = RefractiveCamera::create(K, noArray(), GlassWindow(normals[c], 6, 1.5, 100, 1.333));
            cameras[c]->setImageSize(Size(1280, 1024));
            rvec[c] = c ? Vec3d(-0.2, 0.35, 0.1) : Vec3d(0.2, -0.3, 0.05);
            tvec[c] = Vec3d(5, 2, 330);
        }
    }
    //! The target moved within the tank, by the same as both cameras see it.
    void moved(int view, int camera, Vec3d& r, Vec3d& t) const
    {
        const Vec3d turn(0.1*view, -0.08*view, 0.3*view), shift(2*view, -view, 6*view);
        composeRT(turn, shift, rvec[camera], tvec[camera], r, t);
    }
    std::vector<Point2d> pixels(int view, int camera) const
    {
        Vec3d r, t;
        moved(view, camera, r, t);
        std::vector<Point2d> seen;
        refractiveProjectPoints(DOTS, r, t, cameras[camera], seen);
        return seen;
    }
    Mat picture(int view, int camera, scenes::Random& random) const
    {
        Vec3d r, t;
        moved(view, camera, r, t);
        return drawn_dots::picture(DOTS, 0.6, r, t, cameras[camera], random);
    }
};

void writeDots(const std::string& path)
{
    std::ofstream out(path);
    out << "id,x,y,z\n";
    for (size_t i = 0; i < DOTS.size(); i++)
        out << "p" << i << "," << DOTS[i].x << "," << DOTS[i].y << "," << DOTS[i].z << "\n";
}

double degreesOff(const TemporaryFolder& f, const Tank& tank, int camera)
{
    const Vec3d found = RefractiveCamera::read(f / "calib.yml", format("camera%d", camera + 1))->window().normal;
    return std::asin(std::min(1., norm(found.cross(tank.cameras[camera]->window().normal))))*180/CV_PI;
}

ToolResult calibrate(const TemporaryFolder& f, const std::string& sources)
{
    return runTool("refract_calib --target=" + (f / "dots.csv") + sources + " --camera=" + (f / "k1.yml") + " --camera2=" + (f / "k2.yml")
                   + WINDOW + " --out=" + (f / "calib.yml"));
}

} // namespace

TEST_CASE("refract_calib finds the dots of several levels in images, whatever names say before the moment", "[tools][dots]")
{
    std::cout << "seed " << scenes::seed() << '\n';
    const TemporaryFolder f;
    const Tank tank(f);
    scenes::Random random(4520);
    writeDots(f / "dots.csv");
    for (int c = 0; c < 2; c++)
        for (int view = 0; view < 3; view++)
            imwrite(f / format("%s_%d_view%d.png", c ? "b77" : "a12", 17*view + c, view), tank.picture(view, c, random));
    const std::string sources = " --glass='" + (f / "a12*.png") + "' --glass2='" + (f / "b77*.png") + "'";
    const ToolResult r = calibrate(f, sources + " --view-pattern='*_*_{}'");
    CAPTURE(r.out, r.err);
    REQUIRE((r.code == 0 || r.code == 2));
    for (int c = 0; c < 2; c++)
    {
        std::cout << "[numbers] dots on three levels, three rendered views, camera " << c + 1 << ": normal " << degreesOff(f, tank, c)
                  << " degrees off\n";
        CHECK(degreesOff(f, tank, c) < 0.5);
    }
    CHECK(calibrate(f, sources).code == 1);         // no moment in common
    CHECK(mentions(calibrate(f, sources + " --view-pattern='x{}'").err, "has no name of this form"));
    CHECK(mentions(calibrate(f, sources + " --view-pattern='{}_*_*'").err, "both are of the moment 'a12'"));
    CHECK(mentions(calibrate(f, sources + " --view-pattern='*_view'").err, "{} must stand in it once"));
}

TEST_CASE("refract_calib takes tables of pixels of any program, where --target says what was seen", "[tools][dots]")
{
    const TemporaryFolder f;
    const Tank tank(f);
    writeDots(f / "dots.csv");
    std::ofstream own(f / "own.csv"), openLpt(f / "long.csv");
    own << "image,id,u1,v1,u2,v2\n";
    openLpt << "frame,cam_id,pt_idx,x,y\n";
    for (int view = 0; view < 3; view++)
        for (size_t i = 0; i < DOTS.size(); i++)
        {
            own << view << ",p" << i;
            for (int c = 0; c < 2; c++)
            {
                const Point2d p = tank.pixels(view, c)[i];
                own << std::setprecision(12) << "," << p.x << "," << p.y;
                openLpt << std::setprecision(12) << view << "," << c << ",p" << i << "," << p.x << "," << p.y << "\n";
            }
            own << "\n";
        }
    own.close();
    openLpt.close();
    for (const char* name : {"own.csv", "long.csv"})
    {
        const std::string sources = " --glass=" + (f / name) + " --glass2=" + (f / name) + " --image-size=1280x1024";
        const ToolResult r = calibrate(f, sources);
        CAPTURE(name, r.out, r.err);
        REQUIRE((r.code == 0 || r.code == 2));
        for (int c = 0; c < 2; c++)
            CHECK(degreesOff(f, tank, c) < 1e-3);
    }
    std::ofstream(f / "bad.csv") << "image,id,u1,v1\n1,p0,3,4\n1,q,5,6\n";
    const std::string both = " --glass=" + (f / "bad.csv") + " --glass2=" + (f / "bad.csv") + " --image-size=1280x1024";
    CHECK(mentions(calibrate(f, both).err, "line 3: --target has no point 'q'"));
}

TEST_CASE("refract_calib takes tables of which each camera has its own file", "[tools][dots]")
{
    const TemporaryFolder f;
    const Tank tank(f);
    std::ofstream dots(f / "dots.csv");
    dots << "id,x,y,z\n";
    for (size_t i = 0; i < DOTS.size(); i++)
        dots << i << "," << DOTS[i].x << "," << DOTS[i].y << "," << DOTS[i].z << "\n";
    dots.close();
    for (int c = 0; c < 2; c++)
    {
        std::ofstream targets(f / format("cam%d.10001_targets", c + 1)), lab(f / format("lab%d.csv", c));
        const std::vector<Point2d> pixels = tank.pixels(1, c);
        targets << DOTS.size() << "\n";
        lab << "scorer" << std::string(3*DOTS.size(), ',') << "\nbodyparts";
        for (size_t i = 0; i < DOTS.size(); i++)
        {
            targets << format("%zu %.9f %.9f 9 3 3 900 %zu\n", i, pixels[i].x + 0.5, pixels[i].y + 0.5, i);
            lab << "," << i << "," << i << "," << i;
        }
        lab << "\ncoords";
        for (size_t i = 0; i < DOTS.size(); i++)
            lab << ",x,y,likelihood";
        for (int view = 0; view < 2; view++)
        {
            lab << "\n" << view;
            for (const Point2d& p : tank.pixels(view, c))
                lab << format(",%.9f,%.9f,0.99", p.x, p.y);
        }
    }
    for (const char* const pattern : {"cam%d.10001_targets", "lab%d.csv"})
    {
        const std::string sources = " --glass=" + (f / pattern) + " --glass2=" + (f / pattern) + " --image-size=1280x1024";
        const ToolResult r = calibrate(f, sources);
        CAPTURE(pattern, r.out, r.err);
        REQUIRE((r.code == 0 || r.code == 2));
        for (int c = 0; c < 2; c++)
            CHECK(degreesOff(f, tank, c) < 1e-3);
        // The other tools measure the same target by the same tables.
        const ToolResult m = runTool("refract_measure " + (f / "calib.yml") + " " + (f / pattern) + " " + (f / pattern) + " --target="
                                     + (f / "dots.csv") + " --out=" + (f / "points.csv"));
        CAPTURE(m.out, m.err);
        CHECK(m.code == 0);
        CHECK(mentions(readFile(f / "points.csv"), ",11,"));
    }
    CHECK(mentions(calibrate(f, " --glass=" + (f / "cam%d.none") + " --glass2=" + (f / "cam%d.none") + " --image-size=9x9").err,
                   "there is no file"));
    CHECK(mentions(runTool("refract_calib --glass=" + (f / "lab%d.csv") + " --image-size=1280x1024 --camera=" + (f / "k1.yml")
                           + " --outer-index=1.333 --out=" + (f / "o.yml")).err, "--target=FILE must say where these are"));
}

TEST_CASE("refract_measure and refract_check take a target of dots, as refract_calib does", "[tools][dots]")
{
    const TemporaryFolder f;
    const Tank tank(f);
    scenes::Random random(4525);
    writeDots(f / "dots.csv");
    for (int c = 0; c < 2; c++)
        for (int view = 0; view < 3; view++)
            imwrite(f / format("%c%d.png", "ab"[c], view), tank.picture(view, c, random));
    const std::string sources = " --glass='" + (f / "a*.png") + "' --glass2='" + (f / "b*.png") + "'";
    const std::string target = " --target=" + (f / "dots.csv");
    const ToolResult calibrated = calibrate(f, sources);
    CAPTURE(scenes::seed(), calibrated.out, calibrated.err);
    REQUIRE((calibrated.code == 0 || calibrated.code == 2));
    const ToolResult m = runTool("refract_measure " + (f / "calib.yml") + " " + (f / "a1.png") + " " + (f / "b1.png") + target + " --out="
                                 + (f / "points.csv"));
    CAPTURE(m.out, m.err);
    CHECK(m.code == 0);
    const std::vector<wand::Row> rows = wand::rowsOf(f / "points.csv");
    REQUIRE(rows.size() == DOTS.size());
    Vec3d r, t;
    tank.moved(1, 0, r, t);
    Matx33d R;
    Rodrigues(r, R);
    int count = 0;
    for (const wand::Row& row : rows)
    {
        if (std::isnan(row.X().x))
            continue;
        const int i = std::stoi(row.id.substr(1));          // p0, p1, ...
        const Vec3d off = Vec3d(row.X()) - R*Vec3d(DOTS[i]) - t;
        CHECK(std::abs(off[0]) < 5*row.fromEnd(4));
        CHECK(std::abs(off[2]) < 5*row.fromEnd(2));
        count++;
    }
    CHECK(count > (int)DOTS.size()/2);
    CHECK(runTool("refract_check " + (f / "calib.yml") + sources + target).code == 0);
    CHECK(mentions(runTool("refract_check " + (f / "calib.yml") + sources + target + " --size=6x5").err, "--size"));
    CHECK(mentions(runTool("refract_measure " + (f / "calib.yml") + " --points=" + (f / "x.csv") + target).err, "leave --size and"));
}

TEST_CASE("openptv_cavity: two cameras of a real tank in one command, from one image each", "[tools][dots][real]")
{
    const std::string tank = paths::data() + "/openptv_cavity/cal/";
    if (!std::filesystem::exists(tank + "cam3.tif"))
    {
        WARN("SKIPPED: there is no '" << tank << "cam3.tif'");
        return;
    }
    const TemporaryFolder f;
    const ToolResult r = runTool("refract_calib --target=" + tank + "target_on_a_side.txt --glass=" + tank + "cam3.tif --glass2=" + tank
                                 + "cam4.tif --shared-window --lens=pinhole --free=intrinsics --thickness=6 --index=1.46 "
                                   "--outer-index=1.33 --distance=433 --exact --no-cross-validation --verbose --out=" + (f / "calib.yml"));
    CAPTURE(r.out, r.err);
    REQUIRE((r.code == 0 || r.code == 2));
    std::istringstream numbers(r.out.substr(r.out.find("RMS through the window, px") + 26));
    for (int camera : {3, 4})
    {
        double rms = 0.;
        numbers >> rms;
        std::cout << "[numbers] openptv_cavity, camera " << camera << ", from the image to the calibration: " << rms << " px RMS\n";
        CHECK(rms > 0.);
        CHECK(rms < 1.);
    }
}
