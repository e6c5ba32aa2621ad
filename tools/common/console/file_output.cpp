// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/file_output.hpp"
#include "console/failure.hpp"
#include "console/images.hpp"
#include "console/table.hpp"
#include <opencv2/imgcodecs.hpp>
#include <sys/file.h>
#include <sys/stat.h>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <unistd.h>

namespace tools {

namespace fs = std::filesystem;

namespace {

const int MOST_LINKS = 40;      // as Linux

fs::path folderOf(const fs::path& file)
{
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

bool isFolder(const fs::path& path)
{
    std::error_code ignored;
    return fs::is_directory(path, ignored);
}

//! Its own stream, as a second one on the same file would write over what the tool prints.
bool isStandardOutput(const std::string& path) { return path == "/dev/stdout"; }

//! Also of root, who may write everywhere: a file without that bit is meant to stay.
bool isReadOnly(const fs::path& file)
{
    std::error_code ignored;
    const fs::file_status status = fs::status(file, ignored);
    const fs::perms write = fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
    return fs::exists(status) && ((status.permissions() & write) == fs::perms::none || access(file.c_str(), W_OK) != 0);
}

//! Into what is there, at one go.
bool copyInto(const std::string& special, const std::string& file)
{
    std::ifstream in(file, std::ios::binary);
    if (isStandardOutput(special))
        return (bool)(std::cout << in.rdbuf() << std::flush);
    std::ofstream out(special, std::ios::binary);
    out << in.rdbuf();
    out.close();
    return (bool)out;
}

} // namespace

FileLock::FileLock(const std::string& file, int descriptor) : file_(file), descriptor_(descriptor) {}

//! The file that was opened must still be the one of that name: the other takes it away with itself.
static bool isStillNamed(int descriptor, const std::string& file)
{
    struct stat opened = {}, named = {};
    return fstat(descriptor, &opened) == 0 && stat(file.c_str(), &named) == 0 && opened.st_ino == named.st_ino;
}

std::unique_ptr<FileLock> FileLock::tryOnce(const std::string& file, const std::string& kept)
{
    const int TRIES = 10;
    for (int i = 0; i < TRIES; i++)
    {
        int descriptor = open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
        if (descriptor < 0 && errno == EACCES)      // another user left it
            descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
        if (descriptor < 0)
            throw Failure("cannot write '" + kept + "': no file can be made beside it, which keeps two runs at once apart: "
                          + std::strerror(errno));
        const bool isTaken = flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;      // else: locked, or no locks here
        if (!isTaken && isStillNamed(descriptor, file))
            return std::unique_ptr<FileLock>(new FileLock(file, descriptor));
        close(descriptor);
        if (isTaken)
            return nullptr;
    }
    return nullptr;
}

FileLock::~FileLock()
{
    unlink(file_.c_str());
    close(descriptor_);
}

std::string targetOfLinks(const std::string& path)
{
    std::error_code ignored;
    fs::path target = path;
    for (int i = 0; i < MOST_LINKS && fs::is_symlink(target, ignored); i++)
        target = folderOf(target)/fs::read_symlink(target, ignored);
    if (fs::is_symlink(target, ignored))
        throw Failure("cannot write '" + path + "': its symbolic links form a loop");
    return target.string();
}

bool isSpecialFile(const std::string& path)
{
    std::error_code ignored;
    const fs::file_status status = fs::status(path, ignored);
    return isStandardOutput(path) || (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status));
}

void requireWritable(const std::string& path)
{
    if (isSpecialFile(path))
    {
        if (access(path.c_str(), W_OK) != 0)
            throw Failure("cannot write '" + path + "': no permission to write into it");
        return;
    }
    const fs::path target = targetOfLinks(path), folder = folderOf(target);
    if (target.filename().empty() || isFolder(target))
        throw Failure("'" + path + "' is a folder: name a file to write");
    if (!isFolder(folder))
        throw Failure("cannot write '" + path + "': the folder '" + folder.string() + "' does not exist; make it first");
    if (isReadOnly(target))
        throw Failure("cannot write '" + path + "': it exists and is read-only: name another file, or allow it "
                      "(chmod u+w)");
    if (access(folder.c_str(), W_OK) != 0)
        throw Failure("cannot write '" + path + "': no permission to write in the folder '" + folder.string() + "'");
}

fs::path temporaryFolder()
{
    std::error_code error;
    const fs::path folder = fs::temp_directory_path(error);
    if (error)
    {
        const char* const name = std::getenv("TMPDIR");
        throw Failure(std::string("there is no folder for temporary files") + (name ? ": TMPDIR is '" + std::string(name) + "'" : "")
                      + "; make it, or set TMPDIR to another");
    }
    return folder;
}

OutputFile::OutputFile(const std::string& path, const std::string& extension) : path_(path)
{
    requireWritable(path);
    if (!isSpecialFile(path))
        target_ = targetOfLinks(path);
    const fs::path name(target_.empty() ? path : target_);
    temporary_ = ((target_.empty() ? temporaryFolder() : folderOf(name))
                  / ("." + name.stem().string() + ".part" + std::to_string(getpid())
                     + (name.has_extension() ? name.extension().string() : extension))).string();
}

OutputFile::~OutputFile()
{
    std::error_code ignored;
    if (!committed_)
        fs::remove(temporary_, ignored);
}

void OutputFile::commit()
{
    std::error_code error;
    if (target_.empty())        // the temporary goes with the destructor
    {
        if (!copyInto(path_, temporary_))
            throw Failure("cannot write into '" + path_ + "'");
        return;
    }
    if (fs::exists(target_, error))     // who may read it stays
        fs::permissions(temporary_, fs::status(target_, error).permissions(), error);
    fs::rename(temporary_, target_, error);
    if (error)
        throw Failure("cannot write '" + path_ + "': " + error.message());
    committed_ = true;
}

//! @return whether it could
static bool write(const std::string& path, const std::string& text)
{
    std::ofstream out(path, std::ios::binary);
    out << text;
    out.close();
    return (bool)out;
}

/** Minutes of work, of which no output could be written, in the folder for temporary files under a name that nobody has.
@return where; empty: not there either */
static std::string keptElsewhere(const std::string& path, const std::string& text)
{
    std::error_code error;
    const fs::path folder = fs::temp_directory_path(error), name(path);
    const std::string extension = name.extension().string();
    std::string kept = (folder/(name.stem().string() + "-XXXXXX" + extension)).string();
    const int descriptor = error ? -1 : mkstemps(kept.data(), (int)extension.size());
    if (descriptor < 0)
        return "";
    close(descriptor);
    if (write(kept, text))
        return kept;
    fs::remove(kept, error);
    return "";
}

static void writeInto(const OutputFile& file, const std::string& path, const std::string& text)
{
    if (write(file.temporary(), text))
        return;
    const std::string kept = keptElsewhere(path, text);
    throw Failure("cannot write '" + path + "': is the disk full?" + (kept.empty() ? "" : " It is kept as '" + kept + "'"));
}

void writeText(const std::string& path, const std::string& text)
{
    OutputFile file(path);
    writeInto(file, path, text);
    file.commit();
}

//! cv::FileStorage escapes ' in JSON, which has no such escape.
static std::string validJson(const std::string& text)
{
    std::string valid;
    for (size_t i = 0; i < text.size(); i++)
    {
        const bool isEscape = text[i] == '\\' && i + 1 < text.size();
        if (isEscape && text[i + 1] != '\'')
            valid += text[i];
        i += isEscape;
        valid += text[i];
    }
    return valid;
}

void writeStorage(const std::string& path, const std::string& extension, const std::function<void(cv::FileStorage&)>& write)
{
    OutputFile file(path, extension);
    // FileStorage does not tell what a full disk swallowed.
    cv::FileStorage memory(file.temporary(), cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
    write(memory);
    const std::string text = memory.releaseAndGetString();
    writeInto(file, path, fs::path(file.temporary()).extension() == ".json" ? validJson(text) : text);
    file.commit();
}

void writeImage(const std::string& path, const cv::Mat& image, const std::vector<int>& parameters)
{
    OutputFile file(path);
    if (!cv::haveImageWriter(file.temporary()))
        throw Failure("cannot write '" + path + "': no image format has this extension; use .png or .jpg");
    // Into memory first: libpng prints what a full disk makes of it.
    std::vector<uchar> bytes;
    if (!cv::imencode(fs::path(file.temporary()).extension().string(), image, bytes, parameters))
        throw Failure("cannot write '" + path + "': its format cannot keep such an image");
    writeInto(file, path, std::string(bytes.begin(), bytes.end()));
    file.commit();
}

void makeFolder(const std::string& path)
{
    std::error_code error;
    fs::create_directories(path, error);
    if (error || !fs::is_directory(path))
        throw Failure("cannot make the folder '" + path + "'" + (error ? ": " + error.message() : ""));
}

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
        lock = FileLock::tryOnce((fs::path(name).parent_path()/("." + fs::path(name).filename().string() + ".lock")).string(),
                                 output.path);
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
