// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "palpate/sensing/reason.h"

namespace palpate::sensing {

/// Writes the codes of `Reason` as an 8-bit image of one channel; the extension chooses TIFF or
/// PNG.
/// \throws InvalidInput if there are no pixels.
/// \throws OutputError if the file cannot be written.
void write_reasons(const std::filesystem::path& path, const ReasonImage& reasons);

/// Reads a file of `write_reasons`.
/// \throws FileError if the file cannot be read, has another type, or holds an unknown code.
[[nodiscard]] ReasonImage read_reasons(const std::filesystem::path& path);

}  // namespace palpate::sensing
