// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// The encoding of a field document: text in `field.json`, or CBOR in `field.cbor`.
enum class ModelEncoding { json, cbor };

/// A model of at most this many contacts is written as JSON unless the caller chooses. The file has
/// about 14 MB then, which an editor still opens.
inline constexpr std::size_t kMaxJsonContacts = 10'000;

/// Version of the field document that this library reads and writes.
inline constexpr int kFieldVersion = 1;

/// Reads a model folder: `surface.ply`, `field.json` or, if there is none, `field.cbor` (the same
/// document in CBOR), and `deformed/response.bin` if there is one. docs/model-file.md describes
/// these files, docs/field.schema.json the document.
/// \throws FileError if a file is missing, truncated, of a newer version, or holds something that
/// `check_model` refuses or a number beyond 1e12. The message names the file and the JSON pointer,
/// and says what would be right.
[[nodiscard]] Model read_model(const std::filesystem::path& folder);

/// Names of the files that `write_model` may replace in a folder (see `check_replaceable`).
[[nodiscard]] std::vector<std::filesystem::path> model_entries();

/// Writes such a folder as a whole. Numbers read back exactly. A model without surface weights is
/// written with those that its triangles give. `contacts.ply`, the triangles of contacts as a mesh,
/// is written too; `read_model` does not need it. A folder that exists is replaced only if it holds
/// nothing but `model_entries`.
/// \throws InvalidInput if `check_model` refuses or the folder holds something else, before
/// anything is written; OutputError.
void write_model(const std::filesystem::path& folder, const Model& model,
                 std::optional<ModelEncoding> encoding = std::nullopt);

/// [bytes] An upper bound of the files of such a folder, at most 1 kB more than they have.
/// \throws InvalidInput if `check_model` refuses.
[[nodiscard]] double folder_size(const Model& model);

/// Writes the document alone, to a file of any name.
/// \throws InvalidInput if `check_model` refuses; OutputError.
void write_field_document(const std::filesystem::path& path, const Model& model,
                          ModelEncoding encoding);

}  // namespace palpate::haptics
