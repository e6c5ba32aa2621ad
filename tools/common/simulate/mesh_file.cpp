// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/mesh_file.hpp"
#include "console/failure.hpp"

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <algorithm>
#include <cctype>
#include <filesystem>

namespace tools {

using cv::Vec3d;

namespace {

std::string extensionOf(const std::string& path)
{
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return std::tolower(c); });
    return extension;
}

bool namesItsVertices(const aiMesh& mesh)
{
    for (unsigned i = 0; i < mesh.mNumFaces; i++)
        for (unsigned corner = 0; corner < mesh.mFaces[i].mNumIndices; corner++)
            if (mesh.mFaces[i].mIndices[corner] >= mesh.mNumVertices)
                return false;
    return true;
}

void addTriangles(const aiMesh& mesh, std::vector<Triangle>& triangles)
{
    for (unsigned i = 0; i < mesh.mNumFaces; i++)
    {
        const aiFace& face = mesh.mFaces[i];
        if (face.mNumIndices != 3)
            continue;
        Triangle triangle;
        for (int corner = 0; corner < 3; corner++)
        {
            const aiVector3D& p = mesh.mVertices[face.mIndices[corner]];
            triangle[corner] = Vec3d(p.x, p.y, p.z);
        }
        triangles.push_back(triangle);
    }
}

//! A triangle without area, or with a corner nowhere, cannot be seen.
bool isVisible(const Triangle& t)
{
    const double area = cv::norm((t[1] - t[0]).cross(t[2] - t[0]));
    return area > 0 && std::isfinite(area) && cv::checkRange(t[0]);
}

} // namespace

std::vector<Triangle> readTriangles(const std::string& path, const std::string& name)
{
    if (extensionOf(path) != ".ply" && extensionOf(path) != ".obj")
        throw Failure(name + ": '" + path + "' must be a mesh in a file .ply or .obj");
    if (!std::filesystem::is_regular_file(path))
        throw Failure(name + ": there is no file '" + path + "'");
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(path, 0);
    if (!scene)
        throw Failure(name + ": cannot read '" + path + "': " + importer.GetErrorString());
    for (unsigned i = 0; i < scene->mNumMeshes; i++)        // before anything follows them
        if (!namesItsVertices(*scene->mMeshes[i]))
            throw Failure(name + ": '" + path + "' is not a mesh: a face refers to a missing vertex");
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
    std::vector<Triangle> triangles;
    for (unsigned i = 0; i < scene->mNumMeshes; i++)
        addTriangles(*scene->mMeshes[i], triangles);
    triangles.erase(std::remove_if(triangles.begin(), triangles.end(), [](const Triangle& t) { return !isVisible(t); }),
                    triangles.end());
    if (triangles.empty())
        throw Failure(name + ": '" + path + "' holds no triangle; a cloud of points or lines cannot be rendered");
    return triangles;
}

} // namespace tools
