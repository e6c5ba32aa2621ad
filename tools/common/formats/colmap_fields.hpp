// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_COLMAP_FIELDS_HPP
#define REFRACT_TOOLS_COLMAP_FIELDS_HPP

#include <cstdint>
#include <memory>
#include <string>

/* The numbers of COLMAP's files one after the other, whether they are read or written, as text or as bytes: each kind of record is told
once, by a function that passes all its members through here. */
namespace tools {

class ColmapFields
{
public:
    virtual ~ColmapFields() = default;

    virtual void number(uint32_t& value) = 0;
    virtual void number(uint64_t& value) = 0;
    virtual void number(double& value) = 0;
    virtual void number(uint8_t& value) = 0;
    //! A word of one line; bytes end with a zero.
    virtual void word(std::string& text) = 0;
    //! A word that bytes have a number for. @param words by number
    virtual void kind(int& value, const char* const* words, int count) = 0;
    //! How many entries of a list follow; a text ends them with its line. @param each numbers of an entry, at the least
    virtual uint64_t list(uint64_t count, int each, int bytesEach) = 0;
    //! The same where a text says the number, too.
    virtual uint32_t shortList(uint32_t count, int bytesEach) = 0;
    virtual void endLine() = 0;
    //! How many records follow; a text has as many as it has.
    virtual uint64_t records(uint64_t count) = 0;
    //! Whether there is one more; `done` were.
    virtual bool more(uint64_t done, uint64_t count) = 0;
    //! After the last one.
    virtual void end() = 0;
    virtual bool isReading() const = 0;
    virtual std::string where() const { return ""; }
};

//! Both throw Failure. @param bytes of the whole file, which must outlive it
std::unique_ptr<ColmapFields> colmapReader(const std::string& bytes, bool isBinary);
//! Adds to the bytes.
std::unique_ptr<ColmapFields> colmapWriter(std::string& bytes, bool isBinary);

} // namespace tools

#endif // REFRACT_TOOLS_COLMAP_FIELDS_HPP
