// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "palpate/haptics/build_model.h"
#include "palpate/haptics/pressing_estimate.h"
#include "palpate/haptics/rate_fit.h"
#include "palpate/haptics/realignment.h"
#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// The contacts of the model in the acquisition.
struct Probed {
  const probing::CheckedAcquisition& acquisition;
  std::vector<std::size_t> source;  ///< index in the acquisition of each contact of the model
  std::vector<double> heights;      ///< [mm] depth of each below the surface

  [[nodiscard]] std::size_t size() const { return source.size(); }
  [[nodiscard]] const probing::Contact& contact(std::size_t i) const {
    return acquisition.contacts()[source[i]];
  }
  [[nodiscard]] std::span<const probing::Sample> samples(std::size_t i) const {
    return acquisition.samples_of(source[i]);
  }
};

/// Pairs of displacement and force of each contact, in the frame of the acquisition.
struct Pairs {
  std::vector<ForceSamples> samples;
  std::optional<PressingEstimate> pressing = std::nullopt;  ///< if all were only pressed
  std::optional<RateFit> rate = std::nullopt;               ///< with `BuildOptions::rate`
};

/// The records of a contact as of one that was only pressed, against its normal.
/// \param height [mm] depth of the contact below the surface of the object.
[[nodiscard]] PressedContact pressed_contact(const probing::Contact& contact,
                                             std::span<const probing::Sample> samples,
                                             double height);

/// Returns true if these contacts of an acquisition were only pressed: no sample slipped or has a
/// tangential stage, and displacements lie along one line at all but a tenth of them.
[[nodiscard]] bool is_pressing_only(const probing::CheckedAcquisition& acquisition,
                                    std::span<const std::size_t> contacts);

/// Returns the response of the object itself in the records of a contact that touched at `touch`
/// [mm]: displacements from the true surface, and forces without the offsets and as on the way in.
[[nodiscard]] ForceSamples corrected(const PressedContact& contact, const PressingOffsets& offsets,
                                     double touch);

/// Pairs of contacts that were only pressed, without the offsets that are found.
/// \throws InvalidInput if `options` do not suit such contacts.
[[nodiscard]] Pairs pressed_pairs(const Probed& probed, const BuildOptions& options);

}  // namespace palpate::haptics
