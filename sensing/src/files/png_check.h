// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::sensing {

/// What is wrong with the bytes of a PNG file, or an empty text: signature, chunk lengths,
/// checksums, and the closing chunk. Decoders fill what a truncated file lacks with black, without
/// a word.
[[nodiscard]] std::string find_png_damage(const std::string& bytes);

/// A part of a PNG file, which must outlive it.
struct PngChunk {
  std::string_view type;
  std::string_view data;
};

/// The chunks of a file in which `find_png_damage` finds nothing.
[[nodiscard]] std::vector<PngChunk> png_chunks(const std::string& bytes);

/// The number in the first four bytes.
[[nodiscard]] std::uint32_t png_number(std::string_view bytes);

}  // namespace palpate::sensing
