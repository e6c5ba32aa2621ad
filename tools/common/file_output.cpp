#include "file_output.hpp"
#include "cli.hpp"

#include <opencv2/imgcodecs.hpp>
#include <unistd.h>
#include <filesystem>
#include <fstream>

namespace tools {

namespace fs = std::filesystem;

namespace {

fs::path folderOf(const fs::path& file)
{
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

} // namespace

void requireWritable(const std::string& path)
{
    const fs::path target(path), folder = folderOf(target);
    if (target.filename().empty() || fs::is_directory(target))
        throw Failure("'" + path + "' is a folder: name a file to write");
    if (!fs::is_directory(folder))
        throw Failure("cannot write '" + path + "': the folder '" + folder.string() + "' does not exist; make it first");
    if (access(folder.c_str(), W_OK) != 0)
        throw Failure("cannot write '" + path + "': no right to write in the folder '" + folder.string() + "'");
}

OutputFile::OutputFile(const std::string& path) : path_(path)
{
    requireWritable(path);
    const fs::path target(path);
    temporary_ = (folderOf(target) / ("." + target.stem().string() + ".part" + std::to_string(getpid())
                            + target.extension().string())).string();
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
    fs::rename(temporary_, path_, error);
    if (error)
        throw Failure("cannot write '" + path_ + "': " + error.message());
    committed_ = true;
}

void writeText(const std::string& path, const std::string& text)
{
    OutputFile file(path);
    std::ofstream out(file.temporary(), std::ios::binary);
    out << text;
    out.close();
    if (!out)
        throw Failure("cannot write '" + path + "': is the disk full?");
    file.commit();
}

void writeImage(const std::string& path, const cv::Mat& image, const std::vector<int>& parameters)
{
    OutputFile file(path);
    if (!cv::haveImageWriter(file.temporary()))
        throw Failure("cannot write '" + path + "': no image format has this extension; use .png or .jpg");
    if (!cv::imwrite(file.temporary(), image, parameters))
        throw Failure("cannot write '" + path + "': is the disk full?");
    file.commit();
}

void makeFolder(const std::string& path)
{
    std::error_code error;
    fs::create_directories(path, error);
    if (error || !fs::is_directory(path))
        throw Failure("cannot make the folder '" + path + "'" + (error ? ": " + error.message() : ""));
}

} // namespace tools
