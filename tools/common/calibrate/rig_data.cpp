#include "calibrate/rig_data.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <map>
#include <numeric>

using namespace cv;

namespace tools {

static const int MIN_POINTS = 4;        // of a view that is to have a pose

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

RigViewSets readViewSets(const RigSources& sources, const Target& target, const Size imageSize[2], bool quiet)
{
    RigViewSets sets;
    for (int c = 0; c < 2; c++)
        for (bool through : {false, true})
        {
            const std::string& source = (through ? sources.glass : sources.direct)[c];
            if (!source.empty())
                (through ? sets.glass : sets.direct)[c] = readViews(source, target, imageSize[c], quiet);
        }
    return sets;
}

RigData pairViews(const Target& target, const RigViewSets& sets, bool unpaired)
{
    RigData data;
    data.cameraCount = sets.glass[1].views.empty() ? 1 : 2;
    data.objectPoints = target.objectPoints();
    data.neighbours = target.neighbours();
    std::map<std::pair<std::string, bool>, Moment> moments;
    for (int c = 0; c < data.cameraCount; c++)
        for (bool through : {false, true})
        {
            const ViewSet& set = (through ? sets.glass : sets.direct)[c];
            if (set.views.empty())
                continue;
            if (!data.imageSize[c].empty() && set.imageSize != data.imageSize[c])
                throw Failure(format("camera %d: direct images ('%s') are %dx%d, glass images ('%s') %dx%d: they must come from the "
                                     "same camera at the same resolution", c + 1, sets.direct[c].files[0].c_str(),
                                     data.imageSize[c].width, data.imageSize[c].height, set.files[0].c_str(), set.imageSize.width,
                                     set.imageSize.height));
            data.imageSize[c] = set.imageSize;
            for (const DetectedView& view : set.views)
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
