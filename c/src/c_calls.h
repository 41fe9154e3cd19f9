// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>

#include "palpate.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/model.h"

namespace palpate::c {

/// The object behind a `palpate_model`. The types of handles stay undefined, so that the interface
/// says nothing of what is behind them.
struct OpenModel {
  std::shared_ptr<const haptics::Model> model;
  std::shared_ptr<const haptics::BlendedField> field;
};

inline const OpenModel* behind(const palpate_model* handle) noexcept {
  return reinterpret_cast<const OpenModel*>(handle);
}

/// Sets the words of `palpate_error_text`. Allocates nothing.
palpate_status fail(palpate_status status, const char* words) noexcept;
/// The same for the exception that is being handled.
palpate_status fail_as_thrown() noexcept;

/// Calls `body`; an exception becomes a status.
template <typename Body>
palpate_status guarded(const Body& body) noexcept {
  try {
    body();
    return PALPATE_OK;
  } catch (...) {
    return fail_as_thrown();
  }
}

/// The caller's struct as this version knows it: zero where the caller's is shorter.
template <typename Struct>
Struct taken(const Struct& given) noexcept {
  Struct whole{};
  std::memcpy(&whole, &given, std::min<std::size_t>(given.struct_size, sizeof(Struct)));
  return whole;
}

/// Fills the caller's struct as far as it goes.
template <typename Struct>
void give(Struct whole, Struct& to) noexcept {
  whole.struct_size = to.struct_size;
  std::memcpy(&to, &whole, std::min<std::size_t>(to.struct_size, sizeof(Struct)));
}

/// Copies the columns of a 3 x n matrix. \throws InvalidInput naming `what` if fewer fit.
void copy_floats(const Eigen::Matrix3Xd& from, float* to, std::uint64_t count, const char* what);

}  // namespace palpate::c
