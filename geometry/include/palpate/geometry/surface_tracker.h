// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <string>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/deformation_graph.h"
#include "palpate/geometry/nonrigid_registration.h"
#include "palpate/geometry/range_map.h"

namespace palpate::geometry {

/// Options for following a surface through range maps. `visit` describes the fields.
struct TrackingOptions {
  int nodes = DeformationGraphOptions{}.nodes;
  double stiffness = NonRigidOptions{}.stiffness;
  double hold = NonRigidOptions{}.hold;
  double reach = NonRigidOptions{}.max_correspondence;
  int iterations = NonRigidOptions{}.max_iterations;
  /// The visible part is right even if it is small: with 0 to 97 % of a moving surface hidden, its
  /// vertices were 0.1 to 0.8 mm from their true positions, the hidden ones 0.2 mm (10 %), 1.9 mm
  /// (30 %) and 3 to 11 mm (40 % and more).
  double min_visible = 0.3;
  /// A reference that lies elsewhere is stretched to fit the relief it meets, and part of it meets
  /// none: stretch / visible fraction was 0.018 to 0.15 for references 75 to 500 mm aside that were
  /// not found, and at most 0.005 for those within reach, with up to 70 % of them hidden; 0.012 for
  /// a flag that had waved by 9 mm. See docs/trade-geometry.md.
  double max_stretch = 0.015;
  bool from_reference = false;
};

void visit(TrackingOptions& options, FieldVisitor& visitor);

/// Figures of the fit of a surface to a range map.
struct TrackingFigures {
  double rms = 0;           ///< [mm] distances of measured vertices from the measured surface
  double p95 = 0;           ///< [mm]
  double max = 0;           ///< [mm]
  double measured = 0;      ///< fraction of all vertices that lie on the measured surface
  double visible = 0;       ///< the same of those that face the camera
  double stretch = 0;       ///< median relative change in edge length since the last tracked frame
  double sigma_across = 0;  ///< [mm] median where the surface is measured
  double sigma_along = 0;   ///< [mm] the same
  int iterations = 0;
  bool settled = false;  ///< the nodes had stopped moving before the iterations ended
};

/// A surface in one range map.
struct TrackedSurface {
  DeformedSurface surface;
  TrackingFigures figures;
  std::string lost;  ///< why the surface was not found; empty if it was. Check this first.
};

/// Follows a surface from range map to range map of one camera.
class SurfaceTracker {
 public:
  /// \param reference the surface at its pose in the first range map.
  /// \throws InvalidInput if an option is out of range, or the reference has no triangles.
  SurfaceTracker(const TrackingOptions& options, TriangleMesh reference);

  [[nodiscard]] const DeformationGraph& graph() const { return graph_; }

  /// Continues from a frame that was tracked earlier.
  void start_from(std::vector<Eigen::Isometry3d> node_motions);

  /// Returns true if a frame was found: the next one starts there.
  [[nodiscard]] bool has_start() const { return !motions_.empty(); }

  /// Finds the surface in a range map. If it is lost, the next frame starts where this one did.
  /// \param known vertices whose positions are known from other sources.
  /// \param image intensity of each pixel in any unit, NaN where unknown; empty if there is none.
  /// The first frame that is found with an image gives the texture of the surface, from which later
  /// frames show motion along the surface.
  /// \throws InvalidInput if the camera or a known vertex is not valid, or the image has not the
  /// size of the map.
  TrackedSurface track(const RangeMap& map, std::span<const KnownVertex> known = {},
                       const ImageF& image = {});

 private:
  TrackingOptions options_;
  DeformationGraph graph_;
  std::vector<Eigen::Isometry3d> motions_;
  VertexIntensities intensities_;  ///< no columns before a frame with an image was found
};

}  // namespace palpate::geometry
