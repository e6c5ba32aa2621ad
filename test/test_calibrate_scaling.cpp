// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// How the joint fit's time grows with cameras and views. Hidden: run with [.scaling].
#include "rig_scenes.hpp"
#include <ctime>
#include <sys/resource.h>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

//! Of processor time, as another program may run beside.
static double secondsOf(RigCall call, const TermCriteria& criteria)
{
    const std::clock_t start = std::clock();
    GlassRigOptions options(GLASS_FREE_EXTRINSICS | GLASS_FREE_INTRINSICS);
    options.criteria = criteria;
    call.run(options);
    return (double)(std::clock() - start)/CLOCKS_PER_SEC;
}

TEST_CASE("Time of one iteration is linear in the observations; 16 cameras and 500 views are solved", "[.scaling]")
{
    const std::pair<int, int> sizes[] = { { 1, 10 }, { 1, 100 }, { 1, 1000 }, { 2, 500 }, { 4, 250 }, { 4, 500 }, { 16, 60 },
                                          { 16, 250 }, { 16, 500 } };
    for (const std::pair<int, int>& size : sizes)
    {
        Random random(650);
        std::vector<int> windows(size.first);
        for (int c = 0; c < size.first; c++)
            windows[c] = c;
        // 11 x 8 corners; the cameras stand close enough for all to see every view
        const RigTruth truth = makeRig(size.first, windows, 1, 0.6/16);
        const RigScene scene = makeRigScene(truth, ObjectViews(size.second, board(11, 8, 20)), random, 0.1);
        const RigCall call(truth, scene, true);
        // What three more iterations take; and all, to the end.
        const double few = secondsOf(call, TermCriteria(TermCriteria::COUNT, 1, 0));
        const double more = secondsOf(call, TermCriteria(TermCriteria::COUNT, 4, 0));
        const double whole = secondsOf(call, TermCriteria(TermCriteria::COUNT | TermCriteria::EPS, 100, 1e-9));
        const double observations = 2.*88*size.first*size.second;
        rusage usage;
        getrusage(RUSAGE_SELF, &usage);
        std::cout << "[numbers] " << size.first << " camera(s), " << size.second << " pairs of 88 corners, lens, R, T free: "
                  << 1e6*(more - few)/3/observations << " us per observation and iteration, " << whole << " s in all, "
                  << usage.ru_maxrss/1024 << " MB" << std::endl;
    }
}
