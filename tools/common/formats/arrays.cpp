// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/foreign_file.hpp"

#include <algorithm>
#include <map>
#include <zlib.h>

/* NumPy's and MATLAB's files: arrays by name, which zlib has made smaller. */

namespace tools {

namespace {

const size_t MOST_OF_ARRAY = 100000;        // numbers of a camera are few; images may stand beside them

template<typename T> double next(ByteReader& in) { return (double)in.number<T>(); }

const std::map<std::string, double (*)(ByteReader&)> TYPES = {
    {"i1", next<int8_t>}, {"i2", next<int16_t>}, {"i4", next<int32_t>}, {"i8", next<int64_t>}, {"u1", next<uint8_t>},
    {"u2", next<uint16_t>}, {"u4", next<uint32_t>}, {"u8", next<uint64_t>}, {"f4", next<float>}, {"f8", next<double>}};

//! Of the list that begins with this number.
Json nested(const std::vector<double>& numbers, const std::vector<size_t>& shape, const std::vector<size_t>& stride, size_t level,
            size_t first)
{
    if (level == shape.size())
        return numbers[first];
    Json list = Json::array();
    for (size_t i = 0; i < shape[level]; i++)
        list.append(nested(numbers, shape, stride, level + 1, first + i*stride[level]));
    return list;
}

//! All of the bytes. @param type as NumPy names it, i4 or f8
std::vector<double> readNumbers(const std::string& bytes, const std::string& type)
{
    std::vector<double> numbers;
    for (ByteReader in(bytes); in.left() > 0; )
        numbers.push_back(TYPES.at(type)(in));
    return numbers;
}

//! Lists in lists. @param isColumnMajor the first index is the fastest
Json nestedLists(const std::vector<double>& numbers, const std::vector<size_t>& shape, bool isColumnMajor)
{
    std::vector<size_t> stride(shape.size());
    size_t count = 1;
    for (size_t i = 0; i < shape.size(); i++)
    {
        const size_t axis = isColumnMajor ? i : shape.size() - 1 - i;
        stride[axis] = count;
        count *= shape[axis];
    }
    if (numbers.size() < count)
        throw Failure("a matrix has too few numbers: is it cut short?");
    return nested(numbers, shape, stride, 0, 0);
}

/** What zlib has made smaller. @param raw without zlib's own heading, as in a zip file */
std::string inflated(const std::string& bytes, bool raw)
{
    const size_t MOST = 64 << 20;           // a camera is small; a file that claims more is none
    z_stream stream = {};
    stream.next_in = (Bytef*)bytes.data();
    stream.avail_in = (uInt)bytes.size();
    std::string result;
    char buffer[16384];
    int state = inflateInit2(&stream, raw ? -MAX_WBITS : MAX_WBITS);
    while (state == Z_OK && result.size() < MOST)
    {
        stream.next_out = (Bytef*)buffer;
        stream.avail_out = sizeof buffer;
        state = inflate(&stream, Z_NO_FLUSH);
        result.append(buffer, sizeof buffer - stream.avail_out);
    }
    inflateEnd(&stream);
    if (state != Z_STREAM_END)
        throw Failure("what is compressed in it is damaged: is it cut short?");
    return result;
}

// ---- NumPy

//! The value of a key of the heading, which is a map of Python's.
std::string valueOf(const std::string& heading, const std::string& key, const std::string& ends)
{
    const size_t at = heading.find("'" + key + "':");
    const size_t begin = at == std::string::npos ? at : heading.find_first_not_of(" '(<|=", at + key.size() + 3);
    if (begin == std::string::npos)
        throw Failure("an array's heading has no " + key);
    return heading.substr(begin, heading.find_first_of(ends, begin) - begin);
}

//! One array; null where it has no numbers, a text where it has such as are not read.
Json readNpy(const std::string& bytes)
{
    ByteReader in(bytes);
    if (in.take(6) != "\x93NUMPY")
        return nullptr;
    const int version = in.number<uint8_t>();
    in.skip(1);
    const std::string heading = in.take(version > 1 ? in.number<uint32_t>() : in.number<uint16_t>());
    const std::string type = valueOf(heading, "descr", "'");
    bool isShape;
    const std::vector<double> lengths = leadingNumbers(valueOf(heading, "shape", ")"), &isShape);
    if (!isShape || std::any_of(lengths.begin(), lengths.end(), [](double n) { return !(n >= 0 && n < 1e6); }))
        throw Failure("an array's shape is wrong");
    const std::vector<size_t> shape(lengths.begin(), lengths.end());
    if (!TYPES.count(type) && type.find_first_of("iufc") < type.find_first_of("0123456789"))
        return "numbers of type " + type + ": save them as float64";
    if (!TYPES.count(type) || shape.size() > 3)
        return nullptr;
    size_t count = 1;
    for (size_t n : shape)
        count *= n;
    if (count > bytes.size())
        throw Failure("an array is larger than the file: is it cut short?");
    if (count == 0 || count > MOST_OF_ARRAY)
        return nullptr;
    const bool isFortran = valueOf(heading, "fortran_order", ",}").compare(0, 4, "True") == 0;
    return nestedLists(readNumbers(in.take(count*(size_t)(type[1] - '0')), type), shape, isFortran);
}

// ---- MATLAB

//! A piece of the file: what it is, and its bytes.
struct Element
{
    uint32_t type;
    std::string data;

    //! Empty where it has none.
    std::vector<double> numbers() const
    {
        const char* const NAMES[] = {"", "i1", "u1", "i2", "u2", "i4", "u4", "f4", "", "f8", "", "", "i8", "u8"};
        const std::string name = type < std::size(NAMES) ? NAMES[type] : "";
        return name.empty() ? std::vector<double>() : readNumbers(data, name);
    }
};
const uint32_t MATRIX = 14, COMPRESSED = 15;

//! Short ones have type and size in four bytes; others are filled up to eight.
Element nextElement(ByteReader& in)
{
    const uint32_t tag = in.number<uint32_t>();
    if (tag >> 16)
        return {tag & 0xffff, in.take(4).substr(0, tag >> 16)};
    const uint32_t size = in.number<uint32_t>();
    const Element element{tag, in.take(size)};
    if (tag != COMPRESSED)
        in.skip(std::min<size_t>((8 - size % 8) % 8, in.left()));
    return element;
}

Json readVariable(const std::string& bytes, std::string& name, int depth);

//! Of one element: its members.
Json structOf(ByteReader& in, int depth)
{
    const std::vector<double> width = nextElement(in).numbers();
    const std::string names = nextElement(in).data;
    const size_t each = !width.empty() && width[0] >= 1 && width[0] <= names.size() ? (size_t)width[0] : names.size() + 1;
    Json json = Json::object();
    for (size_t at = 0; at + each <= names.size(); at += each)
    {
        const std::string member = names.substr(at, std::min(each, names.find('\0', at) - at));
        std::string unused;
        json.set(member, readVariable(nextElement(in).data, unused, depth + 1));
    }
    return json;
}

//! A text for an object, null for all else that has no numbers.
Json readVariable(const std::string& bytes, std::string& name, int depth)
{
    const int DEEPEST = 20, STRUCT = 2, FIRST_OF_NUMBERS = 6, LAST_OF_NUMBERS = 15, OBJECT = 17;
    if (bytes.empty() || depth > DEEPEST)
        return nullptr;
    ByteReader in(bytes);
    const std::vector<double> flags = nextElement(in).numbers();
    const int kind = flags.empty() || !(flags[0] >= 0 && flags[0] <= UINT32_MAX) ? 0 : (int)((uint32_t)flags[0] & 0xff);
    if (kind == OBJECT)
    {
        name = nextElement(in).data;
        return "object";
    }
    const std::vector<double> size = nextElement(in).numbers();
    name = nextElement(in).data;
    const auto isLength = [](double n) { return n >= 0 && n <= MOST_OF_ARRAY; };
    const bool isFlat = size.size() == 2 && isLength(size[0]) && isLength(size[1]) && isLength(size[0]*size[1]);
    if (kind == STRUCT && isFlat && size[0] == 1 && size[1] == 1)
        return structOf(in, depth);
    if (!isFlat || kind < FIRST_OF_NUMBERS || kind > LAST_OF_NUMBERS)
        return nullptr;
    return nestedLists(nextElement(in).numbers(), {(size_t)size[0], (size_t)size[1]}, true);
}

} // namespace

//! Offsets are those of the zip format; the directory at the end has the sizes, which the entries themselves need not have.
Json readNpz(const ForeignFile& file)
{
    const std::string& bytes = file.bytes;
    const size_t end = bytes.rfind("PK\x05\x06");
    if (end == std::string::npos)
        throw Failure("it has no directory at its end: is it cut short?");
    const auto two = [&](size_t at) { return (size_t)ByteReader(bytes, at).number<uint16_t>(); };
    const auto four = [&](size_t at) { return (size_t)ByteReader(bytes, at).number<uint32_t>(); };
    Json json = Json::object();
    size_t entry = four(end + 16);
    for (size_t left = two(end + 10); left > 0; left--)
    {
        if (ByteReader(bytes, entry).take(4) != "PK\x01\x02")
            throw Failure("its directory is damaged");
        const size_t method = two(entry + 10), begin = four(entry + 42), DEFLATED = 8;
        std::string key = ByteReader(bytes, entry + 46).take(two(entry + 28));
        const std::string data = ByteReader(bytes, begin + 30 + two(begin + 26) + two(begin + 28)).take(four(entry + 20));
        if (method != 0 && method != DEFLATED)
            throw Failure("it is compressed in a way that is not read: save it with numpy.savez");
        entry += 46 + key.size() + two(entry + 30) + two(entry + 32);
        if (key.size() > 4 && key.compare(key.size() - 4, 4, ".npy") == 0)
            key.resize(key.size() - 4);
        json.set(key, readNpy(method == DEFLATED ? inflated(data, true) : data));
    }
    return json;
}

Json readMat(const ForeignFile& file)
{
    const size_t HEADING = 128;
    ByteReader in(file.bytes);
    if (file.bytes.compare(0, 10, "MATLAB 7.3") == 0)
        throw Failure("files of version 7.3 are not read: save it with save -v7");
    if (in.take(HEADING).substr(HEADING - 2) != "IM")
        throw Failure("it was written on a machine of the other byte order: save it again with MATLAB's save -v7");
    Json json = Json::object();
    while (in.left() >= 8)
    {
        Element element = nextElement(in);
        if (element.type == COMPRESSED)
        {
            const std::string inner = inflated(element.data, false);
            ByteReader unpacked(inner);
            element = nextElement(unpacked);
        }
        std::string name;
        const Json value = element.type == MATRIX ? readVariable(element.data, name, 0) : Json();
        if (element.type == MATRIX)
            json.set(name, value);
    }
    return json;
}

} // namespace tools
