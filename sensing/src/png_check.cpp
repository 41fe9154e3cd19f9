// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "png_check.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace palpate::sensing {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
/// Length, type and checksum of a chunk.
constexpr std::size_t kChunkFrame = 12;

std::array<std::uint32_t, 256> crc_table() {
  constexpr std::uint32_t kPolynomial = 0xEDB88320U;  // PNG specification, annex D
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::uint32_t value = byte;
    for (int bit = 0; bit < 8; ++bit)
      value = (value >> 1U) ^ ((value & 1U) != 0 ? kPolynomial : 0U);
    table[byte] = value;
  }
  return table;
}

std::uint32_t checksum(std::string_view bytes) {
  static const std::array<std::uint32_t, 256> table = crc_table();
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    crc = table[(crc ^ static_cast<unsigned char>(byte)) & 0xFFU] ^ (crc >> 8U);
  }
  return crc ^ 0xFFFFFFFFU;
}

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char byte : bytes.substr(0, 4)) {
    value = (value << 8U) | static_cast<unsigned char>(byte);
  }
  return value;
}

}  // namespace

std::string find_png_damage(const std::string& bytes) {
  const std::string_view all = bytes;
  if (!all.starts_with(kSignature)) return "does not begin as a PNG file";
  std::size_t position = kSignature.size();
  while (position + kChunkFrame <= all.size()) {
    const std::size_t length = big_endian(all.substr(position));
    if (length > all.size() - position - kChunkFrame) break;
    const std::string_view type = all.substr(position + 4, 4);
    if (checksum(all.substr(position + 4, 4 + length)) !=
        big_endian(all.substr(position + 8 + length))) {
      return "is damaged: wrong checksum in chunk " + std::string(type) + " at byte " +
             std::to_string(position);
    }
    if (type == "IEND") return {};
    position += kChunkFrame + length;
  }
  return "is truncated: it ends after " + std::to_string(bytes.size()) +
         " bytes without the closing chunk";
}

}  // namespace palpate::sensing
