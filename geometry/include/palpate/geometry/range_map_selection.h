// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/cloud_shapes.h"
#include "palpate/geometry/eigen_alignment.h"
#include "palpate/geometry/range_map.h"
#include "palpate/geometry/range_map_score.h"

namespace palpate::geometry {

/// Options that select depths of a range map: those of the object, without its background. `visit`
/// describes the fields.
struct RangeMapSelectionOptions {
  std::optional<double> near = {};  ///< [mm] nearer depths are left out; > 0
  std::optional<double> far = {};   ///< [mm] farther depths are left out; > 0
  /// [mm] Boxes in the frame of the camera; points outside all of them are left out. Without any,
  /// there is no limit.
  std::vector<Eigen::AlignedBox3d> crop = {};
  /// [mm] The largest plane in front of the camera, such as a table, is left out: points at most
  /// this far in front of it, and all behind it; > 0. About three standard deviations of the noise.
  std::optional<double> remove_plane = {};
};
void visit(RangeMapSelectionOptions& options, FieldVisitor& visitor);

/// \throws InvalidInput if an option is outside its range, near is not < far, or a box has no
/// extent.
void check_selection(const RangeMapSelectionOptions& options);

/// Returns true if the options can leave out a depth.
[[nodiscard]] bool selects(const RangeMapSelectionOptions& options);

/// A plane is removed if it has at least this share of the points that the other options keep.
inline constexpr double kLeastPlane = 0.1;

/// The depths that are kept, and how many pixels each option has left out. An option does not count
/// pixels that an earlier one has left out: near, far, crop, mask, plane.
struct RangeMapSelection {
  ImageF z = {};                   ///< [mm] NaN where unknown or left out
  long known = 0;                  ///< pixels with a depth before the selection
  long kept = 0;                   ///< pixels of `z` with a depth
  long too_near = 0, too_far = 0;  ///< pixels
  long outside_crop = 0;           ///< pixels
  long masked = 0;                 ///< pixels
  /// Pixels without a viewing ray, by the lens distortion; they are left out with a plane.
  long without_ray = 0;
  long on_plane = 0;                 ///< pixels on the plane or behind it
  double nearest = 0, farthest = 0;  ///< [mm] of all known depths; NaN if there are none
  /// The plane that was removed, without inliers; its normal points to the camera.
  std::optional<CloudPlane> plane = {};
};

/// Selects depths. A plane is found in at most 20,000 of the points, evenly spread over the image.
/// \param mask of the size of `map`; pixels outside it are left out. Empty: no limit.
/// \throws InvalidInput as `check_selection` does, if the mask has another size, or if the camera is
/// not valid.
[[nodiscard]] RangeMapSelection select_depths(const RangeMap& map,
                                              const RangeMapSelectionOptions& options,
                                              const PixelMask& mask = {});

}  // namespace palpate::geometry
