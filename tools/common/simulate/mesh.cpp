// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tools {

using cv::Vec3d;
using Box = Eigen::AlignedBox3d;

namespace {

// Of a triangle's size: neighbours overlap by so much, so that no ray slips through between them.
const double OVERLAP = 1e-10;

Eigen::Vector3d toEigen(const Vec3d& v) { return Eigen::Vector3d(v[0], v[1], v[2]); }

//! A little larger than the triangle: a flat box has no inside, and rounding must not put a ray beside it.
Box boxOf(const Triangle& triangle)
{
    Box box;
    for (const Vec3d& corner : triangle)
        box.extend(toEigen(corner));
    const double margin = OVERLAP*(box.diagonal().norm() + box.max().cwiseAbs().maxCoeff() + box.min().cwiseAbs().maxCoeff());
    return Box(box.min().array() - margin, box.max().array() + margin);
}

//! What Eigen's tree asks at each box and each triangle on its way to the first one that the ray meets.
class Search
{
public:
    Search(const SceneRay& ray, const std::vector<Triangle>& triangles, Intersection& first)
        : ray_(ray), origin_(toEigen(ray.origin)), triangles_(triangles), first_(first)
    {
        for (int axis = 0; axis < 3; axis++)        // not 1/0, as 0*inf is no number
            inverse_[axis] = 1/(ray.direction[axis] == 0 ? 1e-300 : ray.direction[axis]);
    }

    bool found() const { return found_; }

    bool intersectVolume(const Box& box) const
    {
        const Eigen::Array3d a = (box.min() - origin_).array()*inverse_, b = (box.max() - origin_).array()*inverse_;
        return std::max(a.min(b).maxCoeff(), ray_.least) <= std::min(a.max(b).minCoeff(), first_.s);
    }

    //! Never the end: a triangle that comes later may be nearer.
    bool intersectObject(int number)
    {
        const Triangle& t = triangles_[number];
        const Vec3d side1 = t[1] - t[0], side2 = t[2] - t[0], across = ray_.direction.cross(side2);
        const double volume = across.dot(side1);
        const Vec3d offset = ray_.origin - t[0], turned = offset.cross(side1);
        const double u = offset.dot(across)/volume, v = ray_.direction.dot(turned)/volume, s = side2.dot(turned)/volume;
        if (u >= -OVERLAP && v >= -OVERLAP && u + v <= 1 + OVERLAP && s > ray_.least && s < first_.s)
        {
            first_ = {s, cv::normalize(side1.cross(side2))};
            found_ = true;
        }
        return false;
    }

private:
    const SceneRay& ray_;
    Eigen::Vector3d origin_;
    Eigen::Array3d inverse_;        //!< 1/direction
    const std::vector<Triangle>& triangles_;
    Intersection& first_;
    bool found_ = false;
};

} // namespace

Mesh::Mesh(const std::vector<Triangle>& triangles, const Vec3d& color) : Surface(color), triangles_(triangles)
{
    std::vector<int> numbers(triangles.size());
    std::iota(numbers.begin(), numbers.end(), 0);
    std::vector<Box> boxes;
    for (const Triangle& triangle : triangles)
        boxes.push_back(boxOf(triangle));
    tree_.init(numbers.begin(), numbers.end(), boxes.begin(), boxes.end());
}

bool Mesh::intersect(const SceneRay& ray, Intersection& first) const
{
    Search search(ray, triangles_, first);
    Eigen::BVIntersect(tree_, search);
    return search.found();
}

} // namespace tools
