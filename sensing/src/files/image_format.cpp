// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/image_format.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace palpate::sensing {
namespace {

constexpr const char* kCut = "is truncated or damaged";

std::uint32_t byte_at(const std::string& bytes, std::size_t place) {
  return static_cast<unsigned char>(bytes[place]);
}

/// Sizes in RIFF and BMP files have their lowest byte first.
std::uint32_t low_first(const std::string& bytes, std::size_t place) {
  return byte_at(bytes, place) | byte_at(bytes, place + 1) << 8 | byte_at(bytes, place + 2) << 16 |
         byte_at(bytes, place + 3) << 24;
}

constexpr std::size_t kRiffHeader = 12;  // "RIFF", size, "WEBP"
constexpr std::size_t kChunkHeader = 8;  // name, size

/// Place of the chunk with the image; npos if there is none.
std::size_t find_webp_image(const std::string& bytes) {
  std::size_t place = kRiffHeader;
  while (place + kChunkHeader <= bytes.size()) {
    if (bytes.compare(place, 3, "VP8") == 0 && bytes[place + 3] != 'X') return place;
    const std::size_t size = low_first(bytes, place + 4);
    place += kChunkHeader + size + size % 2;
  }
  return std::string::npos;
}

}  // namespace

ImageFormat image_format(const std::string& bytes) {
  using namespace std::string_literals;
  if (bytes.starts_with("\x89PNG")) return ImageFormat::png;
  if (bytes.starts_with("II*\0"s) || bytes.starts_with("MM\0*"s)) return ImageFormat::tiff;
  if (bytes.starts_with("\xFF\xD8\xFF")) return ImageFormat::jpeg;
  if (bytes.starts_with("BM")) return ImageFormat::bmp;
  if (bytes.starts_with("RIFF") && bytes.size() >= kRiffHeader && bytes.compare(8, 4, "WEBP") == 0)
    return ImageFormat::webp;
  return ImageFormat::unknown;
}

std::string find_jpeg_damage(const std::string& bytes) {
  constexpr std::uint32_t kMark = 0xFF;
  constexpr std::uint32_t kEndOfImage = 0xD9;
  constexpr std::uint32_t kFirstRestart = 0xD0;
  constexpr std::uint32_t kLastRestart = 0xD7;
  std::size_t place = 2;
  while (place + 1 < bytes.size()) {
    if (byte_at(bytes, place) != kMark) {  // compressed data
      ++place;
      continue;
    }
    const std::uint32_t marker = byte_at(bytes, place + 1);
    if (marker == kEndOfImage) return {};
    const bool alone = marker == 0 || marker == kMark || marker == 1 ||
                       (marker >= kFirstRestart && marker <= kLastRestart);
    if (alone) {
      place += marker == kMark ? 1 : 2;
      continue;
    }
    if (place + 3 >= bytes.size()) return kCut;
    place += 2 + (byte_at(bytes, place + 2) << 8 | byte_at(bytes, place + 3));
  }
  return kCut;
}

std::string find_webp_damage(const std::string& bytes) {
  const std::size_t image = find_webp_image(bytes);
  const bool whole = image != std::string::npos &&
                     bytes.size() >= kChunkHeader + low_first(bytes, 4) &&
                     bytes.size() >= image + kChunkHeader + low_first(bytes, image + 4);
  return whole ? std::string() : kCut;
}

std::string find_bmp_damage(const std::string& bytes) {
  constexpr std::size_t kHeaders = 34;  // up to the kind of compression
  constexpr std::uint32_t kOldHeader = 12;
  constexpr std::uint32_t kUncompressed = 0;
  constexpr std::uint32_t kBitFields = 3;
  if (bytes.size() < kHeaders) return kCut;
  const std::uint32_t header = low_first(bytes, 14);
  if (header == kOldHeader) return {};
  const std::uint32_t compression = low_first(bytes, 30);
  if (compression != kUncompressed && compression != kBitFields) return {};
  const std::uint64_t width = low_first(bytes, 18);
  const auto signed_height = static_cast<std::int32_t>(low_first(bytes, 22));  // < 0: from the top
  const auto height =
      static_cast<std::uint64_t>(std::abs(static_cast<std::int64_t>(signed_height)));
  const std::uint64_t bits = byte_at(bytes, 28) | byte_at(bytes, 29) << 8;
  const std::uint64_t row = (width * bits + 31) / 32 * 4;
  const std::uint64_t all = low_first(bytes, 10) + row * height;
  return bytes.size() >= all ? std::string() : kCut;
}

bool is_lossy_webp(const std::string& bytes) {
  const std::size_t image = find_webp_image(bytes);
  return image != std::string::npos && bytes[image + 3] == ' ';
}

}  // namespace palpate::sensing
