// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/tool_places.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "palpate/core/error.h"
#include "palpate/core/file_fingerprint.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/campaign_store.h"

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

ToolPlaces::ToolPlaces(const fs::path& path, const geometry::TriangleMesh& surface)
    : acquisition_(path) {
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
  // Only a campaign knows what it recorded; other acquisitions have names alone.
  if (const auto campaign = probing::CampaignStore::find(path)) {
    for (const auto& [name, fingerprint] : campaign->range_map_fingerprints())
      fingerprints_[fs::path(name).filename().string()] = fingerprint;
  }
  if (known_.empty()) {
    throw InvalidInput(path.string() +
                       ": no sample that held names a range map (range_map); expected the "
                       "acquisition of 'palpate probe run --camera'");
  }
}

void ToolPlaces::check_is_recorded(const fs::path& range_map) {
  const auto recorded = fingerprints_.find(range_map.filename().string());
  if (has_warned_ || recorded == fingerprints_.end() ||
      recorded->second == file_fingerprint(range_map))
    return;
  has_warned_ = true;
  spdlog::warn(
      "{}: is not the range map that the campaign of {} recorded under this name. Unless you "
      "changed the range maps yourself, they belong to another campaign, and the contacts are "
      "wrong.",
      range_map.string(), acquisition_.string());
}

std::span<const geometry::KnownVertex> ToolPlaces::in(const fs::path& range_map) {
  check_is_recorded(range_map);
  const auto found = known_.find(range_map.filename().string());
  return found == known_.end() ? std::span<const geometry::KnownVertex>() : found->second;
}

}  // namespace palpate::apps
