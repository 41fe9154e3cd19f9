// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/surface_tracker.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/geometry/error_statistics.h"

namespace palpate::geometry {
namespace {

/// Upper limits: a graph with more nodes cannot be solved, and no frame needs more steps.
constexpr int kMostNodes = 100000;
constexpr int kMostIterations = 10000;

/// Share of the vertices facing the camera that lie on the measured surface.
double visible_fraction(const DeformedSurface& surface) {
  const auto with = [&](VertexSight sight) {
    return static_cast<double>(std::ranges::count(surface.sight, sight));
  };
  const double facing = static_cast<double>(surface.sight.size()) - with(VertexSight::turned_away);
  return facing > 0 ? with(VertexSight::seen) / facing : 0;
}

/// Median relative change in length of the edges whose triangles lie on the measured surface; 0 if
/// there is none.
double median_stretch(const Eigen::Matrix3Xi& triangles, const Eigen::Matrix3Xd& before,
                      const DeformedSurface& now) {
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
  return stretch.empty() ? 0 : error_statistics(std::move(stretch)).median;
}

/// The median where the surface is measured; NaN if it is nowhere.
double median_where_seen(const Eigen::VectorXd& values, const std::vector<VertexSight>& sight) {
  std::vector<double> seen;
  for (std::size_t v = 0; v < sight.size(); ++v) {
    if (sight[v] == VertexSight::seen) seen.push_back(values[static_cast<Eigen::Index>(v)]);
  }
  return error_statistics(std::move(seen)).median;
}

TrackingFigures figures_of(const DeformedSurface& surface, const Eigen::Matrix3Xi& triangles,
                           const Eigen::Matrix3Xd& before) {
  const ErrorStatistics error =
      error_statistics({surface.distance.begin(), surface.distance.end()});
  return {.rms = error.rms,
          .p95 = error.p95,
          .max = error.max,
          .measured = static_cast<double>(error.count) / static_cast<double>(surface.sight.size()),
          .visible = visible_fraction(surface),
          .stretch = median_stretch(triangles, before, surface),
          .sigma_across = median_where_seen(surface.sigma_across, surface.sight),
          .sigma_along = median_where_seen(surface.sigma_along, surface.sight),
          .iterations = surface.iterations,
          .settled = surface.stop == NonRigidStop::converged};
}

/// The reason why the surface was not found; empty if it was.
std::string loss(const TrackingFigures& figures, const TrackingOptions& options, bool is_first) {
  if (figures.visible < options.min_visible) {
    return fmt::format(
        "{:.1f} % of the vertices that face the camera lie on the measured surface; at least "
        "{:g} % must (min_visible)",
        100 * figures.visible, 100 * options.min_visible);
  }
  const double limit = options.max_stretch * figures.visible;
  if (is_first && figures.stretch > limit) {
    return fmt::format(
        "to lie on the measured surface it is stretched by {:.2g} % (median of its edges); as "
        "{:.0f} % of it is visible, at most {:.2g} % is expected (max_stretch)",
        100 * figures.stretch, 100 * figures.visible, 100 * limit);
  }
  return {};
}

TriangleMesh with_triangles(TriangleMesh reference) {
  if (reference.triangles.cols() == 0)
    throw InvalidInput("SurfaceTracker(): the reference has no triangles");
  return reference;
}

NonRigidOptions registration_options(const TrackingOptions& options) {
  return {.max_iterations = options.iterations,
          .max_correspondence = options.reach,
          .stiffness = options.stiffness,
          .hold = options.hold,
          .min_matched = 0};  // `min_visible` decides instead
}

}  // namespace

void visit(TrackingOptions& options, FieldVisitor& visitor) {
  visitor.begin("TrackingOptions");
  visitor.whole({"nodes",
                 "Number of nodes that deform the surface; more follow smaller dents and take "
                 "longer"},
                options.nodes, at_least(1).at_most(kMostNodes));
  visitor.real({"stiffness",
                "Resistance of the surface to deformation: a low value follows small dents and "
                "noise, a high one bridges holes smoothly"},
               options.stiffness, above(0).finite());
  visitor.real(
      {"hold",
       "How strongly the surface is held at the reference, for an object that does not move "
       "as a whole: 0.001 to 0.01 keep a plane from sliding along itself; 0: not held"},
      options.hold, at_least(0).finite());
  visitor.real({"reach",
                "Largest distance of the surface from the reference in the first frame; from frame "
                "to frame it may move by about a third of it",
                "fraction of the reference's diagonal"},
               options.reach, at_least(NonRigidOptions{}.min_correspondence).at_most(1));
  visitor.whole({"iterations", "Largest number of registration steps per frame"},
                options.iterations, at_least(1).at_most(kMostIterations));
  visitor.real({"min_visible",
                "A frame is lost if a smaller fraction of the vertices that face the camera lies "
                "on the measured surface"},
               options.min_visible, at_least(0).at_most(1));
  visitor.real({"max_stretch",
                "The reference is refused if its edges must be stretched by more than this "
                "fraction (median), times its visible fraction, to lie on the first range map"},
               options.max_stretch, at_least(0).finite());
  visitor.flag({"from_reference",
                "Start every frame from the reference instead of the previous frame: errors do not "
                "accumulate, but the surface has to stay within the reach of the reference"},
               options.from_reference);
}

SurfaceTracker::SurfaceTracker(const TrackingOptions& options, TriangleMesh reference)
    : options_(in_range(options)),
      graph_(with_triangles(std::move(reference)), {.nodes = options.nodes}) {}

void SurfaceTracker::start_from(std::vector<Eigen::Isometry3d> node_motions) {
  motions_ = std::move(node_motions);
}

TrackedSurface SurfaceTracker::track(const RangeMap& map, std::span<const KnownVertex> known,
                                     const ImageF& image) {
  const bool has_texture = image.size() > 0 && intensities_.cols() > 0;
  TrackedSurface found{
      .surface = register_deformed(
          graph_, map, registration_options(options_),
          options_.from_reference ? std::span<const Eigen::Isometry3d>() : motions_, known,
          has_texture ? SeenIntensities{image, intensities_} : SeenIntensities()),
      .figures = {},
      .lost = {}};
  found.figures =
      figures_of(found.surface, graph_.mesh().triangles,
                 has_start() ? deformed_vertices(graph_, motions_) : graph_.mesh().vertices);
  found.lost = loss(found.figures, options_, !has_start());
  if (!found.lost.empty()) return found;
  motions_ = found.surface.node_motions;
  if (image.size() > 0 && !has_texture)
    intensities_ = vertex_intensities(map.camera, image, found.surface);
  return found;
}

}  // namespace palpate::geometry
