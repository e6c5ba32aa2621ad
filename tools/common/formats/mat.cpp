// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/notations.hpp"
#include "formats/bytes.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace tools {

namespace {

const int DEEPEST = 20;

//! A piece of the file: what it is, and its bytes.
struct Element
{
    uint32_t type;
    std::string data;
};

//! Short ones have type and size in four bytes; others are filled up to eight.
Element nextElement(ByteReader& in)
{
    const uint32_t tag = in.number<uint32_t>();
    if (tag >> 16)
    {
        const std::string data = in.take(4);
        return {tag & 0xffff, data.substr(0, std::min<size_t>(tag >> 16, 4))};
    }
    const uint32_t size = in.number<uint32_t>();
    Element element{tag, in.take(size)};
    const uint32_t COMPRESSED = 15;
    if (tag != COMPRESSED)
        in.skip(std::min<size_t>((8 - size % 8) % 8, in.left()));
    return element;
}

std::vector<double> numbersOf(const Element& element)
{
    const char* const TYPES[] = {"", "i1", "u1", "i2", "u2", "i4", "u4", "f4", "", "f8", "", "", "i8", "u8"};
    const char* const type = element.type < sizeof TYPES/sizeof *TYPES ? TYPES[element.type] : "";
    ByteReader in(element.data);
    std::vector<double> numbers;
    while (*type && in.left() > 0)
        numbers.push_back(in.number(type[0], type[1] - '0'));
    return numbers;
}

const double MOST = 1e5;        // numbers of a matrix: those of a camera are few, images may stand beside them

Json matrixOf(const std::vector<double>& numbers, size_t rows, size_t columns)
{
    if (numbers.size() < rows*columns)
        throw Failure("a matrix has too few numbers: is it cut short?");
    Json json = Json::array();
    for (size_t row = 0; row < rows; row++)
    {
        Json line = Json::array();
        for (size_t column = 0; column < columns; column++)
            line.append(numbers[column*rows + row]);
        json.append(line);
    }
    return json;
}

Json readVariable(const std::string& bytes, std::string& name, int depth);

//! Of one element: its members.
Json structOf(ByteReader& in, int depth)
{
    const std::vector<double> width = numbersOf(nextElement(in));
    const Element names = nextElement(in);
    const size_t each = !width.empty() && width[0] >= 1 && width[0] <= MOST ? (size_t)width[0] : names.data.size() + 1;
    Json json = Json::object();
    for (size_t at = 0; at + each <= names.data.size(); at += each)
    {
        const std::string member = names.data.substr(at, std::min(each, names.data.find('\0', at) - at));
        std::string unused;
        json.set(member, readVariable(nextElement(in).data, unused, depth + 1));
    }
    return json;
}

//! A text for an object, null for all else that has no numbers.
Json readVariable(const std::string& bytes, std::string& name, int depth)
{
    if (bytes.empty() || depth > DEEPEST)
        return nullptr;
    ByteReader in(bytes);
    const std::vector<double> flags = numbersOf(nextElement(in));
    const bool isKnown = !flags.empty() && flags[0] >= 0 && flags[0] <= std::numeric_limits<uint32_t>::max();
    const int kind = isKnown ? (int)((uint32_t)flags[0] & 0xff) : 0, OBJECT = 17;
    if (kind == OBJECT)
    {
        name = nextElement(in).data;
        return "object";
    }
    const std::vector<double> size = numbersOf(nextElement(in));
    name = nextElement(in).data;
    const bool isFlat = size.size() == 2 && size[0] >= 0 && size[0] <= MOST && size[1] >= 0 && size[1] <= MOST && size[0]*size[1] <= MOST;
    const int STRUCT = 2, FIRST_OF_NUMBERS = 6, LAST_OF_NUMBERS = 15;
    if (kind == STRUCT && isFlat && size[0] == 1 && size[1] == 1)
        return structOf(in, depth);
    if (!isFlat || kind < FIRST_OF_NUMBERS || kind > LAST_OF_NUMBERS)
        return nullptr;
    return matrixOf(numbersOf(nextElement(in)), (size_t)size[0], (size_t)size[1]);
}

} // namespace

Json readMat(const std::string& bytes)
{
    const size_t HEADING = 128;
    const uint32_t MATRIX = 14, COMPRESSED = 15;
    ByteReader in(bytes);
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
        if (element.type != MATRIX)
            continue;
        const Json value = readVariable(element.data, name, 0);
        json.set(name, value);
    }
    return json;
}

} // namespace tools
