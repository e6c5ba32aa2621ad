// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SOLID_TEXTURE_HPP
#define REFRACT_TOOLS_SOLID_TEXTURE_HPP

#include <opencv2/core.hpp>
#include <vector>

namespace tools {

struct TextureOptions
{
    double size = 0.;           //!< of the coarsest grains; each octave halves it
    double contrast = 0.8;      //!< 0: none, 1: the darkest grains are nearly black
    int octaves = 8;
};

/* A texture that fills space, as the grain of wood or stone does: whatever surface is cut through it is textured, and all cameras
see the same there. The sum of several octaves of gradient noise, all of the same strength, so that it looks alike at all ranges.
The gradients come from a hash of the lattice point: no tables, the same on every machine. */
class SolidTexture
{
public:
    SolidTexture(const TextureOptions& options, uint64_t seed);

    /** Share of a surface's colour that the texture leaves, 1 - contrast ... 1.
    @param spacing between neighbouring samples there: octaves that they are too coarse for are left out, as they would give
    each camera another pattern */
    double at(const cv::Vec3d& point, double spacing) const;

private:
    struct Octave
    {
        double size;
        uint64_t seed;
    };

    cv::Matx33d turn_;          //!< so that usual planes are not parallel to the lattice
    double contrast_, scale_;
    std::vector<Octave> octaves_;
};

} // namespace tools

#endif // REFRACT_TOOLS_SOLID_TEXTURE_HPP
