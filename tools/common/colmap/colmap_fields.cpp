// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "colmap/colmap_fields.hpp"
#include "console/failure.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

namespace tools {

void ColmapFields::requireLeft(uint64_t count, int bytesEach) const
{
    if (count > (bytes_.size() - at_)/(unsigned)bytesEach)
        throw Failure("it ends too early: is it cut short?");
}

void ColmapFields::raw(void* value, size_t size)
{
    if (!isReading_)
    {
        bytes_.append((const char*)value, size);
        return;
    }
    requireLeft(1, (int)size);
    std::memcpy(value, bytes_.data() + at_, size);
    at_ += size;
}

bool ColmapFields::atBlank() const { return bytes_[at_] == ' ' || bytes_[at_] == '\t' || bytes_[at_] == '\r'; }

//! After blanks.
bool ColmapFields::atEndOfLine()
{
    while (at_ < bytes_.size() && atBlank())
        at_++;
    return at_ == bytes_.size() || bytes_[at_] == '\n';
}

void ColmapFields::nextLine()
{
    at_ = std::min(bytes_.find('\n', at_), bytes_.size() - 1) + 1;
    line_++;
}

template<typename T> void ColmapFields::parse(T& value)
{
    if (atEndOfLine())
        throw Failure("a number is missing at its end");
    std::string text;
    word(text);
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc() || result.ptr != text.data() + text.size())
        throw Failure("'" + text.substr(0, 40) + "' is not the number that belongs there");
}

template<typename T> void ColmapFields::plain(T& value)
{
    if (isBinary_)
        raw(&value, sizeof value);
    else if (isReading_)
        parse(value);
    else
    {
        char text[64];
        std::string digits(text, std::to_chars(text, text + sizeof text, value).ptr);
        word(digits);
    }
}
template void ColmapFields::plain(double&);
template void ColmapFields::plain(uint32_t&);

void ColmapFields::number(uint64_t& value)
{
    const bool isNone = !isBinary_ && (isReading_ ? !atEndOfLine() && bytes_[at_] == '-' : value == UINT64_MAX);
    int64_t none = -1;
    isNone ? plain(none) : plain(value);
    value = isNone ? (uint64_t)none : value;
}

void ColmapFields::number(uint8_t& value)
{
    if (isBinary_)
        return raw(&value, sizeof value);
    uint32_t whole = value;
    plain(whole);
    if (whole > 255)
        throw Failure("'" + std::to_string(whole) + "' is above 255");
    value = (uint8_t)whole;
}

void ColmapFields::word(std::string& text)
{
    if (isBinary_ && isReading_)
    {
        const size_t end = bytes_.find('\0', at_);
        requireLeft(end - at_, 1);
        text = bytes_.substr(at_, end - at_);
        at_ = end + 1;
    }
    else if (isBinary_)
        bytes_.append(text.c_str(), text.size() + 1);
    else if (isReading_)
    {
        if (atEndOfLine())
            throw Failure("something is missing at its end");
        const size_t begin = at_;
        at_ = std::min(bytes_.find_first_of(" \t\r\n", at_), bytes_.size());
        text = bytes_.substr(begin, at_ - begin);
    }
    else
        bytes_ += (bytes_.empty() || bytes_.back() == '\n' ? "" : " ") + text;
}

void ColmapFields::restOfLine(std::string& text)
{
    const size_t begin = at_;
    word(text);
    if (isBinary_ || !isReading_)
        return;
    const std::string line = bytes_.substr(begin, bytes_.find('\n', begin) - begin);
    const size_t first = line.find_first_not_of(" \t");
    text = line.substr(first, line.find_last_not_of(" \t\r") + 1 - first);
    at_ = begin + first + text.size();
}

void ColmapFields::kind(int& value, const std::vector<std::string>& words, const std::string& what)
{
    if (isBinary_)
        raw(&value, sizeof(int32_t));
    std::string text = value >= 0 && value < (int)words.size() ? words[value] : std::to_string(value);
    if (!isBinary_)
        word(text);
    value = (int)(std::find(words.begin(), words.end(), text) - words.begin());
    if (value == (int)words.size())
        throw Failure("'" + text + "' is no " + what + " of COLMAP's that is known here");
}

uint64_t ColmapFields::list(uint64_t count, int each, int bytesEach)
{
    if (isBinary_)
        raw(&count, sizeof count);
    if (isBinary_ && isReading_)
        requireLeft(count, bytesEach);
    if (isBinary_ || !isReading_)
        return count;
    const char BLANKS[] = " \t\r";
    const size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    uint64_t words = 0;
    for (size_t at = bytes_.find_first_not_of(BLANKS, at_); at < end; words++)
        at = bytes_.find_first_not_of(BLANKS, bytes_.find_first_of(" \t\r\n", at));
    if (words % (unsigned)each)
        throw Failure("its list has " + std::to_string(words) + " entries, which are " + std::to_string(each) + " for each");
    return words/(unsigned)each;
}

uint32_t ColmapFields::shortList(uint32_t count, int bytesEach)
{
    number(count);
    if (isReading_)
        requireLeft(count, isBinary_ ? bytesEach : 1);
    return count;
}

void ColmapFields::endLine()
{
    if (isBinary_)
        return;
    if (!isReading_)
        bytes_ += '\n';
    else if (!atEndOfLine())
        throw Failure("there is more than its numbers");
    else
        nextLine();
}

uint64_t ColmapFields::records(uint64_t count) { return isBinary_ ? list(count, 0, 1) : count; }

bool ColmapFields::more(uint64_t done, uint64_t count)
{
    if (!isBinary_ && isReading_)
    {
        while (at_ < bytes_.size() && (atEndOfLine() || bytes_[at_] == '#'))
            nextLine();
        return at_ < bytes_.size();
    }
    if (done == count && isReading_ && at_ < bytes_.size())
        throw Failure(std::to_string(bytes_.size() - at_) + " bytes follow its last record");
    return done < count;
}

} // namespace tools
