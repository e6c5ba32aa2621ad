// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/exif.hpp"
#include "console/numbers.hpp"

#include <libexif/exif-data.h>
#include <algorithm>
#include <cstring>
#include <memory>
#include <mutex>

namespace tools {

namespace {

using Bytes = std::vector<unsigned char>;

const unsigned char HEADER[] = {'E', 'x', 'i', 'f', 0, 0};

//! What a PNG's chunk eXIf holds, as libexif wants it; empty: there is none. A chunk: length, name, data, checksum.
Bytes exifOfPng(const Bytes& bytes)
{
    size_t at = 8;
    while (at + 12 <= bytes.size())
    {
        const unsigned char* chunk = &bytes[at];
        const size_t length = (size_t)chunk[0] << 24 | chunk[1] << 16 | chunk[2] << 8 | chunk[3];
        if (length > bytes.size() - at - 12)
            break;
        if (std::memcmp(chunk + 4, "eXIf", 4) == 0)
        {
            Bytes exif(HEADER, HEADER + sizeof(HEADER));
            exif.insert(exif.end(), chunk + 8, chunk + 8 + length);
            return exif;
        }
        at += 12 + length;
    }
    return {};
}

bool startsWith(const Bytes& bytes, const char* magic)
{
    const size_t length = std::strlen(magic);
    return bytes.size() >= length && std::memcmp(bytes.data(), magic, length) == 0;
}

std::mutex turnedMutex;             // images are read by several threads
std::vector<std::string> turned;

} // namespace

int exifOrientation(const Bytes& bytes)
{
    const bool isPng = startsWith(bytes, "\x89PNG\r\n\x1a\n");
    if (!isPng && !startsWith(bytes, "\xff\xd8"))
        return 1;
    const Bytes ofPng = isPng ? exifOfPng(bytes) : Bytes();
    const Bytes& exif = isPng ? ofPng : bytes;
    if (exif.empty())
        return 1;
    const std::unique_ptr<ExifData, void (*)(ExifData*)> data(exif_data_new_from_data(exif.data(), (unsigned)exif.size()),
                                                             exif_data_unref);
    const ExifEntry* entry = data ? exif_content_get_entry(data->ifd[EXIF_IFD_0], EXIF_TAG_ORIENTATION) : nullptr;
    if (!entry || entry->format != EXIF_FORMAT_SHORT || entry->components != 1)
        return 1;
    const int orientation = exif_get_short(entry->data, exif_data_get_byte_order(data.get()));
    return orientation >= 1 && orientation <= 8 ? orientation : 1;
}

void noteTurnedImage(const std::string& path)
{
    const std::lock_guard<std::mutex> lock(turnedMutex);
    if (std::find(turned.begin(), turned.end(), path) == turned.end())
        turned.push_back(path);
}

std::string takeTurnedImagesNotice()
{
    const std::lock_guard<std::mutex> lock(turnedMutex);
    std::vector<std::string> names;
    names.swap(turned);
    if (names.empty())
        return "";
    std::sort(names.begin(), names.end());
    return "the EXIF data of " + listed(names) + (names.size() == 1 ? " asks" : " ask") + " for a turned picture; the pixels are "
           "used as they are stored, since the lens does not turn with the camera";
}

} // namespace tools
