// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::haptics {

/// What playback lacks where a ball of another radius touches than the one that probed, as a part
/// of the force that is played: sqrt(tool / probe) - 1, by Hertz' law for a ball that presses on a
/// thick solid. On a thin layer over a hard base up to the 0.9th power was measured, on a stretched
/// membrane the 0.08th (docs/trade-playback.md). \param probe_radius, tool_radius [mm].
/// \throws InvalidInput unless both are > 0 and finite.
[[nodiscard]] double missing_force(double probe_radius, double tool_radius);

}  // namespace palpate::haptics
