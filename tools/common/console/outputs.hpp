// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_OUTPUTS_HPP
#define REFRACT_TOOLS_OUTPUTS_HPP

#include <string>
#include <vector>

/* What a tool will write, looked at before any work is done. */
namespace tools {

enum OutputKind {
    OUTPUT_TEXT,            //!< any name
    OUTPUT_CALIBRATION,     //!< .yml, .yaml, .xml or .json
    OUTPUT_PICTURE,         //!< what cv::imwrite knows
    OUTPUT_SHARED,          //!< any name; read and written anew, by several runs in turn
    OUTPUT_IN_FOLDER        //!< in a folder that the tool makes when there is something to write
};

struct Output
{
    std::string option;     //!< that names it, for the text: --out
    std::string path;       //!< empty: it is not asked for
    OutputKind kind;
};

/** Throws Failure if an output is an input (however both are written: links, ./ and ..), two outputs are one file, an
extension does not tell a format that can be written, a file's folder is absent or may not be written to, or another run is about to
write the same file: until the process ends, no other takes it.
@param inputs files and globs that the tool reads; empty ones, and those that match nothing, are passed over. */
void checkOutputs(const std::vector<Output>& outputs, const std::vector<std::string>& inputs);

} // namespace tools

#endif // REFRACT_TOOLS_OUTPUTS_HPP
