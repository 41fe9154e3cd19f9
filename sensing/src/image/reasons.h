// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image_plane.h"
#include "palpate/sensing/reason.h"

namespace palpate::sensing {

[[nodiscard]] constexpr std::uint8_t code(Reason reason) {
  return static_cast<std::uint8_t>(reason);
}

/// Gives a reason to the pixels of a mask that still are `reconstructed`: the first reason stays.
void give_reason(const Mask& where, Reason reason, ReasonImage& reasons);

/// The same for the pixels outside a mask.
void give_reason_unless(const Mask& where, Reason reason, ReasonImage& reasons);

/// Makes all other pixels NaN.
void keep_reconstructed(const ReasonImage& reasons, Plane& image);

}  // namespace palpate::sensing
