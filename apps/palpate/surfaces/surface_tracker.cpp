// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/surface_tracker.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "palpate/geometry/error_statistics.h"

namespace palpate::apps {
namespace {

/// Of the vertices that face the camera, the fraction that lies on the measured surface.
double visible_fraction(const geometry::DeformedSurface& surface) {
  const auto with = [&](geometry::VertexSight sight) {
    return static_cast<double>(std::ranges::count(surface.sight, sight));
  };
  const double facing =
      static_cast<double>(surface.sight.size()) - with(geometry::VertexSight::turned_away);
  return facing > 0 ? with(geometry::VertexSight::seen) / facing : 0;
}

/// Median relative change in length of the edges whose triangles lie on the measured surface; 0 if
/// there is none.
double median_stretch(const Eigen::Matrix3Xi& triangles, const Eigen::Matrix3Xd& before,
                      const geometry::DeformedSurface& now) {
  std::vector<double> stretch;
  for (const auto& corners : triangles.colwise()) {
    if (!now.distance(corners).allFinite()) continue;
    for (int k = 0; k < 3; ++k) {
      const int a = corners[k];
      const int b = corners[(k + 1) % 3];
      const double length = (before.col(a) - before.col(b)).norm();
      if (length > 0)
        stretch.push_back((now.vertices.col(a) - now.vertices.col(b)).norm() / length - 1);
    }
  }
  return stretch.empty() ? 0 : geometry::error_statistics(std::move(stretch)).median;
}

/// The median where the surface is measured; 0 if it is nowhere.
double median_confidence(const geometry::DeformedSurface& surface) {
  const Eigen::VectorXd all = tracking_confidence(surface);
  std::vector<double> measured;
  for (std::size_t v = 0; v < surface.sight.size(); ++v) {
    if (surface.sight[v] == geometry::VertexSight::seen)
      measured.push_back(all[static_cast<Eigen::Index>(v)]);
  }
  return measured.empty() ? 0 : geometry::error_statistics(std::move(measured)).median;
}

}  // namespace

Eigen::VectorXd tracking_confidence(const geometry::DeformedSurface& surface) {
  return surface.confidence.cwiseProduct(surface.along);
}

SurfaceTracker::SurfaceTracker(const TrackingOptions& options, geometry::TriangleMesh reference)
    : options_(options), graph_(std::move(reference), options.graph) {}

void SurfaceTracker::start_from(std::vector<Eigen::Isometry3d> node_motions) {
  motions_ = std::move(node_motions);
}

TrackedFrame SurfaceTracker::track(const geometry::RangeMap& map) {
  surface_ = geometry::register_deformed(
      graph_, map, options_.registration,
      options_.from_reference ? std::span<const Eigen::Isometry3d>() : motions_);
  TrackedFrame frame;
  const geometry::ErrorStatistics error =
      geometry::error_statistics({surface_.distance.begin(), surface_.distance.end()});
  frame.rms = error.rms;
  frame.p95 = error.p95;
  frame.max = error.max;
  frame.measured = static_cast<double>(error.count) / static_cast<double>(surface_.sight.size());
  frame.visible = visible_fraction(surface_);
  frame.stretch = median_stretch(
      graph_.mesh().triangles,
      has_start() ? geometry::deformed_vertices(graph_, motions_) : graph_.mesh().vertices,
      surface_);
  frame.confidence = median_confidence(surface_);
  frame.iterations = surface_.iterations;
  frame.settled = surface_.stop == geometry::NonRigidStop::converged;
  if (frame.visible < options_.min_visible) {
    frame.lost = fmt::format(
        "{:.1f} % of the vertices that face the camera lie on the measured surface; at least "
        "{:g} % must (--min-visible)",
        100 * frame.visible, 100 * options_.min_visible);
  } else if (!has_start() && frame.stretch > options_.max_stretch * frame.visible) {
    frame.lost = fmt::format(
        "to lie on the measured surface it is stretched by {:.2g} % (median of its edges); as "
        "{:.0f} % of it is visible, at most {:.2g} % is expected (--max-stretch)",
        100 * frame.stretch, 100 * frame.visible, 100 * options_.max_stretch * frame.visible);
  } else {
    motions_ = surface_.node_motions;
  }
  return frame;
}

}  // namespace palpate::apps
