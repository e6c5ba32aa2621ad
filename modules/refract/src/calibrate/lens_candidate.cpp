// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/lens_candidate.hpp"

namespace cv { namespace refract {

namespace {

const double PERFECT = 1e-6;            // px, of exact data

const int TILT = GLASS_FIX_TAUX_TAUY, PRISM = TILT | GLASS_FIX_S1_S2_S3_S4, K6 = GLASS_FIX_K6 | PRISM, K5 = GLASS_FIX_K5 | K6,
          K4 = GLASS_FIX_K4 | K5, K3 = GLASS_FIX_K3 | K4, TANGENT = GLASS_FIX_TANGENT_DIST | K3, K2 = GLASS_FIX_K2 | TANGENT,
          K1 = GLASS_FIX_K1 | K2;
//! What stays, from the simplest lens on.
const int FIXED[] = { K1, K2, TANGENT, K3, K4, K5, K6, PRISM, TILT, 0 };

int countFreeCoefficients(const Rig& rig, int flags)
{
    int most = 0;
    for (const Camera& camera : rig.cameras)
    {
        const std::vector<bool> isFree = freeLens(camera, flags | GLASS_FREE_INTRINSICS);
        most = std::max(most, (int)std::count(isFree.begin() + std::min<size_t>(4, isFree.size()), isFree.end(), true));
    }
    return most;
}

bool isRational(const Rig& rig, int flags)
{
    for (const Camera& camera : rig.cameras)
    {
        const std::vector<String> names = camera.lens().parameterNames();
        const std::vector<bool> isFree = freeLens(camera, flags | GLASS_FREE_INTRINSICS);
        const auto isFreeOf = [&](const char* name)
        {
            const size_t at = std::find(names.begin(), names.end(), name) - names.begin();
            return at < isFree.size() && isFree[at];
        };
        const bool mayBe = std::find(names.begin(), names.end(), "k5") != names.end();     // a fisheye's k4 is the last
        if (mayBe && (isFreeOf("k4") || isFreeOf("k5") || isFreeOf("k6")))
            return true;
    }
    return false;
}

} // namespace

std::vector<LensCandidate> candidatesOf(const Rig& rig, int flags)
{
    std::vector<LensCandidate> candidates;
    for (int fixed : FIXED)
    {
        const int count = countFreeCoefficients(rig, flags | fixed);
        if (candidates.empty() || count > candidates.back().coefficients)
            candidates.push_back({ fixed, count, isRational(rig, flags | fixed), false, false, RigStart(), {}, {}, 0, FitOutcome() });
    }
    return candidates;
}

double pointsOf(const std::vector<HeldOutPart>& parts)
{
    double points = 0;
    for (const HeldOutPart& part : parts)
        points += part.points;
    return points;
}

double standardError(const LensCandidate& a, const LensCandidate& b)
{
    const double count = (double)a.parts.size(), mean = (a.squares - b.squares)/count;
    double variance = 0;
    for (size_t i = 0; i < a.parts.size(); i++)
        variance += std::pow(a.parts[i].squares - b.parts[i].squares - mean, 2);
    return std::sqrt(variance*count/std::max(1., count - 1));
}

double unseen(const LensCandidate& candidate) { return PERFECT*PERFECT*pointsOf(candidate.parts); }

bool isWorse(const LensCandidate& a, const LensCandidate& b)
{
    return a.squares - b.squares > std::max(standardError(a, b), unseen(a));
}

}} // namespace
