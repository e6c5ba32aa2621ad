// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/image_disagreement.hpp"
#include "console/numbers.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>

using namespace cv;

namespace tools {

namespace {

//! The points of a camera's pairs, in both images.
struct PairedPoints
{
    std::vector<Point2d> direct, glass;

    void add(const View& view, int camera)
    {
        for (size_t i = 0; i < view.objectPoints.size() && view.isPair(camera); i++)
            if (seen(view.direct[camera][i]) && seen(view.glass[camera][i]))
            {
                direct.push_back(view.direct[camera][i]);
                glass.push_back(view.glass[camera][i]);
            }
    }

    //! Empty: there is none. @param method of findHomography
    Mat map(int method) const { return direct.size() < 8 ? Mat() : findHomography(direct, glass, method); }

    //! px, the median
    double distanceFrom(const Mat& map) const
    {
        std::vector<Point2d> there;
        perspectiveTransform(direct, there, map);
        std::vector<double> lengths;
        for (size_t i = 0; i < there.size(); i++)
            lengths.push_back(norm(there[i] - glass[i]));
        return median(lengths);
    }
};

PairedPoints pairedPointsOf(const RigData& data, int camera)
{
    PairedPoints points;
    for (const View& view : data.views)
        points.add(view, camera);
    return points;
}

} // namespace

double pairsFromOneMap(const RigData& data)
{
    double worst = 0.;
    for (int c = 0; c < data.cameraCount; c++)
    {
        const PairedPoints points = pairedPointsOf(data, c);
        const Mat H = points.map(0);
        worst = std::max(worst, H.empty() ? 0. : points.distanceFrom(H));
    }
    return worst;
}

std::vector<int> pairsOffMap(const RigData& data, int camera)
{
    const size_t FEWEST = 3;            // pairs to an odd one
    const Mat H = pairedPointsOf(data, camera).map(LMEDS);
    std::vector<int> off;
    size_t count = 0;
    for (size_t i = 0; i < data.views.size() && !H.empty(); i++)
    {
        PairedPoints points;
        points.add(data.views[i], camera);
        if (points.direct.empty())
            continue;
        count++;
        if (points.distanceFrom(H) > WINDOWS_PX)
            off.push_back((int)i);
    }
    return count > FEWEST*off.size() ? off : std::vector<int>();
}

namespace {

//! Divides pairs by which of two maps each is nearer to, until none changes sides. The first maps are those of two pairs.
std::vector<std::vector<size_t>> twoMaps(const std::vector<PairedPoints>& pairs, size_t one, size_t other, double& worst)
{
    const int MOST_TURNS = 10;
    std::vector<std::vector<size_t>> parts = {{one}, {other}}, before;
    for (int turn = 0; turn < MOST_TURNS && parts != before; turn++)
    {
        Mat maps[2];
        for (int k = 0; k < 2; k++)
        {
            PairedPoints all;
            for (size_t i : parts[k])
            {
                all.direct.insert(all.direct.end(), pairs[i].direct.begin(), pairs[i].direct.end());
                all.glass.insert(all.glass.end(), pairs[i].glass.begin(), pairs[i].glass.end());
            }
            maps[k] = all.map(0);
        }
        if (maps[0].empty() || maps[1].empty())
            return {};
        before = parts;
        parts.assign(2, {});
        worst = 0.;
        for (size_t i = 0; i < pairs.size(); i++)
        {
            const double px[] = {pairs[i].distanceFrom(maps[0]), pairs[i].distanceFrom(maps[1])};
            parts[px[1] < px[0]].push_back(i);
            worst = std::max(worst, std::min(px[0], px[1]));
        }
    }
    return parts;
}

} // namespace

std::vector<std::vector<int>> pairsOfTwoMaps(const RigData& data, int camera)
{
    const size_t FEWEST = 3;            // pairs of a map: one is on any
    const double BETTER = 0.3;          // times what one map leaves
    std::vector<PairedPoints> pairs;
    std::vector<int> views;
    for (size_t i = 0; i < data.views.size(); i++)
    {
        PairedPoints points;
        points.add(data.views[i], camera);
        if (points.map(0).empty())
            continue;
        pairs.push_back(points);
        views.push_back((int)i);
    }
    const Mat single = pairedPointsOf(data, camera).map(0);
    double least = 0.;
    for (const PairedPoints& pair : pairs)
        least = std::max(least, BETTER*pair.distanceFrom(single));
    std::vector<std::vector<int>> best;
    for (size_t one = 0; one < pairs.size(); one++)
        for (size_t other = one + 1; other < pairs.size(); other++)
        {
            double worst = 0.;
            const std::vector<std::vector<size_t>> parts = twoMaps(pairs, one, other, worst);
            if (parts.empty() || std::min(parts[0].size(), parts[1].size()) < FEWEST || !(worst < least))
                continue;
            least = worst;
            best.assign(2, {});
            for (int k = 0; k < 2; k++)
                for (size_t i : parts[k])
                    best[k].push_back(views[i]);
        }
    return best;
}

} // namespace tools
