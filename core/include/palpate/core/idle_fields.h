// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string_view>

#include "palpate/core/fields.h"

namespace palpate {

/// Refuses fields that another one makes meaningless. Such a field is given if it differs from
/// `usual`, the list of the same struct with its defaults.
/// \param cause name of the field that makes them so by its value, \param idle names of the others.
/// \throws InvalidInput that names both: "PlaybackOptions::energy_credit does nothing with
/// PlaybackOptions::motion brent".
void refuse_idle(const FieldList& fields, const FieldList& usual, std::string_view cause,
                 std::initializer_list<std::string_view> idle);

template <typename Options>
void refuse_idle(Options options, std::string_view cause,
                 std::initializer_list<std::string_view> idle) {
  Options usual;
  refuse_idle(fields_of(options), fields_of(usual), cause, idle);
}

}  // namespace palpate
