// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "deformation/rest_links.h"

#include <cstddef>

namespace palpate::geometry {
namespace {

/// Largest l: nodes whose rotations enclose more than about a right angle do not bend smoothly.
constexpr double kMostBent = 1.5;

}  // namespace

Eigen::Matrix3Xd rest_links(const DeformationGraph& graph,
                            std::span<const Eigen::Isometry3d> motions, double scale) {
  const Eigen::Matrix2Xi& edges = graph.edges();
  Eigen::Matrix3Xd links(3, edges.cols());
  for (Eigen::Index e = 0; e < edges.cols(); ++e) {
    const int j = edges(0, e), k = edges(1, e);
    const Eigen::Isometry3d& of_j = motions[static_cast<std::size_t>(j)];
    const Eigen::Isometry3d& of_k = motions[static_cast<std::size_t>(k)];
    const Eigen::Vector3d link = graph.nodes().col(k) - graph.nodes().col(j);
    const double projected = ((of_j.linear() + of_k.linear()) * link).norm() / 2;
    const double length = projected * kMostBent > link.norm() ? link.norm() / projected : kMostBent;
    links.col(e) = scale * length * link;
  }
  return links;
}

}  // namespace palpate::geometry
