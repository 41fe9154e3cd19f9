// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "palpate/haptics/model.h"
#include "palpate/haptics/realignment.h"

namespace palpate::haptics {

/// Digits of the noise that a model stores; models are fitted with this noise.
inline constexpr int kNoiseDigits = 3;

/// Completes what a model says of its errors: learns the part between contacts
/// (`ContactUncertainty::between`) from how well the samples of each contact are predicted from
/// those around it. It maximises the likelihood of these errors at a contact and its neighbours,
/// with what is most likely for all contacts as its prior. The contacts have the other parts
/// already.
/// \param samples of each contact, in its local frame.
[[nodiscard]] Model with_uncertainty(Model model, std::span<const ForceSamples> samples,
                                     const MeasurementNoise& noise);

/// [N^2] Expected square of the noise of a measured force where the stiffness [N/mm] is given.
[[nodiscard]] double noise_variance(const MeasurementNoise& noise,
                                    const Eigen::Matrix3d& stiffness);

}  // namespace palpate::haptics
