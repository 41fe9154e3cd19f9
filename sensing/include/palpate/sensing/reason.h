// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

namespace palpate::sensing {

/// What became of a pixel of a frame: the first of these that holds, in the order in which the
/// decoder works. The numbers stand in files and do not change.
enum class Reason : std::uint8_t {
  reconstructed = 0,
  unlit = 1,             ///< less light of the projector than min_signal, none clipped
  saturated = 2,         ///< clipped at full scale; what is left of the sinusoid is too weak
  low_modulation = 3,    ///< the sinusoid is weaker than min_modulation or min_contrast asks for
  uneven_phase = 4,      ///< the phase varies by more than max_phase_variance: a step, or noise
  no_transition = 5,     ///< too few stripe edges were read in its region, or no anchor lies there
  ambiguous_offset = 6,  ///< its region's stripe edges disagree on the multiple of 2 pi
  border = 7,            ///< the window reaches over the edge of the light or a step of the phase
  off_panel = 8,         ///< its phase leads to a point that the projector does not light
  grazing = 9,           ///< the depth depends on the phase by more than max_sensitivity
  color_mismatch = 10,   ///< the colours around it are not those of the stripes its depth implies
};
inline constexpr int kReasonCount = 11;

/// The enumerator's name: "unlit", "low_modulation", ...
[[nodiscard]] std::string_view name(Reason reason);

/// Codes of `Reason`, rows x cols, row after row.
using ReasonImage = Eigen::Array<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Number of pixels of one reason.
[[nodiscard]] long count(const ReasonImage& reasons, Reason reason);

}  // namespace palpate::sensing
