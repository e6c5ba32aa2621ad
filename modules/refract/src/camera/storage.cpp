// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "camera/storage.hpp"
#include <atomic>
#include <cstdio>
#include <fstream>
#include <map>
#ifdef _WIN32
#ifndef NOMINMAX        // some compilers' own headers have it
#define NOMINMAX
#endif
#include <windows.h>
#else
#include <sys/stat.h>
#include <unistd.h>
#endif

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
    if (String(start, 2) == "\xFF\xFE" || String(start, 2) == "\xFE\xFF")
        CV_Error_(Error::StsParseError, ("%s is UTF-16, as the shell of Windows writes it: save it as UTF-8", filename.c_str()));
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
    catch (const cv::Exception& e)
    {
        CV_Error_(Error::StsParseError, ("%s is not YAML, XML or JSON that OpenCV reads (%s)", filename.c_str(), e.err.c_str()));
    }
    catch (const std::exception& e)     // std::length_error
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
    const int rows = isMap ? (int)node["rows"] : node.isSeq() ? (int)node.size() : -1;
    const int cols = isMap ? (int)node["cols"] : node.isSeq() ? 1 : -1;
    // In XML one number is no sequence, and none is an empty text.
    const FileNode data = isMap ? node["data"] : node.isSeq() ? node : FileNode();
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

String lensModelCalled(const String& name)
{
    static const std::map<String, String> names = {
        { "opencv", "opencv" }, { "plumb_bob", "opencv" }, { "rational_polynomial", "opencv" }, { "thin_prism", "opencv" },
        { "radtan", "opencv" }, { "brown", "opencv" }, { "none", "opencv" },
        { "fisheye", "fisheye" }, { "equidistant", "fisheye" }, { "equi", "fisheye" }, { "kannala_brandt", "fisheye" } };
    const auto found = names.find(name);
    return found == names.end() ? String() : found->second;
}

//! path/name.yml -> path/.part1234-0.name.yml, of each writer another: the extension chooses FileStorage's format.
static String partName(const String& filename)
{
    static std::atomic<unsigned> writers(0);
#ifdef _WIN32
    const unsigned long process = GetCurrentProcessId();
#else
    const unsigned long process = (unsigned long)getpid();
#endif
    const size_t slash = filename.find_last_of("/\\"), name = slash == String::npos ? 0 : slash + 1;
    return filename.substr(0, name) + format(".part%lu-%u.", process, writers++) + filename.substr(name);
}

//! In one step where the system has one.
static bool moveOver(const String& from, const String& to)
{
#ifdef _WIN32
    return MoveFileExA(from.c_str(), to.c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH) != 0;
#else
    return std::rename(from.c_str(), to.c_str()) == 0;
#endif
}

//! Where links lead to: they stay, what they lead to is replaced.
static String targetOfLinks(const String& filename)
{
    String target = filename;
#ifndef _WIN32
    char next[4096];
    for (int i = 0; i < 40; i++)
    {
        const ssize_t length = readlink(target.c_str(), next, sizeof(next));
        if (length <= 0 || length == (ssize_t)sizeof(next))
            break;
        const size_t slash = next[0] == '/' ? String::npos : target.rfind('/');
        target = (slash == String::npos ? String() : target.substr(0, slash + 1)) + String(next, length);
    }
#endif
    return target;
}

//! A device or a pipe takes the bytes, and must not be replaced; a read-only file must stay, also if root asks.
static void askWhatIsThere(const String& filename, bool& special, bool& readOnly)
{
    special = readOnly = false;
#ifndef _WIN32
    struct stat there;
    if (stat(filename.c_str(), &there) != 0)
        return;
    special = !S_ISREG(there.st_mode) && !S_ISDIR(there.st_mode);
    readOnly = S_ISREG(there.st_mode) && (!(there.st_mode & 0222) || access(filename.c_str(), W_OK) != 0);
#else
    const DWORD there = GetFileAttributesA(filename.c_str());
    if (there == INVALID_FILE_ATTRIBUTES)
        return;
    special = (there & FILE_ATTRIBUTE_DEVICE) != 0;
    readOnly = !(there & FILE_ATTRIBUTE_DIRECTORY) && (there & FILE_ATTRIBUTE_READONLY);
#endif
}

void saveWhole(const String& filename, const std::function<bool(const String& path)>& write)
{
    bool special, readOnly;
    askWhatIsThere(filename, special, readOnly);
    const String target = targetOfLinks(filename), part = special ? filename : partName(target);
    // FileStorage would log a line of its own. A pipe is opened once: closed, it would end for its reader.
    if (readOnly || (!special && !std::ofstream(part.c_str())))
        CV_Error_(Error::StsError, ("%s cannot be written", filename.c_str()));
    if (write(part) && (special || moveOver(part, target)))
        return;
    if (!special)
        std::remove(part.c_str());
    CV_Error_(Error::StsError, ("%s cannot be written", filename.c_str()));
}

static bool isCompressed(const String& filename)
{
    return filename.size() > 3 && filename.compare(filename.size() - 3, 3, ".gz") == 0;
}

//! FileStorage does not tell what a full disk swallowed; the text is written by a stream that does.
static bool writeStorage(const String& path, const std::function<void(FileStorage&)>& write)
{
    const String plain = isCompressed(path) ? path.substr(0, path.size() - 3) : path;
    FileStorage memory(plain, FileStorage::WRITE | FileStorage::MEMORY);
    if (!memory.isOpened())
        return false;
    write(memory);
    std::ofstream out(path.c_str(), std::ios::binary);
    out << memory.releaseAndGetString();
    out.close();
    if (!out || !isCompressed(path))
        return (bool)out;
    FileStorage compressed(path, FileStorage::WRITE);       // where there was room for the text there is for this
    if (compressed.isOpened())
        write(compressed);
    return compressed.isOpened();
}

void saveStorage(const String& filename, const std::function<void(FileStorage&)>& write)
{
    saveWhole(filename, [&](const String& path) { return writeStorage(path, write); });
}

}} // namespace
