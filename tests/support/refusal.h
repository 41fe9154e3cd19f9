// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "palpate/core/error.h"

namespace palpate {

/// The message of the InvalidInput (or FileError) that `call` throws.
template <typename Call>
std::string refusal(Call&& call) {
  try {
    static_cast<void>(call());
  } catch (const InvalidInput& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

}  // namespace palpate
