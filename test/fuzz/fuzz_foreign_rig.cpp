// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "file_harness.hpp"
#include "formats/foreign_rig.hpp"

// Lens files of other programs, of all formats.

const char fuzz::EXTENSION[] = ".ori";

void fuzz::tryFile(const std::string& path)
{
    const auto rig = tools::readForeignRig(path);
    if (!rig)
        return;
    promise(!rig->cameras.empty() && (rig->Rs.empty() || rig->Rs.size() == rig->cameras.size()), "cameras, and a place of each or of none");
    for (const auto& camera : rig->cameras)
        promise(cv::checkRange(camera->lensParameters()), "lenses are finite");
    for (size_t c = 0; c < rig->Rs.size(); c++)
        promise(cv::checkRange(rig->Rs[c]) && cv::checkRange(rig->Ts[c]), "places are finite");
}
