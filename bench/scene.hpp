// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The scene that all rows share: the camera of Plate2024 behind 20 mm of tilted glass, and its parts for the reference.
#ifndef REFRACT_BENCH_SCENE_HPP
#define REFRACT_BENCH_SCENE_HPP

#include "reference.hpp"
#include <opencv2/refract.hpp>
#include <random>

namespace bench {

enum LensKind { FIVE, FOURTEEN, FISHEYE };

struct Scene
{
    //! outerIndex 1 = air behind the pane.
    Scene(LensKind lens, double outerIndex, bool second = false);

    LensKind kind;
    cv::Matx33d K;
    std::vector<double> D;
    cv::refract::GlassWindow window;
    cv::Ptr<cv::refract::RefractiveCamera> camera;

    //! The same camera for the reference (long double) and for the scalar program (double).
    template<typename T>
    reference::Camera<T> parts() const
    {
        reference::Camera<T> c;
        c.lens.fx = K(0, 0); c.lens.fy = K(1, 1); c.lens.cx = K(0, 2); c.lens.cy = K(1, 2);
        c.lens.fisheye = kind == FISHEYE;
        c.lens.k.fill(0);
        std::copy(D.begin(), D.end(), c.lens.k.begin());
        c.lens.tilt = tilt<T>(c.lens.k[12], c.lens.k[13]);
        // As the module, which has the normal in double.
        for (int i = 0; i < 3; i++)
            c.normal[i] = window.normal[i];
        const T length = std::sqrt(reference::dot(c.normal, c.normal));
        for (T& n : c.normal)
            n /= length;
        c.height.assign(1, window.distance);
        c.height.insert(c.height.end(), window.thickness.begin(), window.thickness.end());
        c.index.assign(1, window.innerIndex);
        c.index.insert(c.index.end(), window.index.begin(), window.index.end());
        c.index.push_back(window.outerIndex);
        return c;
    }

private:
    template<typename T>
    static std::array<T, 9> tilt(T tx, T ty)
    {
        if (tx == 0 && ty == 0)
            return { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
        const T cx = std::cos(tx), sx = std::sin(tx), cy = std::cos(ty), sy = std::sin(ty);
        const T R[3][3] = { { cy, sy*sx, -sy*cx }, { 0, cx, sx }, { sy, -cy*sx, cy*cx } };
        std::array<T, 9> H;
        for (int c = 0; c < 3; c++)
        {
            H[c] = R[2][2]*R[0][c] - R[0][2]*R[2][c];
            H[3 + c] = R[2][2]*R[1][c] - R[1][2]*R[2][c];
            H[6 + c] = R[2][c];
        }
        return H;
    }
};

const double WIDTH = 1280, HEIGHT = 1024, NEAREST = 300, FARTHEST = 1500;

//! Random pixels of the whole image, depths, and the scene points there.
struct Points
{
    Points(const Scene& scene, int count, unsigned seed = 1);
    std::vector<cv::Point2d> pixels;
    std::vector<double> depths;
    std::vector<cv::Point3d> points;
};

} // namespace bench

#endif // REFRACT_BENCH_SCENE_HPP
