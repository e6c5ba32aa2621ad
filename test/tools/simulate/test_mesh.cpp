// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Meshes against planes and against each triangle alone; what files of them must hold.
#include "console/failure.hpp"
#include "scenes.hpp"
#include "simulate/mesh_file.hpp"
#include "simulate/surfaces_file.hpp"
#include "temporary_folder.hpp"

#include <opencv2/calib3d.hpp>
#include <fstream>

using namespace cv;
using namespace tools;
using cv::refract::GlassWindow;
using cv::refract::RefractiveCamera;

namespace {

//! A cube of side 2 round the origin, six quadrilaterals.
const int CORNERS = 8, SIDES = 6;
const int SIDE[SIDES][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
Vec3d corner(int i) { return Vec3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1); }

void write(const std::string& path, const std::string& text)
{
    std::ofstream(path, std::ios::binary) << text;
}

std::string cubePly()
{
    std::ostringstream out;
    out << "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 6\n"
           "property list uchar int vertex_indices\nend_header\n";
    for (int i = 0; i < CORNERS; i++)
        out << corner(i)[0] << " " << corner(i)[1] << " " << corner(i)[2] << "\n";
    for (const auto& side : SIDE)
        out << "4 " << side[0] << " " << side[1] << " " << side[2] << " " << side[3] << "\n";
    return out.str();
}

std::string cubeObj()
{
    std::ostringstream out;
    out << "# a cube\n";
    for (int i = 0; i < CORNERS; i++)
        out << "v " << corner(i)[0] << " " << corner(i)[1] << " " << corner(i)[2] << "\n";
    for (const auto& side : SIDE)
        out << "f " << side[0] + 1 << " " << side[1] + 1 << " " << side[2] + 1 << " " << side[3] + 1 << "\n";
    return out.str();
}

TexturedScene sceneFrom(const std::string& shapes, const std::string& folder)
{
    const FileStorage fs("%YAML:1.0\n---\ntexture: { size: 60. }\nscene:\n" + shapes, FileStorage::READ | FileStorage::MEMORY);
    std::vector<std::string> meshes;
    return readSurfaces(fs["scene"], fs["texture"], folder + "/rig.yml", meshes);
}

Viewpoint view(const GlassWindow& window)
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d(400, 0, 160, 0, 400, 120, 0, 0, 1), noArray(), window);
    camera->setImageSize(Size(320, 240));
    return {camera, Matx33d::eye(), Vec3d()};
}

//! The cube's six sides as rectangles.
TexturedScene cubeOfPlanes(const Vec3d& rvec, const Vec3d& tvec, double scale)
{
    Matx33d R;
    Rodrigues(rvec, R);
    TexturedScene scene;
    for (int axis = 0; axis < 3; axis++)
        for (const double side : {-1., 1.})
        {
            Vec3d normal, right;
            normal[axis] = side;
            right[(axis + 1)%3] = 1;
            scene.surfaces.push_back(std::make_shared<Plane>(R*normal*scale + tvec, R*normal, R*right, Size2d(scale, scale),
                                                             Vec3d(1, 1, 1)));
        }
    return scene;
}

} // namespace

TEST_CASE("a cube read from PLY or OBJ is that of six rectangles, with and without window", "[simulate][mesh]")
{
    const TemporaryFolder folder;
    write(folder / "cube.ply", cubePly());
    write(folder / "cube.OBJ", cubeObj());
    const TexturedScene planes = cubeOfPlanes(Vec3d(0.5, 0.3, -0.2), Vec3d(20, -10, 600), 120);
    for (const std::string file : {"cube.ply", "cube.OBJ"})
    {
        const TexturedScene mesh = sceneFrom("   - { shape: mesh, file: " + file + ", rvec: [ 0.5, 0.3, -0.2 ], "
                                             "tvec: [ 20., -10., 600. ], scale: 120. }\n", folder.path().string());
        for (const GlassWindow& window : {GlassWindow(), GlassWindow(Vec3d(-0.2, 0.1, 1), 25, 1.517, 60)})
        {
            const Mat expected = depthOfScene(planes, view(window)), found = depthOfScene(mesh, view(window));
            CAPTURE(file);
            CHECK(countNonZero(expected == expected) > 15000);
            CHECK(scenes::largestDifference(expected, found) < 1e-3);       // float32 at 600: 6e-5
        }
    }
}

TEST_CASE("no ray slips through between triangles", "[simulate][mesh]")
{
    // The rays of whole pixels meet the diagonals and edges of this cube, in the camera's axes, exactly.
    const TemporaryFolder folder;
    write(folder / "cube.ply", cubePly());
    const TexturedScene cube = sceneFrom("   - { shape: mesh, file: cube.ply, tvec: [ 0., 0., 600. ], scale: 200. }\n",
                                         folder.path().string());
    const Mat depth = depthOfScene(cube, view(GlassWindow()));
    CHECK(countNonZero(depth == 400) == 320*240);
}

TEST_CASE("a mesh's first triangle is the first of all its triangles", "[simulate][mesh]")
{
    CAPTURE(scenes::seed());
    scenes::Random random(921);
    for (const int count : {1, 2, 3, 4, 5, 17, 300})
    {
        std::vector<Triangle> triangles;
        std::vector<Mesh> alone;
        for (int i = 0; i < count; i++)
        {
            const Vec3d centre = random.vector(50);
            triangles.push_back({centre + random.vector(40), centre + random.vector(40), centre + random.vector(40)});
            alone.emplace_back(std::vector<Triangle>{triangles.back()}, Vec3d(1, 1, 1));
        }
        const Mesh mesh(triangles, Vec3d(1, 1, 1));
        int met = 0, wrong = 0;
        for (int i = 0; i < 2000; i++)
        {
            const Vec3d from = random.vector(100), direction = random.vector(50) - from;
            const SceneRay ray{from, normalize(direction), i % 2 ? 0. : 40.};
            Intersection expected, found;
            for (const Mesh& triangle : alone)
                triangle.intersect(ray, expected);
            const bool any = mesh.intersect(ray, found);
            met += any;
            wrong += any != std::isfinite(found.s) || found.s != expected.s || (any && found.s <= ray.least)
                     || (any && norm(found.normal - expected.normal) > 1e-12);
            // What was met before stays where it is nearer.
            Intersection before;
            before.s = 0.5*expected.s;
            if (any && mesh.intersect(ray, before))
                wrong++;
        }
        CAPTURE(count);
        CHECK(met > 10);
        CHECK(wrong == 0);
    }
}

TEST_CASE("files without triangles are refused in a sentence that names them", "[simulate][mesh]")
{
    const TemporaryFolder folder;
    const std::string head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    const std::string face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    write(folder / "empty.ply", "");
    write(folder / "noise.ply", "not a mesh\n");
    write(folder / "noise.obj", "\x01\x02\n");
    write(folder / "points.ply", head + "end_header\n0 0 0\n1 0 0\n0 1 0\n");
    write(folder / "points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    write(folder / "lines.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n");
    write(folder / "flat.ply", head + face + "0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n");
    write(folder / "outside.ply", head + face + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n");
    write(folder / "nan.ply", head + face + "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n");
    write(folder / "mesh.txt", cubePly());
    for (const std::string name : {"empty.ply", "noise.ply", "noise.obj", "points.ply", "points.obj", "lines.obj", "flat.ply",
                                   "outside.ply", "nan.ply", "mesh.txt", "none.ply"})
    {
        CAPTURE(name);
        std::string text;
        try { readTriangles(folder/name, "scene, shape 1: 'file'"); }
        catch (const Failure& e) { text = e.what(); }
        CAPTURE(text);
        CHECK(text.find(folder/name) != std::string::npos);
        CHECK(text.find("scene, shape 1: 'file'") == 0);
    }
}
