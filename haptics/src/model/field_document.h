// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>

#include "palpate/haptics/model_io.h"

namespace palpate::haptics {

/// Writes the document of a model that `check_model` accepts, one contact at a time: the document
/// as a whole is never in memory.
void write_field_document(std::ostream& stream, const Model& model, ModelEncoding encoding);

/// Reads a document, one contact at a time. The model has no surface and no surface weights yet.
/// \throws InvalidInput with the JSON pointer of what is wrong, or saying what cannot be parsed.
[[nodiscard]] Model read_field_document(const std::string& bytes, ModelEncoding encoding);

}  // namespace palpate::haptics
