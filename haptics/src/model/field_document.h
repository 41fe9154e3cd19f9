// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>

#include "palpate/haptics/model_io.h"

namespace palpate::haptics {

/// What a field document says.
struct FieldDocument {
  Model model;  ///< without surface, and without its weights if `weights_in_surface`
  bool weights_in_surface = false;  ///< the vertices in `surface.ply` have them
};

/// Writes the document of a model that `check_model` accepts, in the current version; contact by
/// contact, so that it never is in memory as a whole.
void write_field_document(std::ostream& stream, const Model& model, ModelEncoding encoding);

/// Reads a document of any version.
/// \throws InvalidInput with the JSON pointer, or saying what cannot be parsed.
[[nodiscard]] FieldDocument read_field_document(const std::string& bytes, ModelEncoding encoding);

}  // namespace palpate::haptics
