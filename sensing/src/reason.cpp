// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/reason.h"

#include <array>

namespace palpate::sensing {
namespace {

constexpr std::array<std::string_view, kReasonCount> kNames = {
    "reconstructed",    "unlit",  "saturated", "low_modulation", "uneven_phase",  "no_transition",
    "ambiguous_offset", "border", "off_panel", "grazing",        "color_mismatch"};

}  // namespace

std::string_view name(Reason reason) { return kNames.at(static_cast<std::size_t>(reason)); }

long count(const ReasonImage& reasons, Reason reason) {
  return (reasons == static_cast<std::uint8_t>(reason)).count();
}

}  // namespace palpate::sensing
