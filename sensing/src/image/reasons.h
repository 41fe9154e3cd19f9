// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image_plane.h"
#include "palpate/sensing/reason.h"

namespace palpate::sensing {

[[nodiscard]] constexpr std::uint8_t code(Reason reason) {
  return static_cast<std::uint8_t>(reason);
}

/// Sets the reason of those pixels of a mask that are still `reconstructed`; an earlier reason
/// stays.
void give_reason(const Mask& where, Reason reason, ReasonImage& reasons);

/// The same for the pixels outside a mask.
void give_reason_unless(const Mask& where, Reason reason, ReasonImage& reasons);

/// Sets all pixels to NaN that are not `reconstructed`.
void keep_reconstructed(const ReasonImage& reasons, Plane& image);

}  // namespace palpate::sensing
