// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::sensing {

/// Describes the damage in the bytes of a PNG file, or returns an empty text: checks signature,
/// chunk lengths, checksums and the closing chunk. Decoders silently fill the missing part of a
/// truncated file with black.
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
