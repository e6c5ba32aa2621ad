// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/sha256.hpp"
#include "console/failure.hpp"
#include <mbedtls/md.h>
#include <array>
#include <filesystem>

namespace tools {

namespace {

using Digest = std::array<unsigned char, 32>;

const mbedtls_md_info_t* sha256() { return mbedtls_md_info_from_type(MBEDTLS_MD_SHA256); }

std::string hexadecimal(const Digest& digest)
{
    static const char DIGITS[] = "0123456789abcdef";
    std::string text;
    for (unsigned char byte : digest)
        text += {DIGITS[byte >> 4], DIGITS[byte & 15]};
    return text;
}

} // namespace

std::string sha256OfFile(const std::string& path)
{
    Digest digest;
    if (!std::filesystem::is_regular_file(path) || mbedtls_md_file(sha256(), path.c_str(), digest.data()) != 0)
        throw Failure("there is no file '" + path + "' that can be read");
    return hexadecimal(digest);
}

std::string sha256Of(const std::string& text)
{
    Digest digest;
    mbedtls_md(sha256(), reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest.data());
    return hexadecimal(digest);
}

} // namespace tools
