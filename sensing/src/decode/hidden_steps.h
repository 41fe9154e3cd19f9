// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "colors/hue_classifier.h"
#include "decode/decoder_geometry.h"
#include "decode/plausibility.h"
#include "image/image_plane.h"
#include "phase/demodulation.h"

namespace palpate::sensing {

/// Marks the pixels that may belong to either of two surfaces.
///
/// Two surfaces may meet where their depths differ, but their phases only by whole turns. If they
/// are about as bright, only the stripes show the place of the step. From such a step along the
/// row, pixels are marked until the colours that the other surface would have are no longer seen.
/// \param channels the sinusoid in each channel.
/// \param phase [rad] absolute; NaN where unknown.
void find_hidden_steps(const std::vector<Demodulated>& channels, const Plane& phase,
                       const Plane& hue, const HueClassifier& classifier,
                       const StripeColors& stripes, const DecoderGeometry& model, Mask& marked);

}  // namespace palpate::sensing
