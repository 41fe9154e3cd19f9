// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/scan_conflicts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <tuple>

#include "base/numbers.h"
#include "palpate/core/parallel_for.h"
#include "palpate/geometry/surface_query.h"

namespace palpate::geometry {
namespace {

/// Places of a scan that are looked at: fewer if there are many scans, because each is compared
/// with all others.
constexpr Eigen::Index kMostPlaces = 1000, kFewestPlaces = 100, kPlacesOfAll = 50000;
/// Where the viewpoint is not known, other surfaces are looked for along the normal, up to this
/// many tolerances away: farther off, an open surface may rightly be in front of another.
constexpr double kBlindReach = 10;
/// Two scans share a place iff the other one has a surface near or in front of it. Too few shared
/// places tell nothing.
constexpr std::size_t kFewestShared = 20;
/// Scans are in conflict iff more than this share of their shared places is: noise of up to twice
/// the spacing, outlines and a few loose points stay below.
constexpr double kLargestShare = 0.1;

}  // namespace

ConflictSearch::ConflictSearch(std::span<const Scan> scans, const std::vector<TriangleMesh>& meshes,
                               double tolerance)
    : places_(scans.size()), tolerance_(tolerance) {
  const auto count = static_cast<Eigen::Index>(scans.size());
  const Eigen::Index most = std::clamp(kPlacesOfAll / count, kFewestPlaces, kMostPlaces);
  parallel_for(scans.size(), [&](std::size_t i) {
    const TriangleMesh& mesh = meshes[i];
    const Eigen::Matrix3Xd normals = vertex_normals(mesh);
    const double step = static_cast<double>(mesh.vertices.cols()) / static_cast<double>(most);
    for (double v = 0; v < static_cast<double>(mesh.vertices.cols()); v += std::max(step, 1.0)) {
      const auto vertex = static_cast<Eigen::Index>(v);
      Place place{.at = mesh.vertices.col(vertex),
                  .to_viewer = normals.col(vertex),
                  .free = kBlindReach * tolerance_};
      if (!place.to_viewer.allFinite()) continue;  // of no triangle
      if (scans[i].viewpoint) {
        const Eigen::Vector3d way = scans[i].T_object_scan * *scans[i].viewpoint - place.at;
        place.free = way.norm();
        place.to_viewer = way / place.free;
      }
      places_[i].push_back(place);
    }
  });
}

void ConflictSearch::add(int other, const ScanDistance& surface) {
  std::vector<std::optional<ScanConflict>> conflicts(places_.size());
  parallel_for(places_.size(), [&](std::size_t scan) {
    if (scan == static_cast<std::size_t>(other)) return;
    std::size_t shared = 0;
    std::vector<double> depths;
    for (const Place& place : places_[scan]) {
      if (surface.query().closest_point(place.at).distance <= tolerance_) {
        ++shared;
        continue;
      }
      const auto hit = surface.query().first_hit(
          {.origin = place.at, .direction = place.to_viewer, .max_distance = place.free});
      // A surface that faces the viewer, seen from behind.
      if (!hit || !(surface.normal(hit->at.triangle).dot(place.to_viewer) > 0)) continue;
      ++shared;
      depths.push_back(hit->distance);
    }
    const double share = static_cast<double>(depths.size()) / static_cast<double>(shared);
    if (shared < kFewestShared || !(share > kLargestShare)) return;
    conflicts[scan] = {.scan = static_cast<int>(scan),
                       .other = other,
                       .share = share,
                       .depth = rank_quantile(depths, 0.5)};
  });
  for (const std::optional<ScanConflict>& conflict : conflicts) {
    if (conflict) found_.push_back(*conflict);
  }
}

std::vector<ScanConflict> ConflictSearch::found() const {
  std::vector<ScanConflict> sorted = found_;
  std::ranges::sort(sorted, [](const ScanConflict& a, const ScanConflict& b) {
    return std::tuple(-a.share, a.scan, a.other) < std::tuple(-b.share, b.scan, b.other);
  });
  return sorted;
}

}  // namespace palpate::geometry
