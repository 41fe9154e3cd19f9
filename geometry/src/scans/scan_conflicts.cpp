// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/scan_conflicts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>

#include "base/numbers.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/quantile.h"

namespace palpate::geometry {
namespace {

/// Places of a scan that are looked at: fewer if there are many scans, because each is compared
/// with all others.
constexpr Eigen::Index kMostPlaces = 1000, kFewestPlaces = 100, kPlacesOfAll = 50000;
/// If the viewpoint is not known, other surfaces are looked for along the normal, up to this many
/// tolerances away: farther off, an open surface may rightly be in front of another.
constexpr double kBlindReach = 10;
/// Two scans share a place if the other one has a surface near or in front of it. Too few shared
/// places show nothing.
constexpr std::size_t kFewestShared = 20;
/// Scans are in conflict iff more than this share of their shared places is: noise of up to twice
/// the spacing, outlines and a few loose points stay below.
constexpr double kLargestShare = 0.1;

using GridIndex = Eigen::Array<std::int64_t, 3, 1>;

/// The grid point nearest to a place, in units of the grid.
GridIndex nearest_point(const Eigen::Vector3d& place) {
  return place.array().round().cast<std::int64_t>();
}

/// Length of a ray from a place inside a cell of a grid of this size to the border of the cell.
double way_to_next(const Eigen::Vector3d& place, const Eigen::Vector3d& along, double cell) {
  const Eigen::Array3d low = (place.array() / cell).floor() * cell;
  const Eigen::Array3d border = (along.array() > 0).select(low + cell, low);
  const Eigen::Array3d ways = (border - place.array()) / along.array();
  return (ways >= 0).select(ways, kInfinity).minCoeff();  // NaN: along the border
}

/// Distance along a ray at which the first surface that it meets faces along it; in grid units.
/// \param box holds the surface.
std::optional<double> leaves_surface(const DistanceVolume& surface, const Eigen::AlignedBox3d& box,
                                     const Eigen::Vector3d& from, const Eigen::Vector3d& along,
                                     double length) {
  // Far enough into the next block that rounding does not end before it.
  constexpr double kInto = 1e-3;
  const Eigen::Array3d low = (box.min() - from).array() / along.array();
  const Eigen::Array3d high = (box.max() - from).array() / along.array();
  const double end = std::min(length, low.max(high).minCoeff());
  double last = kNan;  // distance at the grid point before
  for (double way = std::max(0.0, low.min(high).maxCoeff()); way <= end;) {
    const Eigen::Vector3d place = from + way * along;
    const GridIndex at = nearest_point(place);
    if (!surface.has_block(block_key(at[0], at[1], at[2]))) {
      last = kNan;
      // A grid point is nearest to the places half a spacing around it.
      way += way_to_next(place.array() + 0.5, along, kBlockEdge) + kInto;
      continue;
    }
    const std::optional<GridDistance> there = surface.find(at[0], at[1], at[2]);
    if (!there || there->beyond > 0) {
      last = kNan;
    } else {
      if (last < 0 && there->distance >= 0) return way - there->distance / (there->distance - last);
      if (last >= 0 && there->distance < 0) return std::nullopt;
      last = there->distance;
    }
    way += 1;
  }
  return std::nullopt;
}

}  // namespace

ConflictSearch::ConflictSearch(std::span<const Scan> scans, const std::vector<TriangleMesh>& meshes,
                               const Grid& grid, double tolerance)
    : places_(scans.size()), grid_(grid), tolerance_(tolerance) {
  const auto count = static_cast<Eigen::Index>(scans.size());
  const Eigen::Index most = std::clamp(kPlacesOfAll / count, kFewestPlaces, kMostPlaces);
  parallel_for(scans.size(), [&](std::size_t i) {
    const TriangleMesh& mesh = meshes[i];
    const Eigen::Matrix3Xd normals = scans[i].viewpoint ? Eigen::Matrix3Xd() : vertex_normals(mesh);
    const double step = static_cast<double>(mesh.vertices.cols()) / static_cast<double>(most);
    for (double v = 0; v < static_cast<double>(mesh.vertices.cols()); v += std::max(step, 1.0)) {
      const auto vertex = static_cast<Eigen::Index>(v);
      Place place{.at = mesh.vertices.col(vertex)};
      if (scans[i].viewpoint) {
        const Eigen::Vector3d way = scans[i].T_object_scan * *scans[i].viewpoint - place.at;
        place.free = way.norm();
        place.to_viewer = way / place.free;
      } else {
        place.free = kBlindReach * tolerance_;
        place.to_viewer = normals.col(vertex);
        if (!place.to_viewer.allFinite()) continue;  // of no triangle
      }
      places_[i].push_back(place);
    }
  });
}

void ConflictSearch::add(int other, const DistanceVolume& surface) {
  std::vector<std::optional<ScanConflict>> conflicts(places_.size());
  const Eigen::AlignedBox3d box = surface.box();
  parallel_for(places_.size(), [&](std::size_t scan) {
    if (scan == static_cast<std::size_t>(other)) return;
    std::size_t shared = 0;
    std::vector<double> depths;
    for (const Place& place : places_[scan]) {
      const Eigen::Vector3d at = (place.at - grid_.origin) / grid_.spacing;
      const GridIndex point = nearest_point(at);
      if (surface.find(point[0], point[1], point[2])) {
        ++shared;
        continue;
      }
      const std::optional<double> way =
          leaves_surface(surface, box, at, place.to_viewer, place.free / grid_.spacing);
      if (!way) continue;
      ++shared;
      depths.push_back(*way * grid_.spacing);
    }
    const double share = static_cast<double>(depths.size()) / static_cast<double>(shared);
    if (shared < kFewestShared || !(share > kLargestShare)) return;
    conflicts[scan] = {.scan = static_cast<int>(scan),
                       .other = other,
                       .share = share,
                       .depth = quantile(depths, 0.5)};
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
