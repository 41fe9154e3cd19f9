// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/realignment.h"
#include "palpate/probing/acquisition.h"

namespace palpate::view {

/// A pair of displacement and force, as an arrow: where the tool was, and its force on the object.
struct SampleArrow {
  std::size_t contact = 0;                          ///< index in the acquisition
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();   ///< [mm] realigned (`haptics::realign`)
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]
  haptics::PairKind kind = haptics::PairKind::held;
  std::optional<double> residual = {};  ///< [N] |model - measured|, if the model has the contact
};

/// The pairs of all contacts, realigned as for a fit. \param model whose forces at its contacts are
/// compared, at the same displacements; none: no residuals.
[[nodiscard]] std::vector<SampleArrow> sample_arrows(const probing::CheckedAcquisition& acquisition,
                                                     const haptics::Model* model);

/// [N] Root mean square of the residuals; none if there is none.
[[nodiscard]] std::optional<double> residual_rms(const std::vector<SampleArrow>& arrows);

}  // namespace palpate::view
