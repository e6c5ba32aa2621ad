#include "rig_data.hpp"
#include "table.hpp"
#include <algorithm>
#include <map>
#include <numeric>

using namespace cv;

namespace tools {

static const int MIN_POINTS = 4;        // of a view that is to have a pose

int RigData::countGlass(int camera) const
{
    return (int)std::count_if(moments.begin(), moments.end(), [=](const Moment& m) { return m.hasGlass(camera); });
}

int RigData::countDirect(int camera) const
{
    return (int)std::count_if(moments.begin(), moments.end(), [=](const Moment& m) { return m.hasDirect(camera); });
}

int RigData::countPairs(int camera) const
{
    return (int)std::count_if(moments.begin(), moments.end(), [=](const Moment& m) { return m.isPair(camera); });
}

std::vector<int> allMoments(const RigData& data)
{
    std::vector<int> all(data.moments.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
}

RigData pairViews(const Target& target, const ViewSet* const direct[2], const ViewSet* const glass[2], bool unpaired)
{
    RigData data;
    data.cameraCount = glass[1] ? 2 : 1;
    data.objectPoints = target.objectPoints();
    data.neighbours = target.neighbours();
    std::map<std::pair<std::string, bool>, Moment> moments;
    for (int c = 0; c < data.cameraCount; c++)
        for (bool through : {false, true})
        {
            const ViewSet* set = through ? glass[c] : direct[c];
            if (!set)
                continue;
            if (!data.imageSize[c].empty() && set->imageSize != data.imageSize[c])
                throw Failure(format("camera %d: direct images are %dx%d, glass images %dx%d: they must come from the same "
                                     "camera at the same resolution", c + 1, data.imageSize[c].width,
                                     data.imageSize[c].height, set->imageSize.width, set->imageSize.height));
            data.imageSize[c] = set->imageSize;
            for (const View& view : set->views)
            {
                if (view.seenCount() < MIN_POINTS)
                    continue;
                Moment& m = moments[{view.stem, unpaired && through}];
                m.stem = view.stem;
                (through ? m.glass : m.direct)[c] = view.points;
            }
        }
    for (auto& entry : moments)
    {
        Moment& m = entry.second;
        std::vector<Point2d>* first = nullptr;
        for (std::vector<Point2d>* points : {&m.direct[0], &m.glass[0], &m.direct[1], &m.glass[1]})
            if (!points->empty())
            {
                if (first)
                    *points = target.alignWith(*first, *points);
                else
                    first = points;
            }
        data.moments.push_back(m);
    }
    return data;
}

} // namespace tools
