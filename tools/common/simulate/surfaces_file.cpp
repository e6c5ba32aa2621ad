// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/surfaces_file.hpp"
#include "console/failure.hpp"
#include "console/keys.hpp"

#include <opencv2/core.hpp>
#include <cmath>

namespace tools {

using cv::FileNode;
using cv::Vec3d;
using std::make_shared;

namespace {

const double SMALLEST = 1e-9, LARGEST = 1e9;        // lengths, in any unit

using SurfacePtr = std::shared_ptr<const Surface>;

Vec3d readColor(const Keys& keys)
{
    const Vec3d color = keys.vector("color", Vec3d(1, 1, 1));
    for (int i = 0; i < 3; i++)
        if (!(color[i] >= 0 && color[i] <= 1))
            throw Failure(keys.name() + ": 'color' must be red, green and blue from 0 to 1");
    return color;
}

//! Unit vector.
Vec3d readDirection(const Keys& keys, const std::string& key)
{
    const Vec3d direction = keys.vector(key);
    const double length = cv::norm(direction);
    if (!(length > 0 && std::isfinite(length)))
        throw Failure(keys.name() + ": '" + key + "' must not be 0");
    return direction*(1/length);
}

SurfacePtr readPlane(const Keys& keys)
{
    keys.allowOnly({"shape", "color", "point", "normal", "right", "half_size"});
    const Vec3d point = keys.vector("point"), normal = readDirection(keys, "normal");
    if (keys.has("right") != keys.has("half_size"))
        throw Failure(keys.name() + ": 'right' and 'half_size' make a rectangle together; leave both out for an endless plane");
    if (!keys.has("right"))
        return make_shared<Plane>(point, normal, readColor(keys));
    const Vec3d right = readDirection(keys, "right");
    const std::vector<double> half = keys.numbers("half_size", 2);
    if (!(half[0] > 0 && half[1] > 0))
        throw Failure(keys.name() + ": 'half_size' must be two numbers more than 0");
    if (cv::norm(right.cross(normal)) < 1e-6)
        throw Failure(keys.name() + ": 'right' must not be along 'normal'");
    return make_shared<Plane>(point, normal, right, cv::Size2d(half[0], half[1]), readColor(keys));
}

SurfacePtr readSphere(const Keys& keys)
{
    keys.allowOnly({"shape", "color", "center", "radius"});
    return make_shared<Sphere>(keys.vector("center"), keys.number("radius", SMALLEST, LARGEST), readColor(keys));
}

SurfacePtr readSurface(const Keys& keys)
{
    const std::string shape = keys.text("shape", "");
    if (shape == "plane")
        return readPlane(keys);
    if (shape == "sphere")
        return readSphere(keys);
    throw Failure(keys.name() + ": 'shape' must be plane or sphere");
}

TextureOptions readTexture(const FileNode& node, const std::string& filename)
{
    const Keys keys(node, "'" + filename + "': texture");
    keys.allowOnly({"size", "contrast", "octaves"});
    TextureOptions texture;
    texture.size = keys.number("size", SMALLEST, LARGEST);
    texture.contrast = keys.number("contrast", 0, 1, texture.contrast);
    texture.octaves = (int)keys.number("octaves", 1, 32, texture.octaves);
    return texture;
}

} // namespace

TexturedScene readSurfaces(const FileNode& scene, const FileNode& texture, const std::string& filename)
{
    TexturedScene result;
    if (!scene.isSeq() || scene.size() == 0)
        throw Failure("'" + filename + "': 'scene' must be a list of shapes, as in - { shape: sphere, ... }");
    if (texture.empty())
        throw Failure("'" + filename + "': a 'scene' needs a 'texture: { size: ... }', the size of its coarsest grains");
    result.texture = readTexture(texture, filename);
    for (const FileNode& node : scene)
        result.surfaces.push_back(readSurface(Keys(node, "'" + filename + "': scene, shape "
                                                         + std::to_string(result.surfaces.size() + 1))));
    return result;
}

} // namespace tools
