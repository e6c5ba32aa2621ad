// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LIVE_PAIRS_HPP
#define REFRACT_TOOLS_LIVE_PAIRS_HPP

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tools {

//! Where images come: one camera, without or through its window.
struct LivePlace
{
    int camera;
    bool glass;
};

//! "camera 2, glass"; of a single camera "glass".
std::string nameOf(const LivePlace& place, int cameras);

/* Which images of one name belong together and are there: the direct and the glass image of a pair, and those of one moment of all cameras.
A direct image may stay alone, for the lens; as soon as there is a glass image of its name, all places are waited for. */
class LivePairs
{
public:
    //! @param places that are watched  @param unpaired equal names of direct and glass images mean nothing
    LivePairs(const std::vector<LivePlace>& places, bool unpaired);

    //! An image came. Says what is complete or waited for; empty: nothing is. @param found the target in it
    std::string add(const std::string& stem, size_t place, bool found);

    //! Names of which all images show the target.
    int complete() const { return complete_; }
    //! False if no image belongs to another: places of one kind of one camera.
    bool areAny() const { return places_.size() > 1 && (pairs_ || cameras_ > 1); }
    bool arePairs() const { return pairs_; }    //!< of direct and glass images
    //! What is still waited for at the end, a sentence each.
    std::vector<std::string> incomplete() const;

private:
    enum Image { NONE, WITHOUT_TARGET, FOUND };
    using Images = std::vector<Image>;          // of each place

    std::vector<size_t> expected(const Images& images) const;
    std::string missing(const Images& images) const;

    std::vector<LivePlace> places_;
    bool pairs_ = false;                        //!< of a direct and a glass image
    int cameras_ = 1, complete_ = 0;
    std::map<std::pair<std::string, bool>, Images> images_;     //!< by name; unpaired: by name and kind
};

} // namespace tools

#endif // REFRACT_TOOLS_LIVE_PAIRS_HPP
