// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LIVE_RIG_HPP
#define REFRACT_TOOLS_LIVE_RIG_HPP

#include "calibrate/rig_data.hpp"
#include <functional>
#include <iosfwd>

namespace tools {

//! --watch, --watch-count, --watch-pairs, --watch-quiet
struct WatchOptions
{
    bool given = false;
    std::vector<std::string> folders;   //!< empty: those of all globs
    int count = 0, pairs = 0;           //!< images with the target, complete pairs, to wait for; 0: until it is quiet
    double quietSeconds = 30.;

    void addTo(OptionParser& parser);
};

//! What the images that came so far are worth.
struct Sufficiency
{
    bool isEnough = false;
    std::string words;                  //!< empty: nothing can be said yet
};

struct WatchedRig
{
    RigSources sources;
    const Target& target;
    bool unpaired;
    std::function<Sufficiency(const RigImages&)> assess;    //!< after each image that helps; empty: it is not asked
};

/** Waits while images come into the folders of some sources. Says of each image whether the target was found, how sharp and how well
exposed it is, what its name is still waiting for, and what the next one should show. Ends with the number of images or pairs, when
what came is enough, or when none has come for some time. A file that is no image, is not complete after some time, is a copy of
another or of another size is named once and left out; written anew, it is looked at again.
@param sources the watched ones are taken out of them, as they need not be read again
@return what was found in the watched ones
Throws Failure if a folder is absent or has no source. */
RigImages watchRig(const WatchOptions& options, const WatchedRig& rig, RigSources& sources, std::ostream& out);

} // namespace tools

#endif // REFRACT_TOOLS_LIVE_RIG_HPP
