// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/notations.hpp"
#include "formats/bytes.hpp"

#include <cstdint>

namespace tools {

namespace {

bool isKnown(const std::string& type)
{
    const auto isOne = [](char c, const char* of) { return std::string(of).find(c) != std::string::npos; };
    return type.size() == 2 && isOne(type[0], "iuf") && isOne(type[1], "1248") && (type[0] != 'f' || type[1] > '2');
}

//! Lists in lists, of numbers in the order of memory.
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

//! The value of a key of the heading, which is a map of Python's.
std::string valueOf(const std::string& heading, const std::string& key, const std::string& ends)
{
    const size_t at = heading.find("'" + key + "':");
    const size_t begin = at == std::string::npos ? at : heading.find_first_not_of(" '(<|=", at + key.size() + 3);
    if (begin == std::string::npos)
        throw Failure("an array's heading has no " + key);
    return heading.substr(begin, heading.find_first_of(ends, begin) - begin);
}

std::vector<size_t> shapeOf(const std::string& text)
{
    const Json list = readYaml("[" + text + "]");
    std::vector<size_t> shape;
    for (double n : list.asNumbers())
        if (n >= 0 && n < 1e6)
            shape.push_back((size_t)n);
        else
            throw Failure("an array's shape is wrong");
    return shape;
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
    const std::vector<size_t> shape = shapeOf(valueOf(heading, "shape", ")"));
    if (!isKnown(type) && type.find_first_of("iufc") < type.find_first_of("0123456789"))
        return "numbers of type " + type + ": save them as float64";
    if (!isKnown(type) || shape.size() > 3)
        return nullptr;
    const bool fortran = valueOf(heading, "fortran_order", ",}").compare(0, 4, "True") == 0;
    std::vector<size_t> stride(shape.size());
    size_t count = 1;
    for (size_t i = 0; i < shape.size(); i++)
    {
        const size_t axis = fortran ? i : shape.size() - 1 - i;
        stride[axis] = count;
        count *= shape[axis];
        if (count > bytes.size())
            throw Failure("an array is larger than the file: is it cut short?");
        if (count == 0)
            return nullptr;
    }
    const size_t MOST = 100000;         // numbers of a camera are few; images may stand beside them
    if (count > MOST)
        return nullptr;
    std::vector<double> numbers;
    for (size_t i = 0; i < count; i++)
        numbers.push_back(in.number(type[0], type[1] - '0'));
    return nested(numbers, shape, stride, 0, 0);
}

} // namespace

Json readNpz(const std::string& bytes)
{
    // The directory at the end has the sizes, which the entries themselves need not have.
    const size_t end = bytes.rfind("PK\x05\x06");
    if (end == std::string::npos)
        throw Failure("it has no directory at its end: is it cut short?");
    ByteReader tail(bytes);
    tail.skip(end + 10);
    const int entries = tail.number<uint16_t>();
    tail.skip(4);
    ByteReader directory(bytes);
    directory.skip(tail.number<uint32_t>());
    Json json = Json::object();
    for (int i = 0; i < entries; i++)
    {
        if (directory.take(4) != "PK\x01\x02")
            throw Failure("its directory is damaged");
        directory.skip(6);
        const int method = directory.number<uint16_t>();
        directory.skip(8);
        const uint32_t size = directory.number<uint32_t>();
        directory.skip(4);
        const size_t name = directory.number<uint16_t>(), extra = directory.number<uint16_t>(), comment = directory.number<uint16_t>();
        directory.skip(8);
        const uint32_t begin = directory.number<uint32_t>();
        std::string key = directory.take(name);
        directory.skip(extra + comment);
        ByteReader local(bytes);
        local.skip((size_t)begin + 26);
        const size_t skip = local.number<uint16_t>();
        local.skip(skip + local.number<uint16_t>());
        const std::string data = local.take(size);
        if (method != 0 && method != 8)
            throw Failure("it is compressed in a way that is not read: save it with numpy.savez");
        if (key.size() > 4 && key.compare(key.size() - 4, 4, ".npy") == 0)
            key.resize(key.size() - 4);
        json.set(key, readNpy(method == 8 ? inflated(data, true) : data));
    }
    return json;
}

} // namespace tools
