#ifndef REFRACT_TOOLS_MIXED_UP_IMAGES_HPP
#define REFRACT_TOOLS_MIXED_UP_IMAGES_HPP

#include "assess/explanation.hpp"
#include "assess/given.hpp"

/* Images that are not what they are given for: each mix-up is undone, and the same images are fitted again. */
namespace tools {

//! @param only one camera's; -1: all
Explanation directAndGlassExchanged(const Given& given, int only);

/** The folders of the two cameras exchanged, in one state only. Without a known lens the cameras have no names of their own:
the glass images exchanged back explain exchanged direct images as well. */
Explanation camerasExchanged(const Given& given, bool glass);

//! Equal names of the two cameras are not the same moment.
Explanation otherMoments(const Given& given);

//! Equal names of a direct and a glass image are not one place of the board.
Explanation unpaired(const Given& given);

} // namespace tools

#endif // REFRACT_TOOLS_MIXED_UP_IMAGES_HPP
