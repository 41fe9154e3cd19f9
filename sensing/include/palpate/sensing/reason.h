// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::sensing {

/// Outcome of a pixel: reconstructed, or the first check of the decoder that rejected it, in the
/// order of processing. The numbers are stored in files and do not change.
enum class Reason : std::uint8_t {
  reconstructed = 0,
  unlit = 1,             ///< the projector's light is below min_signal, and no channel is clipped
  saturated = 2,         ///< clipped at full scale; the remaining sinusoid is too weak
  low_modulation = 3,    ///< the sinusoid is too weak: min_modulation, max_phase_sigma
  uneven_phase = 4,      ///< the phase variance exceeds max_phase_variance: a step, or noise
  no_transition = 5,     ///< too few stripe edges were read in its region, or it has no anchor
  ambiguous_offset = 6,  ///< stripe edges, or hidden steps, leave several multiples of 2 pi
  border = 7,            ///< its window crosses the border of the light or a step of the phase
  off_panel = 8,         ///< its phase leads to a point that the projector does not light
  grazing = 9,           ///< |dz / dphase| exceeds max_sensitivity
  color_mismatch = 10,   ///< nearby colours contradict the stripes that its depth implies
};
inline constexpr int kReasonCount = 11;

/// The enumerator's name: "unlit", "low_modulation", ...
[[nodiscard]] std::string_view name(Reason reason);

/// Codes of `Reason`, rows x cols, row-major.
using ReasonImage = Eigen::Array<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Number of pixels with a reason.
[[nodiscard]] long count(const ReasonImage& reasons, Reason reason);

}  // namespace palpate::sensing
