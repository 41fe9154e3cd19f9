// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/delivery.h"

#include "image/hot_loop.h"
#include "image/reasons.h"

namespace palpate::sensing {
namespace {

/// Reasons of pixels outside the part, where too few are lit for a window.
PALPATE_HOT_LOOP void give_reasons_around(const std::uint8_t* clipped, const std::uint8_t* lit,
                                          std::uint8_t* __restrict reasons, long pixels) {
  for (long i = 0; i < pixels; ++i) {
    const std::uint8_t dark = lit[i] != 0 ? code(Reason::low_modulation) : code(Reason::unlit);
    reasons[i] = clipped[i] != 0 ? code(Reason::saturated) : dark;
  }
}

}  // namespace

void find_reasons_around(Workspace& work) {
  const Mask& lit = work.image_lit;
  find_clipped(work.image, work.clipped);
  work.reasons_around.resize(lit.rows(), lit.cols());
  give_reasons_around(work.clipped.data(), lit.data(), work.reasons_around.data(), lit.size());
}

}  // namespace palpate::sensing
