// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "palpate/haptics/pressing_estimate.h"
#include "palpate/haptics/realignment.h"
#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// The records of a contact as of one that was only pressed, against its normal.
/// \param height [mm] depth of the contact below the surface of the object.
[[nodiscard]] PressedContact pressed_contact(const probing::Contact& contact,
                                             std::span<const probing::Sample> samples,
                                             double height);

/// Whether nothing but pressing was recorded of these contacts of an acquisition: no sample slipped
/// or has a tangential stage, and displacements lie along one line at all but a tenth of them.
[[nodiscard]] bool is_pressing_only(const probing::CheckedAcquisition& acquisition,
                                    std::span<const std::size_t> contacts);

/// What the object itself did in the records of a contact that touched at `touch` [mm]:
/// displacements from the true surface, and forces without the offsets and as on the way in.
[[nodiscard]] ForceSamples corrected(const PressedContact& contact, const PressingOffsets& offsets,
                                     double touch);

}  // namespace palpate::haptics
