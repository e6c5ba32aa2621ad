// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/notations.hpp"
#include "console/lines.hpp"
#include "console/numbers.hpp"

#include <algorithm>
#include <sstream>

namespace tools {

namespace {

const int DEEPEST = 50;         // what calls itself for each level must not be led on by a file
const char BLANKS[] = " \t\r";

struct Line
{
    size_t indent;
    std::string text;           // without the indent, a comment, and blanks at the end
    int number;
};

[[noreturn]] void fail(int line, const std::string& what) { throw Json::Error("line " + std::to_string(line) + ": " + what); }

//! Walks over a text: what is open in it, and where a comment begins.
struct Scan
{
    int brackets = 0;
    char quote = 0;

    //! The text up to a comment.
    std::string over(const std::string& text)
    {
        for (size_t i = 0; i < text.size(); i++)
        {
            const char c = text[i];
            if (quote)
                quote = c == quote ? 0 : quote;
            else if (c == '#' && (i == 0 || text[i - 1] == ' ' || text[i - 1] == '\t'))
                return text.substr(0, i);
            else if ((c == '"' || c == '\'') && (i == 0 || std::string(" \t[{,:").find(text[i - 1]) != std::string::npos))
                quote = c;
            else
                brackets += c == '[' || c == '{' ? 1 : c == ']' || c == '}' ? -1 : 0;
        }
        return text;
    }
};

std::string trimmed(const std::string& text)
{
    const size_t first = text.find_first_not_of(BLANKS);
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(BLANKS) - first + 1);
}

//! Lines with something on them; a list in brackets is one.
std::vector<Line> linesOf(const std::string& text)
{
    std::vector<Line> lines;
    std::istringstream in(text);
    Scan scan;
    std::string raw;
    for (int number = 1; takeLine(in, raw); number++)
    {
        const bool goesOn = scan.brackets > 0;
        const std::string content = trimmed(scan.over(raw));
        if (!goesOn && (content.empty() || content.compare(0, 3, "---") == 0 || content == "..." || content[0] == '%'))
        {
            scan = Scan();      // brackets of what is skipped are none
            continue;
        }
        if (goesOn)
            lines.back().text += " " + content;
        else
            lines.push_back({raw.find_first_not_of(" "), content, number});
    }
    if (scan.brackets > 0 || scan.quote)
        fail(lines.empty() ? 1 : lines.back().number, "a bracket or quote is not closed; is the file cut short?");
    return lines;
}

class Reader
{
public:
    explicit Reader(const std::string& text) : lines_(linesOf(text)) {}

    Json read()
    {
        const Json json = lines_.empty() ? Json() : block(0);
        if (at_ < lines_.size())
            fail(lines_[at_].number, "'" + lines_[at_].text.substr(0, 30) + "' belongs to nothing above it");
        return json;
    }

private:
    static bool isItem(const std::string& text) { return text == "-" || text.compare(0, 2, "- ") == 0; }

    //! Where the colon of "key: value" is, or npos.
    static size_t colonOf(const std::string& text)
    {
        const char quote = text[0];
        const size_t from = quote == '"' || quote == '\'' ? text.find(quote, 1) : 0;
        for (size_t i = from; i < text.size() && from != std::string::npos; i++)
            if (text[i] == ':' && (i + 1 == text.size() || text[i + 1] == ' ') )
                return std::string("[{").find(quote) == std::string::npos ? i : std::string::npos;
        return std::string::npos;
    }

    Json block(int depth)
    {
        const Line& line = lines_[at_];
        if (depth > DEEPEST)
            fail(line.number, "too many levels");
        if (isItem(line.text))
            return list(line.indent, depth);
        return colonOf(line.text) != std::string::npos ? map(line.indent, depth) : flow(lines_[at_++]);
    }

    //! What is below a key or a dash that has nothing beside it.
    Json below(size_t indent, bool ofKey, int depth)
    {
        const bool there = at_ < lines_.size()
            && (lines_[at_].indent > indent || (ofKey && lines_[at_].indent == indent && isItem(lines_[at_].text)));
        return there ? block(depth + 1) : Json();
    }

    Json list(size_t indent, int depth)
    {
        Json json = Json::array();
        while (at_ < lines_.size() && lines_[at_].indent == indent && isItem(lines_[at_].text))
        {
            Line& line = lines_[at_];
            const size_t content = std::min(line.text.find_first_not_of(" ", 1), line.text.size());
            if (content == line.text.size())
            {
                at_++;
                json.append(below(indent, false, depth));
                continue;
            }
            line.indent += content;             // what stands beside the dash is a block of its own
            line.text = line.text.substr(content);
            json.append(block(depth + 1));
        }
        return json;
    }

    Json map(size_t indent, int depth)
    {
        Json json = Json::object();
        while (at_ < lines_.size() && lines_[at_].indent == indent && !isItem(lines_[at_].text))
        {
            const Line line = lines_[at_];
            const size_t colon = colonOf(line.text);
            if (colon == std::string::npos)
                fail(line.number, "'" + line.text.substr(0, 30) + "' is no 'key: value'");
            std::string key = trimmed(line.text.substr(0, colon));
            if (key.size() > 1 && (key[0] == '"' || key[0] == '\''))
                key = key.substr(1, key.size() - 2);
            const std::string value = withoutTag(trimmed(line.text.substr(colon + 1)));
            at_++;
            json.set(key, value.empty() ? below(indent, true, depth) : flow({indent, value, line.number}));
        }
        return json;
    }

    //! "!!opencv-matrix" and others say what a reader of keys knows by itself.
    static std::string withoutTag(const std::string& text)
    {
        return text.empty() || text[0] != '!' ? text : trimmed(text.substr(std::min(text.find(' '), text.size())));
    }

    static Json flow(const Line& line)
    {
        size_t at = 0;
        const Json json = flowValue(line, at, 0);
        if (line.text.find_first_not_of(BLANKS, at) != std::string::npos)
            fail(line.number, "'" + line.text.substr(at, 30) + "' follows what is complete");
        return json;
    }

    static void skipBlanks(const Line& line, size_t& at) { at = std::min(line.text.find_first_not_of(BLANKS, at), line.text.size()); }

    static Json flowValue(const Line& line, size_t& at, int depth)
    {
        skipBlanks(line, at);
        const char first = at < line.text.size() ? line.text[at] : 0;
        if (depth > DEEPEST)
            fail(line.number, "too many levels");
        if (first == '[' || first == '{')
            return flowItems(line, at, depth);
        if (first == '"' || first == '\'')
        {
            const size_t end = line.text.find(first, at + 1);
            if (end == std::string::npos)
                fail(line.number, "a quote is not closed");
            const std::string text = line.text.substr(at + 1, end - at - 1);
            at = end + 1;
            return text;
        }
        if (first == '&' || first == '*' || first == '|' || first == '>')
            fail(line.number, std::string("'") + first + "': anchors and texts of several lines are not read");
        const size_t end = depth > 0 ? std::min(line.text.find_first_of(",]}", at), line.text.size()) : line.text.size();
        const std::string text = trimmed(line.text.substr(at, end - at));
        at = end;
        return plain(text);
    }

    static Json flowItems(const Line& line, size_t& at, int depth)
    {
        const bool isMap = line.text[at++] == '{';
        const char close = isMap ? '}' : ']';
        Json json = isMap ? Json::object() : Json::array();
        for (;;)
        {
            skipBlanks(line, at);
            if (at < line.text.size() && line.text[at] == close)
                break;
            std::string key;
            if (isMap)
            {
                const size_t colon = line.text.find(':', at);
                if (colon == std::string::npos)
                    fail(line.number, "'key: value' is missing in { }");
                key = trimmed(line.text.substr(at, colon - at));
                at = colon + 1;
            }
            const Json value = flowValue(line, at, depth + 1);
            isMap ? json.set(key, value) : json.append(value);
            skipBlanks(line, at);
            if (at < line.text.size() && line.text[at] == ',')
                at++;
            else if (at >= line.text.size() || line.text[at] != close)
                fail(line.number, std::string("'") + close + "' is missing");
        }
        at++;
        return json;
    }

    static Json plain(const std::string& text)
    {
        double number;
        if (text.empty() || text == "~" || text == "null")
            return nullptr;
        if (text == "true" || text == "false")
            return text == "true";
        return parseNumber(text, number) ? Json(number) : Json(text);
    }

    std::vector<Line> lines_;
    size_t at_ = 0;
};

} // namespace

Json readYaml(const std::string& text) { return Reader(text).read(); }

} // namespace tools
