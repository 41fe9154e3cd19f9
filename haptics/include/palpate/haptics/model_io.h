// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// How a field document is written: as text, `field.json`, or the same in CBOR, `field.cbor`.
enum class ModelEncoding { json, cbor };

/// Up to so many contacts a model is written as JSON unless something else is asked for: about
/// 10 MB, which an editor still opens.
inline constexpr std::size_t kMaxJsonContacts = 10'000;

/// Reads a model folder: `surface.ply` and `field.json`, or `field.cbor` (the same document in
/// CBOR) if there is no `field.json`. docs/model-file.md tells what is in it, and
/// docs/field.schema.json describes the document; those of older versions
/// (docs/field-v1.schema.json) are read too. Compliances of contacts are not stored but computed
/// again (`with_compliances`).
/// \throws FileError if a file is missing, truncated, of a version to come, or holds what
/// `check_model` refuses or a number beyond 1e12; it names the file, the JSON pointer and what
/// would be right.
[[nodiscard]] Model read_model(const std::filesystem::path& folder);

/// Names of what `write_model` may replace in a folder (see `check_replaceable`).
[[nodiscard]] std::vector<std::filesystem::path> model_entries();

/// Writes such a folder as a whole; numbers read back exactly, and take as many digits as they
/// need for that. The contacts and their triangles are written as a mesh too, `contacts.ply`,
/// which `read_model` does not need. A folder that is there already is replaced only if it holds
/// nothing but `model_entries`.
/// \throws InvalidInput if `check_model` refuses or the folder holds something else, before
/// anything is written; OutputError.
void write_model(const std::filesystem::path& folder, const Model& model,
                 std::optional<ModelEncoding> encoding = std::nullopt);

/// Writes the document alone, to a file of any name.
/// \throws InvalidInput if `check_model` refuses; OutputError.
void write_field_document(const std::filesystem::path& path, const Model& model,
                          ModelEncoding encoding);

}  // namespace palpate::haptics
