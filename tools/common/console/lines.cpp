// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/lines.hpp"

#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <sstream>

namespace tools {

namespace {

bool isContinuation(char c) { return (c & 0xC0) == 0x80; }

//! Takes the characters that fit into so many columns off the beginning of a word.
std::string takeColumns(std::string& word, size_t columns)
{
    size_t end = 0, width = 0;
    while (end < word.size() && (width < columns || isContinuation(word[end])))
        width += !isContinuation(word[end++]);
    const std::string taken = word.substr(0, end);
    word.erase(0, end);
    return taken;
}

} // namespace

size_t columnsOf(const std::string& text)
{
    return std::count_if(text.begin(), text.end(), [](char c) { return !isContinuation(c); });
}

std::vector<std::string> brokenInto(const std::string& text, size_t columns, const std::string& indent, LongWords longWords)
{
    if (columnsOf(text) <= columns)
        return {text};
    std::vector<std::string> lines(1, text.substr(0, text.find_first_not_of(' ')));    // its own indent stays
    const std::string next = lines[0] + indent;
    std::istringstream words(text);
    bool first = true;          // of its line
    for (std::string word; words >> word; first = false)
    {
        if (!first && columnsOf(lines.back()) + 1 + columnsOf(word) > columns)
        {
            lines.push_back(next);
            first = true;
        }
        while (longWords == LongWords::BROKEN && columnsOf(lines.back()) + columnsOf(word) > columns && first && columnsOf(next) < columns)
        {
            lines.back() += takeColumns(word, columns - columnsOf(lines.back()));
            lines.push_back(next);
        }
        lines.back() += (first ? "" : " ") + word;
    }
    return lines;
}

std::vector<std::string> firstOf(const std::vector<std::string>& lines, size_t count, size_t columns)
{
    const std::string MORE = " ...";
    if (lines.size() <= count)
        return lines;
    std::vector<std::string> first(lines.begin(), lines.begin() + count);
    while (!first.empty() && columnsOf(first.back()) + MORE.size() > columns)
    {
        const size_t space = first.back().find_last_of(' ');
        first.back().resize(space == std::string::npos ? columns - MORE.size() : space);
    }
    if (!first.empty())
        first.back() += MORE;
    return first;
}

std::string alternatives(const std::vector<std::string>& sentences, size_t most)
{
    std::string text;
    for (size_t i = 0; i < std::min(most, sentences.size()); i++)
        text += (i ? "; or " : "") + sentences[i];
    return text + (sentences.size() > most ? "; or one of " + std::to_string(sentences.size() - most) + " others" : "");
}

bool takeLine(std::istream& in, std::string& line)
{
    const int END = std::istream::traits_type::eof();
    line.clear();
    if (!in || in.peek() == END)
        return false;
    std::streambuf& bytes = *in.rdbuf();
    for (int c = bytes.sbumpc(); c != END && c != '\n'; c = bytes.sbumpc())
    {
        if (c == '\r')
        {
            if (bytes.sgetc() == '\n')
                bytes.sbumpc();
            break;
        }
        line += (char)c;
    }
    return true;
}

bool errorsFollowOutput()
{
    struct stat out, err;
    return fstat(STDOUT_FILENO, &out) == 0 && fstat(STDERR_FILENO, &err) == 0 && out.st_dev == err.st_dev && out.st_ino == err.st_ino;
}

} // namespace tools
