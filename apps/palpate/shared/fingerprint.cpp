// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/fingerprint.h"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <vector>

namespace palpate::apps {

std::string fingerprint(const std::filesystem::path& file) {
  // FNV-1a of 64 bit: by accident, two files agree once in 10^19.
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> block(1 << 16);
  while (stream) {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    for (std::streamsize i = 0; i < stream.gcount(); ++i) {
      hash = (hash ^ static_cast<unsigned char>(block[static_cast<std::size_t>(i)])) *
             0x100000001b3ULL;
    }
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace palpate::apps
