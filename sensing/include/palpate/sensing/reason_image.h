// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "palpate/sensing/reason.h"

namespace palpate::sensing {

/// Writes the codes of `Reason` as an image of 8 bit, one channel (TIFF or PNG, by the ending).
/// \throws InvalidInput if there are no pixels; OutputError.
void write_reasons(const std::filesystem::path& path, const ReasonImage& reasons);

/// Reads what `write_reasons` wrote.
/// \throws FileError if the file cannot be read, is of another type, or holds a code that is none.
[[nodiscard]] ReasonImage read_reasons(const std::filesystem::path& path);

}  // namespace palpate::sensing
