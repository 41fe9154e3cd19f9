// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/file_fingerprint.h"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <vector>

namespace palpate {
namespace {

/// FNV-1a of 64 bit: by accident, two texts agree once in 10^19.
class Fnv {
 public:
  void add(std::string_view text) {
    for (const char c : text) hash_ = (hash_ ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  }
  [[nodiscard]] std::string text() const { return fmt::format("{:016x}", hash_); }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

constexpr std::size_t kBlock = 1 << 16;  // [bytes] read at a time

}  // namespace

std::string file_fingerprint(const std::filesystem::path& file) {
  Fnv hash;
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> block(kBlock);
  while (stream) {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash.add({block.data(), static_cast<std::size_t>(stream.gcount())});
  }
  return hash.text();
}

std::string text_fingerprint(std::string_view text) {
  Fnv hash;
  hash.add(text);
  return hash.text();
}

}  // namespace palpate
