#ifndef REFRACT_TOOLS_FINDINGS_HPP
#define REFRACT_TOOLS_FINDINGS_HPP

#include "rig_calibration.hpp"

namespace tools {

//! What a technician must know, in sentences.
struct Findings
{
    std::vector<std::string> limitsNotMet;
    std::vector<std::string> weak;          //!< to be mended, and how
    std::vector<std::string> cannotTell;    //!< what these data do not say
    std::vector<std::string> assumed;       //!< taken as given
};

Findings judge(const RigCalibration& calibration);

} // namespace tools

#endif // REFRACT_TOOLS_FINDINGS_HPP
