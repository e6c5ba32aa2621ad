#ifndef REFRACT_TOOLS_FILE_OUTPUT_HPP
#define REFRACT_TOOLS_FILE_OUTPUT_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace tools {

/* A file that is complete or absent: written under another name in the same folder, renamed at the end, removed if the
work fails. The temporary name keeps the extension, by which cv::imwrite and cv::FileStorage choose the format. */
class OutputFile
{
public:
    explicit OutputFile(const std::string& path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    const std::string& temporary() const { return temporary_; }     //!< write here
    void commit();                                                  //!< throws Failure if it cannot
private:
    std::string path_, temporary_;
    bool committed_ = false;
};

//! Throws Failure if no file can be written there: a folder of that name, no folder for it, no right.
void requireWritable(const std::string& path);

void writeText(const std::string& path, const std::string& text);
void writeImage(const std::string& path, const cv::Mat& image, const std::vector<int>& parameters = {});

//! Makes the folder and its parents; throws Failure if it cannot.
void makeFolder(const std::string& path);

} // namespace tools

#endif // REFRACT_TOOLS_FILE_OUTPUT_HPP
