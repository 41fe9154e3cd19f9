// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Reads a model folder: `surface.ply` and `field.json`, or `field.cbor` (the same document in
/// CBOR) if there is no `field.json`. The document is described by docs/field.schema.json.
/// \throws FileError if a file is missing, truncated, of an unknown version, or holds what
/// `check_model` refuses; it names the file, the JSON pointer and what would be right.
[[nodiscard]] Model read_model(const std::filesystem::path& folder);

/// Writes such a folder as a whole; numbers read back exactly, bytes that are not UTF-8 as U+FFFD.
/// A folder that is there already is replaced only if it is empty or holds a `field.json`. \throws
/// InvalidInput if `check_model` refuses or the folder is something else, before anything is
/// written; OutputError.
void write_model(const std::filesystem::path& folder, const Model& model);

}  // namespace palpate::haptics
