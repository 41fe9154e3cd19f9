// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "deformation/link_lengths.h"

#include <cstddef>

namespace palpate::geometry {
namespace {

/// Largest ratio of a link's chord and its projection.
constexpr double kMostBent = 1.5;

}  // namespace

Eigen::VectorXd link_lengths(const DeformationGraph& graph,
                             std::span<const Eigen::Isometry3d> motions) {
  const Eigen::Matrix2Xi& edges = graph.edges();
  Eigen::VectorXd lengths(edges.cols());
  for (Eigen::Index e = 0; e < edges.cols(); ++e) {
    const int j = edges(0, e), k = edges(1, e);
    const Eigen::Isometry3d& of_j = motions[static_cast<std::size_t>(j)];
    const Eigen::Isometry3d& of_k = motions[static_cast<std::size_t>(k)];
    const Eigen::Vector3d link = graph.nodes().col(k) - graph.nodes().col(j);
    const Eigen::Vector3d chord = of_k * graph.nodes().col(k) - of_j * graph.nodes().col(j);
    const double straight = chord.norm() * link.norm();
    const double projected = chord.dot((of_j.linear() + of_k.linear()) * link) / 2;
    lengths[e] = projected * kMostBent > straight ? straight / projected : kMostBent;
  }
  return lengths;
}

}  // namespace palpate::geometry
