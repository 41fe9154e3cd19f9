// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::haptics {

/// Returns the force that playback lacks if a ball of another radius than that of the probe
/// touches, as a share of the played force: sqrt(tool / probe) - 1, by Hertz' law for a ball on a
/// thick solid. Measurements on a thin layer over a hard base show up to the 0.9th power, on a
/// stretched membrane the 0.08th (docs/trade-playback.md). \param probe_radius, tool_radius [mm].
/// \throws InvalidInput unless both are > 0 and finite.
[[nodiscard]] double missing_force(double probe_radius, double tool_radius);

}  // namespace palpate::haptics
