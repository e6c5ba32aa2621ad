// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Boards seen with and without the window: what the calibrators are given.
#ifndef REFRACT_BENCH_BOARDS_HPP
#define REFRACT_BENCH_BOARDS_HPP

#include "scene.hpp"

namespace bench {

//! A board of 9 x 6 corners in random poses, each seen direct and through the pane, noise 0.05 px.
struct Boards
{
    static constexpr int CORNERS = 54;
    explicit Boards(int views);

    //! Ours, the normal free and what flags say.
    void calibrateGlass(int flags = 0) const;
    //! How far its normal is from the truth, in the standard deviations that it states.
    double normalError(int flags) const;
    //! cv::calibrateCamera on the direct views, which begins with nothing known.
    void calibrateCamera() const;
    void calibrateNormal() const;

    //! The camera with the start that the calibrations have: everything known but the normal.
    cv::Ptr<cv::refract::RefractiveCamera> startCamera() const;

    Scene scene = Scene(FIVE, 1);
    std::vector<std::vector<cv::Point3f> > object;
    std::vector<std::vector<cv::Point2f> > refracted, direct;
};

} // namespace bench

#endif // REFRACT_BENCH_BOARDS_HPP
