// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate::sensing {

/// What is wrong with the bytes of a PNG file, or an empty text: signature, chunk lengths,
/// checksums, and the closing chunk. Decoders fill what a truncated file lacks with black, without
/// a word.
[[nodiscard]] std::string find_png_damage(const std::string& bytes);

}  // namespace palpate::sensing
