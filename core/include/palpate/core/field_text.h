// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/fields.h"

namespace palpate {

/// A field and its value as text, which `assign` reads back to the same bits: "2.5", "true",
/// "flood", rows of numbers as "1,2,3;4,5,6", and "" for a field that is left out.
struct FieldText {
  std::string type;                ///< of the struct, "DecodeOptions"
  std::string name, option, unit;  ///< as in `Field`
  std::string range;               ///< of a number: "in (0, 1]"
  std::string text;
  bool is_flag = false;
};

/// All fields of a list.
[[nodiscard]] std::vector<FieldText> texts_of(const FieldList& fields);

/// Sets a field from text.
/// \throws InvalidInput if the list has no such field, or the text is not a value in its range; the
/// message states which values are expected.
void assign(const FieldList& fields, std::string_view name, std::string_view text);

/// Sets fields from words NAME=VALUE with blanks between them: "tolerance=1e-4 hold_ticks=5".
/// \throws InvalidInput as `assign`, or if a word has no '='.
void assign_words(const FieldList& fields, std::string_view words);

}  // namespace palpate
