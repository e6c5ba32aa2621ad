// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/device_label.hpp"
#include "console/failure.hpp"
#include <algorithm>
#include <cctype>

namespace tools {

using cv::FileNode;
using cv::FileStorage;

std::pair<std::string, std::string> parseNote(const std::string& text)
{
    // Not a std::regex: its matcher calls itself for every letter of the text.
    const size_t equals = text.find('=');
    const std::string key = text.substr(0, equals);
    const auto isPart = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; };
    if (equals == std::string::npos || key.empty() || std::isdigit((unsigned char)key[0]) || key[0] == '-'
        || !std::all_of(key.begin(), key.end(), isPart))
        throw Failure("--note=" + text + ": give KEY=TEXT with a KEY of letters, digits, _ and -, as in "
                      "--note=customer='Tunnel Ltd'");
    return {key, text.substr(equals + 1)};
}

Label readLabel(const FileStorage& fs)
{
    Label label;
    if (fs["window_serial"].isString())
        fs["window_serial"] >> label.serial;
    for (const FileNode& note : fs["notes"])
        if (note.isString())
            label.notes.push_back({note.name(), (std::string)note});
    return label;
}

void writeLabel(FileStorage& fs, const Label& label)
{
    if (!label.serial.empty())
        fs << "window_serial" << label.serial;
    if (label.notes.empty())
        return;
    fs << "notes" << "{";
    for (const auto& note : label.notes)
        fs << note.first << note.second;
    fs << "}";
}

} // namespace tools
