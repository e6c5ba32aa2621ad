// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FILE_OUTPUT_HPP
#define REFRACT_TOOLS_FILE_OUTPUT_HPP

#include <opencv2/core.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tools {

/** What one process of several may have at a time: a file of this name, which goes with the lock. Where a signal ends the process the file
stays, and the lock goes. */
class FileLock
{
public:
    //! Null: another process has it. A file system without locks keeps nobody apart. Throws Failure if there can be no such file.
    //! @param kept what it keeps for one, as the user named it
    static std::unique_ptr<FileLock> tryOnce(const std::string& file, const std::string& kept);
    ~FileLock();
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

private:
    FileLock(const std::string& file, int descriptor);

    std::string file_;
    int descriptor_;
};

/* A file that is complete or absent: written under another name in the same folder, renamed at the end, removed if the work fails.
The temporary name keeps the extension, by which cv::imwrite and cv::FileStorage choose the format. A link stays one: what it leads to
is replaced. What is no regular file (a device, a pipe) stays what it is: the bytes go into it at the end. */
class OutputFile
{
public:
    //! @param extension of the temporary name where the path has none
    explicit OutputFile(const std::string& path, const std::string& extension = "");
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    const std::string& temporary() const { return temporary_; }     //!< write here
    void commit();                                                  //!< throws Failure if it cannot
private:
    std::string path_, target_, temporary_;     //!< target: where links lead to; empty: no regular file
    bool committed_ = false;
};

//! Where a link, or several in turn, leads to; also if nothing is there. Throws Failure if they lead round.
std::string targetOfLinks(const std::string& path);

//! A device, a pipe, a socket: it takes bytes and must not be replaced.
bool isSpecialFile(const std::string& path);

//! Throws Failure if no file can be written there: a folder of that name, no folder for it, no right, a read-only file.
void requireWritable(const std::string& path);

//! Where temporary files go: TMPDIR, if it is set. Throws Failure if there is no such folder.
std::filesystem::path temporaryFolder();

void writeText(const std::string& path, const std::string& text);

//! YAML, XML or JSON, as the path's extension says. @param extension where the path has none
void writeStorage(const std::string& path, const std::string& extension, const std::function<void(cv::FileStorage&)>& write);
void writeImage(const std::string& path, const cv::Mat& image, const std::vector<int>& parameters = {});

//! Makes the folder and its parents; throws Failure if it cannot.
void makeFolder(const std::string& path);

/* What a tool will write, looked at before any work is done. */
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

#endif // REFRACT_TOOLS_FILE_OUTPUT_HPP
