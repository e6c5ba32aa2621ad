// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "camera/storage.hpp"
#include <fstream>

namespace cv { namespace refract {

//! How deep brackets and XML's tags nest, or more: FileStorage's parsers call themselves for each level.
static int nestingOf(std::istream& text)
{
    int level = 0, deepest = 0;
    char before = 0;
    for (char c; text.get(c); before = c)
    {
        if (c == '[' || c == '{' || (before == '<' && std::isalpha((unsigned char)c)))
            deepest = std::max(deepest, ++level);
        else if (c == ']' || c == '}' || (before == '<' && c == '/') || (before == '/' && c == '>'))
            level = std::max(0, level - 1);
    }
    return deepest;
}

//! Faults that FileStorage tells by its own source lines.
static void requireText(std::ifstream& file, const String& filename)
{
    char start[3] = {};
    file.read(start, 3);
    if (file.gcount() == 0)
        CV_Error_(Error::StsParseError, ("%s is empty", filename.c_str()));
    if (String(start, 3) == "\xEF\xBB\xBF")
        CV_Error_(Error::StsParseError, ("%s begins with a byte order mark, which OpenCV does not read: save it as UTF-8 "
                                         "without one", filename.c_str()));
    file.clear();
    file.seekg(0);
}

FileStorage openStorage(const String& filename)
{
    // FileStorage would log a line of its own.
    std::ifstream file(filename.c_str(), std::ios::binary);
    if (!file)
        CV_Error_(Error::StsObjectNotFound, ("%s cannot be opened", filename.c_str()));
    requireText(file, filename);
    const int DEEPEST = 256;
    if (nestingOf(file) > DEEPEST)
        CV_Error_(Error::StsParseError, ("%s is no file of FileStorage: its brackets or tags nest deeper than %d",
                                         filename.c_str(), DEEPEST));
    FileStorage fs;
    try
    {
        fs.open(filename, FileStorage::READ);
    }
    catch (const std::exception& e)     // not only cv::Exception: std::length_error, too
    {
        CV_Error_(Error::StsParseError, ("%s is not YAML, XML or JSON that OpenCV reads (%s)", filename.c_str(), e.what()));
    }
    return fs;
}

static bool isNumber(const FileNode& node) { return node.isInt() || node.isReal(); }

Mat readStoredMatrix(const FileNode& map, const char* key, const String& filename)
{
    const FileNode node = map[key];
    if (node.empty())
        return Mat();
    const bool isMap = node.isMap() && node["rows"].isInt() && node["cols"].isInt();
    const int rows = isMap ? (int)node["rows"] : -1, cols = isMap ? (int)node["cols"] : -1;
    // In XML one number is no sequence, and none is an empty text.
    const FileNode data = isMap ? node["data"] : FileNode();
    const size_t count = data.isSeq() ? data.size() : isNumber(data) ? 1 : 0;
    if (rows < 0 || cols < 0 || (uint64)rows*cols != count)
        CV_Error_(Error::StsParseError, ("%s: %s is not a matrix of one channel, with rows x cols numbers as data",
                                         filename.c_str(), key));
    if (count == 0)
        return Mat();
    Mat m(rows, cols, CV_64F);
    int i = 0;
    for (const FileNode& number : data)
    {
        if (!isNumber(number))
            CV_Error_(Error::StsParseError, ("%s: %s holds something that is not a number", filename.c_str(), key));
        m.ptr<double>()[i++] = (double)number;
    }
    return m;
}

}} // namespace
