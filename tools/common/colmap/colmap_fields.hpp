// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_COLMAP_FIELDS_HPP
#define REFRACT_TOOLS_COLMAP_FIELDS_HPP

#include <cstdint>
#include <string>
#include <vector>

namespace tools {

/* The numbers of COLMAP's files one after the other, whether they are read or written, as text or as bytes: each kind of record is told
once, by a function that passes all its members through here. A text has a record a line, and an image two lines, of which the second
may be empty. Throws Failure. */
class ColmapFields
{
public:
    enum Direction { READ, WRITE };

    //! @param bytes of the whole file, which must outlive it; what is written is added to them
    ColmapFields(std::string& bytes, bool isBinary, Direction direction)
        : bytes_(bytes), isBinary_(isBinary), isReading_(direction == READ) {}

    void number(double& value) { plain(value); }
    void number(uint32_t& value) { plain(value); }
    void number(uint64_t& value);
    void number(uint8_t& value);
    template<typename... T> void numbers(T&... values) { (number(values), ...); }
    //! A word of one line; bytes end with a zero.
    void word(std::string& text);
    void restOfLine(std::string& text);         //!< as a word, but a text may have blanks
    //! A word that bytes have a number for. @param words by number @param what they are
    void kind(int& value, const std::vector<std::string>& words, const std::string& what);
    //! How many entries of a list follow; a text ends them with its line. @param each numbers of an entry, at the least
    uint64_t list(uint64_t count, int each, int bytesEach);
    //! The same where a text says the number, too.
    uint32_t shortList(uint32_t count, int bytesEach);
    void endLine();
    //! How many records follow; a text has as many as it has.
    uint64_t records(uint64_t count);
    //! Whether there is one more; `done` were.
    bool more(uint64_t done, uint64_t count);
    bool isReading() const { return isReading_; }
    std::string where() const { return isBinary_ ? "" : "line " + std::to_string(line_) + ": "; }

private:
    template<typename T> void plain(T& value);
    template<typename T> void parse(T& value);
    void raw(void* value, size_t size);
    void requireLeft(uint64_t count, int bytesEach) const;
    bool atBlank() const;
    bool atEndOfLine();
    void nextLine();

    std::string& bytes_;
    bool isBinary_, isReading_;
    size_t at_ = 0;             // where it is read
    int line_ = 1;
};

} // namespace tools

#endif // REFRACT_TOOLS_COLMAP_FIELDS_HPP
