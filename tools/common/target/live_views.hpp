// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LIVE_VIEWS_HPP
#define REFRACT_TOOLS_LIVE_VIEWS_HPP

#include "console/images.hpp"
#include "target/target.hpp"
#include <iosfwd>

namespace CLI { class App; }

namespace tools {

//! --watch, --watch-count, --watch-quiet
struct WatchOptions
{
    std::string folder;         //!< empty: nothing is watched
    int count = 0;              //!< images with the target to wait for; 0: until it is quiet
    double quietSeconds = 30.;

    void addTo(CLI::App& app);
};

/** Waits while images come into a folder, and says of each whether the target was found, and what the next image should show. Ends
with the number of images, or when none has come for some time. What is no image, or not yet complete, is tried again.
@param patterns of images; the first whose folder is that of the options is watched
Throws Failure if there is no such folder or pattern. */
void watchImages(const WatchOptions& options, const std::vector<std::string>& patterns, const Target& target, Channel channel,
                 std::ostream& out);

} // namespace tools

#endif // REFRACT_TOOLS_LIVE_VIEWS_HPP
