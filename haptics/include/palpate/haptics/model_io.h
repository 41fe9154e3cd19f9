// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Reads a model folder: `surface.ply` and `field.json`, or `field.cbor` (the same document in
/// CBOR) if there is no `field.json`. The document is described by docs/field.schema.json.
/// \throws FileError if a file is missing, truncated, of an unknown version, or holds what
/// `check_model` refuses; it names the file, the JSON pointer and what would be right.
[[nodiscard]] Model read_model(const std::filesystem::path& folder);

/// Names of what `write_model` may replace in a folder (see `check_replaceable`).
[[nodiscard]] std::vector<std::filesystem::path> model_entries();

/// Writes such a folder as a whole; numbers read back exactly. The contacts and their triangles are
/// written as a mesh too, `contacts.ply`, which `read_model` does not need. A folder that is there
/// already is replaced only if it holds nothing but `model_entries`. \throws InvalidInput if
/// `check_model` refuses or the folder holds something else, before anything
///         is written; OutputError.
void write_model(const std::filesystem::path& folder, const Model& model);

}  // namespace palpate::haptics
