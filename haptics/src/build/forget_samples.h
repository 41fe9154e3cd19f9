// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Drops what relates a model to the acquisition that it was fitted to: the samples do not describe
/// an object that was changed.
inline void forget_samples(Model& model) {
  model.T_surface_acquisition.setIdentity();
  model.noise.reset();
  model.samples_fingerprint.reset();
  model.pressing_offsets.reset();
}

}  // namespace palpate::haptics
