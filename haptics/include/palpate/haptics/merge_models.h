// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// A model of one side of an object.
struct SideModel {
  Model model;
  Eigen::Isometry3d T_object_model = Eigen::Isometry3d::Identity();  ///< pose of the side
  std::string name = {};  ///< used in messages and in `Model::made`
};

enum class MergedSurface {
  zippered,  ///< measured vertices, joined by seams: `geometry::zipper_scans`
  averaged   ///< one smooth surface through all of them: `geometry::merge_scans`
};

/// `visit` describes the fields.
struct MergeModelsOptions {
  MergedSurface surface = MergedSurface::zippered;
  double fill_holes = 0;  ///< zippering may leave holes where seams meet
  double max_distance = 2;
  /// Contacts at one place press into the same half-space, and coinciding ones always count as one.
  /// The two sides of a thin wall are safe, since they press against each other; but if layers of a
  /// fold that face the same way are closer than this, choose a smaller value.
  std::optional<double> same_place = std::nullopt;
};

void visit(MergeModelsOptions& options, FieldVisitor& visitor);

/// A contact of one of the sides.
struct SideContact {
  int side = 0;      ///< index of the side
  long long id = 0;  ///< id in that side
};

struct LeftOutContact {
  SideContact contact;
  SideContact kept;  ///< the contact at the same place that was kept
};

struct MergedModel {
  Model model;                           ///< in the frame of the object
  std::vector<SideContact> source;       ///< of each contact, the contact of a side that it is
  std::vector<LeftOutContact> left_out;  ///< in the order of the sides
  std::vector<long long> isolated;       ///< ids of contacts in no triangle of contacts
  double same_place = 0;                 ///< [mm] value that was used
  double largest_distance = 0;           ///< [mm] of a contact from the merged surface
  int holes_filled = 0;
  /// Number of connected components of the merged surface; more than the object has means that
  /// sides do not overlap.
  int components = 0;
};

/// Merges models of single sides of one object into one model (thesis 6.2.3).
///
/// The surfaces are merged; the contacts are moved with their frames and friction axes, projected
/// onto the merged surface and triangulated there; their fields stay. Of contacts of different
/// sides at the same place the best fit is kept: least `rms`, then most samples, then the first
/// side. Further rules:
///
/// - Frames are rotated about their z axes so that neighbours across a seam agree. This changes no
///   contact's force, and makes the blended force continuous across seams.
/// - If any side blends compliances, the merged model does, recomputed from all contacts, with the
///   smallest reference force of those sides, since all of them were pressed that much.
/// - Everything except positions is `rounded`.
/// - Ids stay if they all differ; otherwise those of side k are increased by k times a common power
///   of ten. `Model::made` records where everything comes from.
/// - The merged model belongs to no acquisition: it has no registration, noise, fingerprint or
///   offsets.
/// - Sides with and without friction are merged as they are.
/// \throws InvalidInput if there is no side, `check_model` rejects one or its surface is not
/// manifold, a pose is not rigid and finite, an option is outside its range, a contact is farther
/// from the merged surface than `max_distance` or faces its inside, or fewer than three contacts
/// are left.
/// \throws SolverError as triangulation does, and Unavailable as `fill_holes` does.
[[nodiscard]] MergedModel merge_models(std::span<const SideModel> sides,
                                       const MergeModelsOptions& options = {});

}  // namespace palpate::haptics
