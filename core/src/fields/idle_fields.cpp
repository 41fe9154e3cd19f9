// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/idle_fields.h"

#include <algorithm>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/field_text.h"

namespace palpate {
namespace {

MessagePart part_of(const FieldText& field) { return {field.type + "::" + field.name, true}; }

/// The value after the name of a field. A flag that is set needs none.
std::string value_of(const FieldText& field) {
  if (field.is_flag) return field.text == "true" ? "" : " (off)";
  return field.text.empty() ? " (not given)" : " " + field.text;
}

}  // namespace

void refuse_idle(const FieldList& fields, const FieldList& usual, std::string_view cause,
                 std::initializer_list<std::string_view> idle) {
  const std::vector<FieldText> now = texts_of(fields), before = texts_of(usual);
  const auto by = std::ranges::find(now, cause, &FieldText::name);
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (now[i].text == before[i].text || std::ranges::find(idle, now[i].name) == idle.end())
      continue;
    throw InvalidInput(std::vector<MessagePart>{
        part_of(now[i]), {" does nothing with "}, part_of(*by), {value_of(*by)}});
  }
}

}  // namespace palpate
