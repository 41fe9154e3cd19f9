// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/reason.h"

#include <array>

#include "image/hot_loop.h"
#include "image/reasons.h"

namespace palpate::sensing {
namespace {

constexpr std::array<std::string_view, kReasonCount> kReasonNames = {
    "reconstructed",    "unlit",  "saturated", "low_modulation", "uneven_phase",  "no_transition",
    "ambiguous_offset", "border", "off_panel", "grazing",        "color_mismatch"};

/// \param unless mask value of the pixels that get no reason.
PALPATE_HOT_LOOP void give_reason_to(const std::uint8_t* where, std::uint8_t unless,
                                     std::uint8_t reason, std::uint8_t* reasons, long count) {
  for (long i = 0; i < count; ++i) {
    const bool gets = (reasons[i] == 0) & (where[i] != unless);
    reasons[i] = gets ? reason : reasons[i];
  }
}

PALPATE_HOT_LOOP void keep(const std::uint8_t* reasons, float* values, long count) {
  for (long i = 0; i < count; ++i) values[i] = reasons[i] == 0 ? values[i] : kUnknown;
}

}  // namespace

std::string_view name(Reason reason) { return kReasonNames.at(static_cast<std::size_t>(reason)); }

long count(const ReasonImage& reasons, Reason reason) {
  return (reasons == static_cast<std::uint8_t>(reason)).count();
}

void give_reason(const Mask& where, Reason reason, ReasonImage& reasons) {
  give_reason_to(where.data(), 0, code(reason), reasons.data(), reasons.size());
}

void give_reason_unless(const Mask& where, Reason reason, ReasonImage& reasons) {
  give_reason_to(where.data(), 1, code(reason), reasons.data(), reasons.size());
}

void keep_reconstructed(const ReasonImage& reasons, Plane& image) {
  keep(reasons.data(), image.data(), image.size());
}

}  // namespace palpate::sensing
