// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "palpate/haptics/pressing_estimate.h"
#include "palpate/haptics/rate_fit.h"
#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// The samples of a contact that was only pressed, as one motion over time. A path begins with the
/// first sample below the surface, after a sample outside, and after a gap in time of more than ten
/// median steps; a displacement outside counts as zero.
struct PressedPath {
  ToolHistory path;
  std::vector<Eigen::Index> order;  ///< index among the samples of each moment
};

/// \param displacements [mm] of the samples from the true surface, in any frame. \param direction
/// unit vector into the object, in that frame.
/// \throws InvalidInput if times do not distinguish the samples, naming the contact.
[[nodiscard]] PressedPath pressed_path(long long contact, std::span<const probing::Sample> samples,
                                       const Eigen::Matrix3Xd& displacements,
                                       const Eigen::Vector3d& direction);

/// [N] 3 x N, in the order of the samples: what the rate adds to the forces of a field, in the
/// frame of field and displacements. Parameters as `pressed_path`.
[[nodiscard]] Eigen::Matrix3Xd pressed_rate_forces(std::span<const RateTerm> terms,
                                                   const ForceField& field, long long contact,
                                                   std::span<const probing::Sample> samples,
                                                   const Eigen::Matrix3Xd& displacements,
                                                   const Eigen::Vector3d& direction);

/// Contacts that were only pressed, and how their force depends on the rate.
struct PressedRate {
  PressingEstimate estimate;             ///< of the forces that stay
  std::vector<PressedContact> contacts;  ///< with these forces
  RateFit rate;
};

/// Estimates curves of force over depth and the dependence on the rate in turn, each from the
/// remainder of the other, until they agree: `estimate_pressing` and `fit_rate`. If the records
/// show no dependence, the estimate is that of `estimate_pressing` alone.
/// \param samples of each contact, in the order of its records. \param max_bases of a field.
/// \throws InvalidInput as `pressed_path`.
[[nodiscard]] PressedRate estimate_pressed_rate(
    const std::vector<PressedContact>& contacts,
    const std::vector<std::span<const probing::Sample>>& samples, const PressingOptions& options,
    int max_bases);

}  // namespace palpate::haptics
