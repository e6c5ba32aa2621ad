#include "assess/mixed_up_images.hpp"
#include "assess/fit_quality.hpp"
#include "console/table.hpp"
#include <algorithm>

namespace tools {

Explanation directAndGlassExchanged(const Given& given, int only)
{
    if (!hasPairs(given.data) || only >= given.data.cameraCount || (only >= 0 && given.data.cameraCount == 1))
        return {"", NO_FIT};
    RigData data = given.data;
    for (Moment& m : data.moments)
        for (int c = 0; c < data.cameraCount; c++)
            if (only < 0 || only == c)
                std::swap(m.direct[c], m.glass[c]);
    const char* suffix = only == 1 ? "2" : "";
    return {format("--direct%s and --glass%s exchanged", suffix, suffix), medianErrorOfFit(data, given.options)};
}

Explanation camerasExchanged(const Given& given, bool glass)
{
    const bool lensKnown = given.options.known[0] || given.options.known[1];
    if (!hasPairs(given.data) || given.data.cameraCount < 2 || (!glass && !lensKnown))
        return {"", NO_FIT};
    RigData data = given.data;
    for (Moment& m : data.moments)
        glass ? std::swap(m.glass[0], m.glass[1]) : std::swap(m.direct[0], m.direct[1]);
    const std::string sentence = glass ? "--glass and --glass2 exchanged" : "--direct and --direct2 exchanged";
    return {sentence + (lensKnown ? "" : " (or --direct and --direct2)"), medianErrorOfFit(data, given.options)};
}

Explanation otherMoments(const Given& given)
{
    if (given.data.cameraCount < 2)
        return {"", NO_FIT};
    double worst = 0.;
    for (int c = 0; c < 2; c++)
    {
        const Given one = oneCamera(given, c);
        worst = std::max(worst, medianErrorOfFit(one.data, one.options));
    }
    return {"each camera calibrated alone, so equal names of camera 1 and camera 2 are not the same moment (or the cameras "
            "moved to each other)", worst};
}

Explanation unpaired(const Given& given)
{
    if (!hasPairs(given.data))
        return {"", NO_FIT};
    RigData data = given.data;
    data.moments.clear();
    for (const Moment& m : given.data.moments)
    {
        Moment direct = m, glass = m;
        for (int c = 0; c < 2; c++)
        {
            direct.glass[c].clear();
            glass.direct[c].clear();
        }
        if (m.hasGlass())
            data.moments.push_back(glass);
        if (m.hasDirect(0) || m.hasDirect(1))
            data.moments.push_back(direct);
    }
    return {"each image fitted alone, so equal names of --direct and --glass are not one place of the board (it moved, or it "
            "was hand-held: --unpaired)", medianErrorOfFit(data, given.options)};
}

} // namespace tools
