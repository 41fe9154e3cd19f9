// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/png_check.h"

#include <libdeflate.h>

#include <cstddef>

namespace palpate::sensing {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
/// Length, type and checksum of a chunk.
constexpr std::size_t kChunkFrame = 12;

}  // namespace

std::uint32_t png_number(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char byte : bytes.substr(0, 4)) {
    value = (value << 8U) | static_cast<unsigned char>(byte);
  }
  return value;
}

std::string find_png_damage(const std::string& bytes) {
  const std::string_view all = bytes;
  if (!all.starts_with(kSignature)) return "does not begin as a PNG file";
  std::size_t position = kSignature.size();
  while (position + kChunkFrame <= all.size()) {
    const std::size_t length = png_number(all.substr(position));
    if (length > all.size() - position - kChunkFrame) break;
    const std::string_view type = all.substr(position + 4, 4);
    if (libdeflate_crc32(0, type.data(), 4 + length) !=
        png_number(all.substr(position + 8 + length))) {
      return "is damaged: wrong checksum in chunk " + std::string(type) + " at byte " +
             std::to_string(position);
    }
    if (type == "IEND") return {};
    position += kChunkFrame + length;
  }
  return "is truncated: it ends after " + std::to_string(bytes.size()) +
         " bytes without the closing chunk";
}

std::vector<PngChunk> png_chunks(const std::string& bytes) {
  const std::string_view all = bytes;
  std::vector<PngChunk> chunks;
  std::size_t position = kSignature.size();
  while (position + kChunkFrame <= all.size()) {
    const std::size_t length = png_number(all.substr(position));
    chunks.push_back({all.substr(position + 4, 4), all.substr(position + 8, length)});
    if (chunks.back().type == "IEND") break;
    position += kChunkFrame + length;
  }
  return chunks;
}

}  // namespace palpate::sensing
