// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "probed_object.h"

namespace palpate::bench {

/// What says where contacts are placed, beside the distance to those begun.
enum class Guide {
  none,          ///< nothing: the order of plans, in which `adaptive` begins its contacts
  shapes,        ///< where the recorded surface moves differently from what kriging lets expect
  exact_shapes,  ///< the same without noise
  truth          ///< the same where the stiffness of all candidates is told
};

/// The first `most` candidates that are begun. \param first index of the first of them
[[nodiscard]] std::vector<std::size_t> order_of(const ProbedObject& object, Guide guide,
                                                std::size_t first, std::size_t most);

/// Logarithms of the stiffness of all candidates, kriged from those begun.
[[nodiscard]] Eigen::VectorXd felt_stiffness(const ProbedObject& object,
                                             const std::vector<std::size_t>& begun);

/// The same, changed by what is seen: as much as left-out contacts show that it tells, if it tells
/// anything.
[[nodiscard]] Eigen::VectorXd seen_stiffness(const ProbedObject& object,
                                             const std::vector<std::size_t>& begun,
                                             const Eigen::MatrixXd& motions);

}  // namespace palpate::bench
