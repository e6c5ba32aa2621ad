// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SLABS_HPP
#define REFRACT_TOOLS_SLABS_HPP

#include "stereo/rectified_rig.hpp"

#include <algorithm>

namespace tools {

/* A search in smaller images is made in slabs of depths, each rectified for a plane of its own: for so many that rows agree to a
fraction of its pixels. Mostly one will do; a wide lens before water needs a dozen. */
class Slabs
{
public:
    //! @param scale of the smaller images
    Slabs(const RectifiedRig& rig, double scale) : rig_(rig), scale_(scale)
    {
        const double TYPICAL = 0.3, LARGEST = 1.5;      // px of the smaller images
        const int MOST = 64;
        count_ = std::clamp(cvCeil(scale*std::max(rig.rowError[0]/TYPICAL, rig.rowError[1]/LARGEST)), 1, MOST);
    }
    int count() const { return count_; }
    //! First disparity of a slab, full size; of the one after the last, the end.
    double begin(int k) const { return rig_.minDisparity() + k*(double)rig_.disparities()/count_; }
    //! z of its plane in the rectified frame.
    double depth(int k) const
    {
        // Disparities are those of the whole image: beyond infinity, and far before the range, there is nothing.
        const double farthest = std::max(begin(k), rig_.shift()), middle = std::max(0.5*(farthest + begin(k + 1)), rig_.shift() + 0.5);
        return count_ == 1 ? rig_.planeDepth() : std::max(rig_.depthOf(middle), 0.5*rig_.depthRange()[0]);
    }
    //! First disparity of the smaller images, and how many a matcher takes.
    int from(int k) const { return cvFloor(begin(k)*scale_); }
    int disparities(int k) const { return cvCeil((begin(k + 1)*scale_ + 1 - from(k))/16)*16; }

private:
    const RectifiedRig& rig_;
    double scale_;
    int count_;
};

} // namespace tools

#endif // REFRACT_TOOLS_SLABS_HPP
