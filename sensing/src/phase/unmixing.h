// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "phase/demodulation.h"

namespace palpate::sensing {

/// Separates the sinusoids of the projector's colours, which the camera's channels see mixed. The
/// means stay as they are, because the trained hues are those of the mixed light. Nothing changes
/// for the identity or a single channel.
/// \param mixing as `Rig::color_mixing`: red, green, blue.
/// \param channels green, red, blue.
void unmix(const Eigen::Matrix3d& mixing, std::vector<Demodulated>& channels);

}  // namespace palpate::sensing
