// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "palpate/geometry/nonrigid_registration.h"
#include "palpate/geometry/range_map.h"
#include "surfaces/track_record.h"

namespace palpate::apps {

struct TrackingOptions {
  geometry::DeformationGraphOptions graph;
  geometry::NonRigidOptions registration{.min_matched = 0};  ///< `min_visible` decides instead
  /// A frame is lost if a smaller fraction of the vertices that face the camera lies on the
  /// measured surface: it is then mostly a guess. The visible part is right however little there
  /// is: with 0 to 97 % of a moving surface hidden, its vertices were 0.1 to 0.8 mm from their true
  /// positions, the hidden ones 0.2 mm (10 %), 1.9 mm (30 %) and 3 to 11 mm (40 % and more).
  double min_visible = 0.3;
  /// Largest median stretch of the reference in the first frame, divided by the visible fraction. A
  /// reference that lies elsewhere is stretched to fit the relief it meets, and part of it meets
  /// none: the ratio was 0.018 to 0.15 for references 75 to 500 mm aside that were not found, and
  /// at most 0.005 for those within reach, with up to 70 % of them hidden; 0.012 for a flag that
  /// had waved by 9 mm. See docs/trade-geometry.md.
  double max_stretch = 0.015;
  bool from_reference = false;  ///< start every frame from the reference, not the previous frame
};

/// V, in [0, 1]: how far the range map determines where a vertex is, across the surface and along
/// it.
[[nodiscard]] Eigen::VectorXd tracking_confidence(const geometry::DeformedSurface& surface);

/// Follows a surface from range map to range map.
class SurfaceTracker {
 public:
  SurfaceTracker(const TrackingOptions& options, geometry::TriangleMesh reference);

  [[nodiscard]] const geometry::DeformationGraph& graph() const { return graph_; }
  /// The surface in the frame that was tracked last, lost or not.
  [[nodiscard]] const geometry::DeformedSurface& surface() const { return surface_; }

  /// Continues from a frame that an earlier run has tracked.
  void start_from(std::vector<Eigen::Isometry3d> node_motions);

  /// Whether a frame was found: the next one starts there.
  [[nodiscard]] bool has_start() const { return !motions_.empty(); }

  /// Finds the surface in a range map. If it is lost, the next frame starts where this one did.
  /// \returns the figures of the frame; the caller adds the name and the fingerprint of its file.
  TrackedFrame track(const geometry::RangeMap& map);

 private:
  TrackingOptions options_;
  geometry::DeformationGraph graph_;
  std::vector<Eigen::Isometry3d> motions_;
  geometry::DeformedSurface surface_;
};

}  // namespace palpate::apps
