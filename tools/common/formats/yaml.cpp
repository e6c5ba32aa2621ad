// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/numbers.hpp"
#include "console/table.hpp"
#include "formats/foreign_file.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string_view>

namespace tools {

namespace {

const int DEEPEST = 50;         // what calls itself for each level must not be led on by a file
const char BLANKS[] = " \t\r", BLANKS_AND_LINES[] = " \t\r\n";

//! Every line ends in \n; those of YAML's own signs are empty, so that numbers of lines stay.
std::string plainLines(const std::string& text)
{
    std::istringstream in(text);
    std::string result;
    for (std::string line; takeLine(in, line); result += '\n')
    {
        const size_t first = std::min(line.find_first_not_of(BLANKS), line.size());
        if (line.compare(first, 3, "---") != 0 && line.compare(first, 1, "%") != 0 && line.compare(first, line.npos, "...") != 0)
            result += line;
    }
    return result;
}

std::string trimmed(const std::string& text)
{
    const size_t first = text.find_first_not_of(BLANKS_AND_LINES);
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(BLANKS_AND_LINES) - first + 1);
}

//! Takes each value from where the text is read, and goes on after it.
class YamlReader
{
public:
    explicit YamlReader(const std::string& text) : text_(plainLines(text)) {}

    Json read()
    {
        const Json json = toContent() ? block(0) : Json();
        if (toContent())
            fail(at_, beginning() + " belongs to nothing above it");
        return json;
    }

private:
    [[noreturn]] void fail(size_t at, const std::string& what) const
    {
        throw Json::Error("line " + std::to_string(1 + std::count(text_.data(), text_.data() + at, '\n')) + ": " + what);
    }
    [[noreturn]] void failOpen(size_t at) const { fail(at, "a bracket or quote is not closed; is the file cut short?"); }

    //! A key or a plain text from here; a bracket in it that another has not closed was meant to begin a list.
    std::string plain(size_t begin, size_t end) const
    {
        const std::string text = text_.substr(begin, end - begin);
        const auto count = [&](char c) { return std::count(text.begin(), text.end(), c); };
        if (count('[') != count(']') || count('{') != count('}'))
            failOpen(begin);
        return trimmed(text);
    }

    bool is(std::string_view these, size_t after = 0) const
    {
        return at_ + after < text_.size() && these.find(text_[at_ + after]) != these.npos;
    }
    bool isItem() const { return is("-") && is(BLANKS_AND_LINES, 1); }
    void skip(const char* these) { at_ = std::min(text_.find_first_not_of(these, at_), text_.size()); }
    size_t column() const { return at_ == 0 ? 0 : at_ - 1 - text_.rfind('\n', at_ - 1); }
    size_t endOfLine() const { return std::min(text_.find('\n', at_), text_.size()); }
    std::string beginning() const { return "'" + text_.substr(at_, std::min<size_t>(endOfLine() - at_, 30)) + "'"; }

    //! Past blanks, comments and lines; false: nothing follows.
    bool toContent()
    {
        for (skip(BLANKS_AND_LINES); is("#"); skip(BLANKS_AND_LINES))
            at_ = endOfLine();
        return at_ < text_.size();
    }

    //! Past blanks; false: nothing follows in this line.
    bool toContentOfLine()
    {
        skip(BLANKS);
        return at_ < text_.size() && !is("#\n");
    }

    //! Takes a key and its colon, which in a block a blank follows; false, and takes nothing: there is none.
    bool takeKey(bool isInBlock, std::string& key)
    {
        const size_t end = std::min(endOfLine(), text_.find(" #", at_));
        size_t colon = text_.find(':', is("\"'") ? text_.find(text_[at_], at_ + 1) : at_);
        while (colon < end && isInBlock && !is(BLANKS_AND_LINES, colon + 1 - at_))
            colon = text_.find(':', colon + 1);
        if (colon >= end || (isInBlock && is("[{")))
            return false;
        key = plain(at_, colon);
        if (key.size() > 1 && (key[0] == '"' || key[0] == '\''))
            key = key.substr(1, key.size() - 2);
        at_ = colon + 1;
        return true;
    }

    Json block(int depth)
    {
        const size_t begin = at_, indent = column();
        std::string key;
        if (depth > DEEPEST)
            fail(at_, "too many levels");
        if (isItem())
            return list(indent, depth);
        if (!takeKey(true, key))
            return valueOfLine();
        at_ = begin;
        return map(indent, depth);
    }

    //! What is below a key or a dash that has nothing beside it.
    Json below(size_t indent, bool ofKey, int depth)
    {
        const bool there = toContent() && (column() > indent || (ofKey && column() == indent && isItem()));
        return there ? block(depth + 1) : Json();
    }

    Json list(size_t indent, int depth)
    {
        Json json = Json::array();
        while (toContent() && column() == indent && isItem())
        {
            at_++;
            json.append(toContentOfLine() ? block(depth + 1) : below(indent, false, depth));
        }
        return json;
    }

    Json map(size_t indent, int depth)
    {
        Json json = Json::object();
        std::string key;
        while (toContent() && column() == indent && !isItem())
        {
            if (!takeKey(true, key))
                fail(at_, beginning() + " is no 'key: value'");
            if (toContentOfLine() && is("!"))       // a tag says what a reader of keys knows by itself
                at_ = std::min(text_.find_first_of(" \n", at_), text_.size());
            json.set(key, toContentOfLine() ? valueOfLine() : below(indent, true, depth));
        }
        return json;
    }

    Json valueOfLine()
    {
        const Json json = value("\n", 0);
        if (toContentOfLine())
            fail(at_, beginning() + " follows what is complete");
        return json;
    }

    //! @param ends what ends a plain one
    Json value(std::string_view ends, int depth)
    {
        const size_t begin = at_;
        if (depth > DEEPEST)
            fail(at_, "too many levels");
        if (is("[{"))
            return items(depth);
        if (is("&*|>"))
            fail(at_, "'" + text_.substr(at_, 1) + "': anchors and texts of several lines are not read");
        if (is("\"'"))
        {
            const size_t end = text_.find(text_[begin], begin + 1);
            if (end >= endOfLine())
                failOpen(begin);
            at_ = end + 1;
            return text_.substr(begin + 1, end - begin - 1);
        }
        while (at_ < text_.size() && !is(ends) && !(is("#") && at_ > begin && std::isspace(text_[at_ - 1])))
            at_++;
        return valueOf(plain(begin, at_));
    }

    //! In brackets, over several lines.
    Json items(int depth)
    {
        const size_t begin = at_;
        const bool isMap = is("{");
        const char* const close = isMap ? "}" : "]";
        Json json = isMap ? Json::object() : Json::array();
        std::string key;
        at_++;
        while (toContent() && !is(close))
        {
            if (isMap && !takeKey(false, key))
                fail(at_, "'key: value' is missing in { }");
            const Json item = toContent() ? value(",]}", depth + 1) : Json();
            isMap ? json.set(key, item) : json.append(item);
            if (toContent() && !is(close) && !is(","))
                fail(at_, std::string("'") + close + "' is missing");
            at_ += is(",");
        }
        if (at_ == text_.size())
            failOpen(begin);
        at_++;
        return json;
    }

    static Json valueOf(const std::string& text)
    {
        double number;
        if (text.empty() || text == "~" || text == "null")
            return nullptr;
        if (text == "true" || text == "false")
            return text == "true";
        return parseNumber(text, number) ? Json(number) : Json(text);
    }

    const std::string text_;
    size_t at_ = 0;
};

} // namespace

Json readYaml(const ForeignFile& file) { return YamlReader(file.bytes).read(); }

} // namespace tools
