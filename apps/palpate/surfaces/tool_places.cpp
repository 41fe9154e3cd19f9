// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/tool_places.h"

#include <fmt/format.h>

#include "palpate/core/error.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/probing/acquisition_store.h"

namespace palpate::apps {
namespace {

/// Distance of a contact, in diagonals of the surface, above which it is in another frame.
constexpr double kBeside = 0.05;

/// The corner of the triangle below a place that is nearest to it.
int nearest_vertex(const geometry::TriangleMesh& surface, const geometry::ClosestPoint& place) {
  Eigen::Index corner = 0;
  place.at.barycentric.maxCoeff(&corner);
  return surface.triangles(corner, place.at.triangle);
}

}  // namespace

ToolPlaces::ToolPlaces(const fs::path& path, const geometry::TriangleMesh& surface) {
  const probing::CheckedAcquisition acquisition = probing::read_acquisition(path);
  const geometry::SurfaceQuery query(surface);
  const double allowed = kBeside * geometry::bounding_box(surface).diagonal().norm();
  for (const probing::Sample& sample : acquisition.samples()) {
    if (sample.slipped || !sample.range_map) continue;
    const Eigen::Vector3d& from =
        acquisition.contacts()[*acquisition.find(sample.contact)].position;
    const geometry::ClosestPoint place = query.closest_point(from);
    if (!(place.distance <= allowed)) {
      throw InvalidInput(
          fmt::format("{}: contact {} is {:.1f} mm from the reference; both must be in the frame "
                      "of the camera. Leave out --acquisition, or give a reference in the frame of "
                      "the contacts",
                      path.string(), sample.contact, place.distance));
    }
    const int vertex = nearest_vertex(surface, place);
    known_[fs::path(*sample.range_map).filename().string()].push_back(
        {vertex, surface.vertices.col(vertex) + sample.b - from});
  }
  if (known_.empty()) {
    throw InvalidInput(path.string() +
                       ": no sample that held names a range map (range_map); expected the "
                       "acquisition of 'palpate probe run --camera'");
  }
}

std::span<const geometry::KnownVertex> ToolPlaces::in(const fs::path& range_map) const {
  const auto found = known_.find(range_map.filename().string());
  return found == known_.end() ? std::span<const geometry::KnownVertex>() : found->second;
}

}  // namespace palpate::apps
