// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::sensing {

/// n colours have n (n - 1) ordered pairs; a sequence that uses each once has one stripe more.
[[nodiscard]] int longest_stripe_sequence(int colors);

/// A sequence of stripes in which neighbours differ and every ordered pair of neighbours appears at
/// most once (thesis 3.3.1): part of an Eulerian circuit of the graph that joins colours both ways.
/// The longest one uses each pair once; a shorter one uses the pairs that are easiest to tell apart
/// (and those that are needed to reach every colour). The same input gives the same sequence.
/// \param separation n x n, symmetric, >= 0: how easily two colours are told apart; only the order
///        of its values counts.
/// \param stripes their number, or 0 for the longest sequence.
/// \return indices of colours, the first being 0.
/// \throws InvalidInput unless there are at least 2 colours, `separation` is square, symmetric and
/// free of NaN, and `stripes` is 0 or from 2 to n (n - 1) + 1.
[[nodiscard]] std::vector<int> stripe_sequence(const Eigen::Ref<const Eigen::MatrixXd>& separation,
                                               int stripes = 0);

}  // namespace palpate::sensing
