// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/outputs.hpp"
#include "console/failure.hpp"
#include "console/file_output.hpp"
#include "console/images.hpp"
#include "console/utf8.hpp"

#include <opencv2/imgcodecs.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>

namespace tools {

namespace fs = std::filesystem;

namespace {

//! One name for one file, also for a file that is not there yet.
std::string canonical(const std::string& path)
{
    std::error_code error;
    const fs::path target = fs::absolute(targetOfLinks(path)), name = fs::weakly_canonical(target, error);
    return (error ? target : name).lexically_normal().string();
}

std::string extensionOf(const std::string& path)
{
    return inLowerCase(fs::path(path).extension().string());
}

void checkKind(const Output& output)
{
    static const std::set<std::string> CALIBRATIONS = {".yml", ".yaml", ".xml", ".json"};
    const bool asYaml = isSpecialFile(output.path) && extensionOf(output.path).empty();     // /dev/stdout
    if (output.kind == OUTPUT_CALIBRATION && !asYaml && !CALIBRATIONS.count(extensionOf(output.path)))
        throw Failure(output.option + "=" + output.path + ": the extension of a calibration is .yml, .yaml, .xml or .json, which "
                      "says how it is written");
    if (output.kind == OUTPUT_PICTURE && (extensionOf(output.path).empty() || !cv::haveImageWriter(output.path)))
        throw Failure(output.option + "=" + output.path + ": no image format that can be written has this extension; use .png or "
                      ".jpg");
}

//! Of two runs that write one file, the work of one would be lost without a word.
void keepFromOthers(const Output& output, const std::string& name)
{
    static std::map<std::string, std::unique_ptr<FileLock>> kept;       // to the end of the process
    std::unique_ptr<FileLock>& lock = kept[name];
    if (!lock)
        lock = FileLock::tryOnce((fs::path(name).parent_path()/("." + fs::path(name).filename().string() + ".lock")).string());
    if (!lock)
        throw Failure(output.option + ": another run is about to write '" + output.path + "': wait until it has ended, or name another "
                      "file");
}

} // namespace

void checkOutputs(const std::vector<Output>& outputs, const std::vector<std::string>& inputs)
{
    std::map<std::string, std::string> read;        // canonical name -> as the caller wrote it
    std::multimap<std::uintmax_t, std::string> readOfSize;          // one file has one size: few are compared where there are thousands
    const auto sizeOf = [](const std::string& path) {
        std::error_code ignored;
        return fs::file_size(path, ignored);
    };
    for (const std::string& input : inputs)
        for (const std::string& file : input.find("%d") != std::string::npos ? numberedFiles(input) : matchingFiles(input))
            if (read.insert({canonical(file), file}).second)
                readOfSize.insert({sizeOf(file), file});
    std::map<std::string, const Output*> written;
    for (const Output& output : outputs)
    {
        if (output.path.empty())
            continue;
        checkKind(output);
        if (isSpecialFile(output.path))         // takes whatever comes, also twice, and is not replaced
        {
            requireWritable(output.path);
            continue;
        }
        const std::string name = canonical(output.path);
        const auto isHardLink = [&](const std::pair<const std::uintmax_t, std::string>& input) {
            std::error_code ignored;
            return fs::equivalent(input.second, output.path, ignored);
        };
        const auto alike = readOfSize.equal_range(fs::exists(output.path) ? sizeOf(output.path) : 0);
        if (read.count(name) || (fs::exists(output.path) && std::any_of(alike.first, alike.second, isHardLink)))
            throw Failure(output.option + ": '" + output.path + "' is one of the files to read and would be overwritten: name "
                          "another");
        const Output*& other = written[name];
        if (other)
            throw Failure((output.option == other->option ? "" : other->option + " and ") + output.option + ": '" + output.path
                          + "' would be written twice: give each output a file of its own");
        other = &output;
        if (output.kind != OUTPUT_IN_FOLDER)
            requireWritable(output.path);
    }
    for (const auto& entry : written)
        if (entry.second->kind != OUTPUT_IN_FOLDER && entry.second->kind != OUTPUT_SHARED)
            keepFromOthers(*entry.second, entry.first);
}

} // namespace tools
