// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/reduced_response.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "palpate/geometry/surface_query.h"

namespace palpate::haptics {
namespace {

// The three nodes that move a place most, with weights that sum to 1.
void blend_nodes(const SurfaceResponse& from, const Eigen::Vector3i& corners,
                 const Eigen::Vector3d& barycentric, Eigen::Index vertex, SurfaceResponse& to) {
  std::map<std::uint16_t, float> blended;
  for (Eigen::Index c = 0; c < 3; ++c) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      blended[from.nodes(k, corners[c])] +=
          static_cast<float>(barycentric[c]) * static_cast<float>(from.weights(k, corners[c]));
    }
  }
  std::vector<std::pair<std::uint16_t, float>> heaviest(blended.begin(), blended.end());
  std::ranges::stable_sort(heaviest,
                           [](const auto& a, const auto& b) { return a.second > b.second; });
  heaviest.resize(3, {heaviest.front().first, 0.0F});
  const float sum = heaviest[0].second + heaviest[1].second + heaviest[2].second;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    to.nodes(row, vertex) = heaviest[k].first;
    to.weights(row, vertex) = Eigen::half(heaviest[k].second / sum);
  }
}

}  // namespace

SurfaceResponse reduced_response(const Model& model, const geometry::TriangleMesh& surface,
                                 std::span<const std::size_t> kept) {
  const SurfaceResponse& from = *model.response;
  SurfaceResponse to = from;
  const geometry::SurfaceQuery query(model.surface);
  to.nodes.resize(3, surface.vertices.cols());
  to.weights.resize(3, surface.vertices.cols());
  for (Eigen::Index v = 0; v < surface.vertices.cols(); ++v) {
    const geometry::SurfacePoint at = query.closest_point(surface.vertices.col(v)).at;
    blend_nodes(from, model.surface.triangles.col(at.triangle), at.barycentric, v, to);
  }
  const std::vector<Eigen::Index> contacts(kept.begin(), kept.end());
  to.responses = from.responses(Eigen::all, contacts).eval();
  to.dents = from.dents(Eigen::all, contacts).eval();
  std::vector<Eigen::Index> shapes;
  std::vector<int> of;
  for (Eigen::Index s = 0; s < from.shape_contacts.size(); ++s) {
    const auto at = std::ranges::lower_bound(contacts, from.shape_contacts[s]);
    if (at == contacts.end() || *at != from.shape_contacts[s]) continue;
    shapes.push_back(s);
    of.push_back(static_cast<int>(at - contacts.begin()));
  }
  to.shape_contacts =
      Eigen::Map<const Eigen::RowVectorXi>(of.data(), static_cast<Eigen::Index>(of.size()));
  to.displacements = from.displacements(Eigen::all, shapes).eval();
  to.moves = from.moves(Eigen::all, shapes).eval();
  return to;
}

}  // namespace palpate::haptics
