// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The rows of the table, by what they work on. Each adds rows that hold all they need.
#ifndef REFRACT_BENCH_ROWS_HPP
#define REFRACT_BENCH_ROWS_HPP

#include "measure.hpp"
#include "scene.hpp"

#include <algorithm>

namespace bench {

//! Arrays of points through one camera.
void addPointRows(std::vector<Row>& rows, int count);
//! The same through faces that are not parallel.
void addWedgeRows(std::vector<Row>& rows, int count);
//! The same through a dome, a tube and a bent pane.
void addCurvedRows(std::vector<Row>& rows, int count);
//! A splined lens; none without mrcal.
void addSplinedRows(std::vector<Row>& rows, int count);
//! Two cameras: triangulation, epipolar curves.
void addPairRows(std::vector<Row>& rows, int count);
//! Poses from matches of which some are wrong.
void addRobustRows(std::vector<Row>& rows);
//! Whole images, one point a call, float32, two threads.
void addCallRows(std::vector<Row>& rows, int count);
//! Dense stereo of a pair of images.
void addStereoRows(std::vector<Row>& rows);
//! Calibration of 50 pairs.
void addCalibrationRows(std::vector<Row>& rows);

inline int countOk(const std::vector<uchar>& status) { return (int)std::count(status.begin(), status.end(), 0); }

//! A few of n, evenly spread: the reference takes its time.
inline std::vector<int> sample(int n, int wanted = 2000)
{
    std::vector<int> some;
    for (int i = 0; i < n; i += std::max(1, n/wanted))
        some.push_back(i);
    return some;
}

//! Of a sample of answers; NaN if one is missing.
inline double worst(const std::vector<uchar>& status, const std::function<double(int)>& error)
{
    double most = 0;
    for (int i : sample((int)status.size()))
        most = std::max(most, status[i] ? NAN : error(i));
    return most;
}

typedef reference::Vec2<long double> Pixel;
typedef reference::Vec3<long double> Point;
inline Point exact(const cv::Point3d& p) { return { p.x, p.y, p.z }; }
inline Pixel exact(const cv::Point2d& p) { return { p.x, p.y }; }

} // namespace bench

#endif // REFRACT_BENCH_ROWS_HPP
