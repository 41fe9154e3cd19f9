// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/surface_refinement.h"

#include <algorithm>
#include <numbers>
#include <utility>
#include <vector>

#include "model/contact_places.h"
#include "palpate/geometry/edge_splitting.h"
#include "palpate/geometry/surface_query.h"
#include "samples/nearest_contacts.h"
#include "samples/position_tree.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

// Longest edge at a contact, in distances to the nearest other contact: what `geometry::remesh` to
// half that distance leaves.
constexpr double kLongestEdge = 2.0 / 3;
// Longest edge elsewhere, in distances from a contact: the same in the middle of a square of
// contacts.
constexpr double kLongestEdgeBetween = kLongestEdge * std::numbers::sqrt2;

/// The longest edges that contacts allow.
struct EdgeLimits {
  Eigen::Matrix3Xd positions;   // of contacts
  std::vector<double> longest;  // [mm] edge at each
};

double distance_from_edge(const Vector3d& point, const Vector3d& a, const Vector3d& b) {
  const Vector3d along = b - a;
  const double at = std::clamp((point - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (a + at * along - point).norm();
}

EdgeLimits edge_limits(const std::vector<PressedContact>& contacts) {
  EdgeLimits limits;
  limits.positions.resize(3, static_cast<Eigen::Index>(contacts.size()));
  for (const std::vector<std::size_t>& near : nearest_contacts(contacts, 1)) {
    if (near.size() < 2) continue;
    const Vector3d& here = contacts[near[0]].position;
    const double distance = (contacts[near[1]].position - here).norm();
    if (distance == 0) continue;
    limits.positions.col(static_cast<Eigen::Index>(limits.longest.size())) = here;
    limits.longest.push_back(kLongestEdge * distance);
  }
  limits.positions.conservativeResize(3, static_cast<Eigen::Index>(limits.longest.size()));
  return limits;
}

}  // namespace

RefinedSurface refine_surface(const Eigen::Matrix3Xd& directions, Model& model) {
  std::vector<PressedContact> contacts(model.contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    contacts[i].position = model.contacts[i].position;
    contacts[i].direction = directions.col(static_cast<Eigen::Index>(i));
  }
  const EdgeLimits limits = edge_limits(contacts);
  const PositionTree tree(limits.positions);
  const auto is_long = [&](const Vector3d& a, const Vector3d& b) {
    const double length = (b - a).norm();
    // Contacts that are farther away allow longer edges.
    const double reach = length / 2 + length / kLongestEdgeBetween;
    return std::ranges::any_of(tree.in_cube((a + b) / 2, reach), [&](std::size_t i) {
      const Vector3d position = limits.positions.col(static_cast<Eigen::Index>(i));
      return length >
             std::max(limits.longest[i], kLongestEdgeBetween * distance_from_edge(position, a, b));
    });
  };
  geometry::SplitMesh split = geometry::split_edges(model.surface, is_long);
  model.surface = std::move(split.mesh);
  return {.ends = std::move(split.ends),
          .places = contact_places(model, geometry::SurfaceQuery(model.surface))};
}

}  // namespace palpate::haptics
