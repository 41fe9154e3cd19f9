// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

struct PlayableOptions {
  double off_surface = 5;         ///< [mm] of a contact; > 0
  std::size_t most_bases = 1000;  ///< of a contact: 1000 take a quarter of a tick of 1 ms
};

/// Checks what a model needs besides `check_model` to be felt with a device, where the force must
/// make sense and be there in time.
/// \throws InvalidInput naming the contact, what is wrong with it and what would be right.
void check_playable(const Model& model, const PlayableOptions& options = {});

}  // namespace palpate::haptics
