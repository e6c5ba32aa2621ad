#ifndef REFRACT_TOOLS_EXPLANATION_HPP
#define REFRACT_TOOLS_EXPLANATION_HPP

#include <string>

namespace tools {

//! A mistake that may be why images do not fit.
struct Explanation
{
    std::string sentence;
    double px;                  //!< what the same images leave with it undone, see medianErrorOfFit
};

} // namespace tools

#endif // REFRACT_TOOLS_EXPLANATION_HPP
