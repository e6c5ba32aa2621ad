// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/colmap_fields.hpp"
#include "formats/bytes.hpp"

#include <charconv>
#include <cstring>

namespace tools {

namespace {

const char CUT[] = "it ends too early: is it cut short?";

class BinaryReader : public ColmapFields
{
public:
    explicit BinaryReader(const std::string& bytes) : in_(bytes) {}
    void number(uint32_t& value) override { value = in_.number<uint32_t>(); }
    void number(uint64_t& value) override { value = in_.number<uint64_t>(); }
    void number(double& value) override { value = in_.number<double>(); }
    void number(uint8_t& value) override { value = in_.number<uint8_t>(); }
    void word(std::string& text) override
    {
        text.clear();
        for (char c = in_.number<char>(); c != 0; c = in_.number<char>())
            text += c;
    }
    void kind(int& value, const char* const*, int) override { value = in_.number<int32_t>(); }
    uint64_t list(uint64_t, int, int bytesEach) override { return counted(in_.number<uint64_t>(), bytesEach); }
    uint32_t shortList(uint32_t, int bytesEach) override { return (uint32_t)counted(in_.number<uint32_t>(), bytesEach); }
    void endLine() override {}
    uint64_t records(uint64_t) override { return counted(in_.number<uint64_t>(), 1); }
    bool more(uint64_t done, uint64_t count) override { return done < count; }
    void end() override
    {
        if (in_.left() > 0)
            throw Failure(std::to_string(in_.left()) + " bytes follow its last record");
    }
    bool isReading() const override { return true; }

private:
    uint64_t counted(uint64_t count, int bytesEach) const
    {
        if (count > in_.left()/(unsigned)bytesEach)
            throw Failure(CUT);
        return count;
    }
    ByteReader in_;
};

class BinaryWriter : public ColmapFields
{
public:
    explicit BinaryWriter(std::string& bytes) : out_(bytes) {}
    void number(uint32_t& value) override { put(value); }
    void number(uint64_t& value) override { put(value); }
    void number(double& value) override { put(value); }
    void number(uint8_t& value) override { put(value); }
    void word(std::string& text) override { out_.append(text.c_str(), text.size() + 1); }
    void kind(int& value, const char* const*, int) override { put((int32_t)value); }
    uint64_t list(uint64_t count, int, int) override
    {
        put(count);
        return count;
    }
    uint32_t shortList(uint32_t count, int) override
    {
        put(count);
        return count;
    }
    void endLine() override {}
    uint64_t records(uint64_t count) override { return list(count, 0, 0); }
    bool more(uint64_t done, uint64_t count) override { return done < count; }
    void end() override {}
    bool isReading() const override { return false; }

private:
    template<typename T> void put(T value) { out_.append((const char*)&value, sizeof value); }
    std::string& out_;
};

//! One record a line; an image has two, of which the second may be empty.
class TextReader : public ColmapFields
{
public:
    explicit TextReader(const std::string& bytes) : at_(bytes.data()), end_(bytes.data() + bytes.size()) {}

    void number(uint32_t& value) override { parse(value); }
    void number(uint64_t& value) override
    {
        if (peek() == '-')              // none, as COLMAP writes it
        {
            int64_t negative = 0;
            parse(negative);
            value = (uint64_t)negative;
        }
        else
            parse(value);
    }
    void number(double& value) override { parse(value); }
    void number(uint8_t& value) override
    {
        uint32_t whole = 0;
        parse(whole);
        if (whole > 255)
            fail("'" + std::to_string(whole) + "' is above 255");
        value = (uint8_t)whole;
    }
    void word(std::string& text) override
    {
        if (peek() == 0)
            fail("something is missing at its end");
        const char* const begin = at_;
        while (at_ < end_ && !isBlank(*at_) && *at_ != '\n')
            at_++;
        text.assign(begin, at_);
    }
    void kind(int& value, const char* const* words, int count) override
    {
        std::string text;
        word(text);
        for (value = 0; value < count && text != words[value]; value++)
            ;
        if (value == count)
            fail("'" + text + "' is not known");
    }
    uint64_t list(uint64_t, int each, int) override
    {
        uint64_t words = 0;
        bool inWord = false;
        for (const char* c = at_; c < end_ && *c != '\n'; c++)
        {
            words += !isBlank(*c) && !inWord;
            inWord = !isBlank(*c);
        }
        if (words % (unsigned)each)
            fail("its list has " + std::to_string(words) + " entries, which are " + std::to_string(each) + " for each");
        return words/(unsigned)each;
    }
    uint32_t shortList(uint32_t, int) override
    {
        uint32_t count = 0;
        parse(count);
        if (count > end_ - at_)
            fail(CUT);
        return count;
    }
    void endLine() override
    {
        if (peek() != 0)
            fail("there is more than its numbers");
        nextLine();
    }
    uint64_t records(uint64_t) override { return 0; }
    bool more(uint64_t, uint64_t) override
    {
        while (at_ < end_ && (peek() == 0 || *at_ == '#'))
            nextLine();
        return at_ < end_;
    }
    void end() override {}
    bool isReading() const override { return true; }
    std::string where() const override { return "line " + std::to_string(line_) + ": "; }

private:
    static bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
    [[noreturn]] void fail(const std::string& what) const { throw Failure(what); }
    //! The next letter of the line; 0: none.
    char peek()
    {
        while (at_ < end_ && isBlank(*at_))
            at_++;
        return at_ < end_ && *at_ != '\n' ? *at_ : 0;
    }
    void nextLine()
    {
        const void* const newline = std::memchr(at_, '\n', (size_t)(end_ - at_));
        at_ = newline ? (const char*)newline + 1 : end_;
        line_++;
    }
    template<typename T> void parse(T& value)
    {
        if (peek() == 0)
            fail("a number is missing at its end");
        const auto result = std::from_chars(at_, end_, value);
        if (result.ec != std::errc() || (result.ptr < end_ && !isBlank(*result.ptr) && *result.ptr != '\n'))
        {
            std::string text;
            word(text);
            fail("'" + text.substr(0, 40) + "' is not the number that belongs there");
        }
        at_ = result.ptr;
    }

    const char* at_;
    const char* end_;
    int line_ = 1;
};

class TextWriter : public ColmapFields
{
public:
    explicit TextWriter(std::string& bytes) : out_(bytes) {}
    void number(uint32_t& value) override { put(value); }
    void number(uint64_t& value) override
    {
        if (value == UINT64_MAX)
            put(-1);
        else
            put(value);
    }
    void number(double& value) override { put(value); }
    void number(uint8_t& value) override { put((uint32_t)value); }
    void word(std::string& text) override { separate() += text; }
    void kind(int& value, const char* const* words, int) override { separate() += words[value]; }
    uint64_t list(uint64_t count, int, int) override { return count; }
    uint32_t shortList(uint32_t count, int) override
    {
        put(count);
        return count;
    }
    void endLine() override
    {
        out_ += '\n';
        isFirst_ = true;
    }
    uint64_t records(uint64_t count) override { return count; }
    bool more(uint64_t done, uint64_t count) override { return done < count; }
    void end() override {}
    bool isReading() const override { return false; }

private:
    std::string& separate()
    {
        if (!isFirst_)
            out_ += ' ';
        isFirst_ = false;
        return out_;
    }
    template<typename T> void put(T value)
    {
        char text[64];
        const auto result = std::to_chars(text, text + sizeof text, value);
        separate().append(text, result.ptr);
    }
    std::string& out_;
    bool isFirst_ = true;
};

} // namespace

std::unique_ptr<ColmapFields> colmapReader(const std::string& bytes, bool isBinary)
{
    if (isBinary)
        return std::make_unique<BinaryReader>(bytes);
    return std::make_unique<TextReader>(bytes);
}

std::unique_ptr<ColmapFields> colmapWriter(std::string& bytes, bool isBinary)
{
    if (isBinary)
        return std::make_unique<BinaryWriter>(bytes);
    return std::make_unique<TextWriter>(bytes);
}

} // namespace tools
