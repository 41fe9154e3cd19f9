// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// A model of one side of an object.
struct SideModel {
  Model model;
  Eigen::Isometry3d T_object_model = Eigen::Isometry3d::Identity();  ///< where the side belongs
  std::string name = {};  ///< for messages, and for `Model::made`
};

enum class MergedSurface {
  zippered,  ///< measured vertices, joined by seams: `geometry::zipper_scans`
  averaged   ///< one smooth surface through all of them: `geometry::merge_scans`
};

struct MergeModelsOptions {
  MergedSurface surface = MergedSurface::zippered;
  /// [mm] border loops of the merged surface up to so wide are filled, as zippering may leave some
  /// where seams meet; >= 0, 0 fills none
  double fill_holes = 0;
  double max_distance = 2;  ///< [mm] of any contact from the merged surface; >= 0
  /// [mm] contacts of different sides are one iff they, once on the merged surface, are at most so
  /// far apart in a straight line and press into the same half-space; >= 0. Without one it is a
  /// quarter of the median distance between neighbouring contacts. Contacts that coincide are one
  /// in any case. The two sides of a thin wall press against each other; but of layers of a fold
  /// that face the same way, nearer to each other than this, contacts are taken for one: give less.
  std::optional<double> same_place = std::nullopt;
};

/// A contact of one of the sides.
struct SideContact {
  int side = 0;      ///< index
  long long id = 0;  ///< there
};

struct LeftOutContact {
  SideContact contact;
  SideContact kept;  ///< that it fell on
};

struct MergedModel {
  Model model;                           ///< in the frame of the object
  std::vector<SideContact> source;       ///< of each contact, the contact of a side that it is
  std::vector<LeftOutContact> left_out;  ///< in the order of the sides
  std::vector<long long> isolated;       ///< ids of contacts in no triangle of contacts
  double same_place = 0;                 ///< [mm] that was used
  double largest_distance = 0;           ///< [mm] of a contact from the merged surface
  int holes_filled = 0;
  /// Of the merged surface; more than those of an object say that sides do not overlap.
  int components = 0;
};

/// Makes one model of single-sided models of one object (thesis 6.2.3).
///
/// The surfaces are merged, the contacts are moved along with frames and axes of friction, put on
/// the nearest place of the merged surface and triangulated there anew; their fields stay. Of
/// contacts of different sides at the same place the one that fits best is kept: with the least
/// `rms`, then with the most samples, then of the first side. The frames are turned about their z
/// axes so that neighbours across a seam agree, which changes no contact's force; the blended force
/// is then continuous across seams as it is elsewhere. If any side blends compliances the model
/// does, learnt anew from all contacts, under the least reference force of those sides: with that
/// much they were all pressed. All but places is `rounded`. Where all ids differ they stay;
/// otherwise those of side k are raised by k times the same power of ten. `Model::made` says what
/// came from where. Sides of which one has friction and one none are merged as they are.
/// \throws InvalidInput if there is no side, one is refused by `check_model` or its surface is not
/// manifold, a pose is not a rotation and a finite shift, an option is out of its range, a contact
/// is further from the merged surface than `max_distance` or faces its inside, or fewer than three
/// contacts are left; SolverError and Unavailable as merging and triangulating do.
[[nodiscard]] MergedModel merge_models(std::span<const SideModel> sides,
                                       const MergeModelsOptions& options = {});

}  // namespace palpate::haptics
