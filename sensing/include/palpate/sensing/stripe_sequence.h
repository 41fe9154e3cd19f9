// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::sensing {

/// Length of the sequence that uses each of the n (n - 1) ordered pairs of n colours once:
/// n (n - 1) + 1 stripes.
[[nodiscard]] int longest_stripe_sequence(int colors);

/// Finds a sequence of stripes in which neighbours differ and every ordered pair of neighbours
/// appears at most once (thesis 3.3.1): part of an Eulerian circuit of the complete directed graph
/// of the colours. A sequence shorter than the longest uses the pairs that are easiest to
/// distinguish, plus those needed to reach every colour. The result is deterministic.
/// \param separation n x n, symmetric, >= 0: how well two colours can be distinguished; only the
///        order of its values matters.
/// \param stripes number of stripes; the longest sequence if not given.
/// \return indices of colours; the first one is 0.
/// \throws InvalidInput unless there are at least 2 colours, `separation` is square, symmetric and
/// free of NaN, and `stripes` is in [2, n (n - 1) + 1].
[[nodiscard]] std::vector<int> stripe_sequence(const Eigen::Ref<const Eigen::MatrixXd>& separation,
                                               std::optional<int> stripes = {});

}  // namespace palpate::sensing
