// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "image/image_part.h"
#include "image/image_plane.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "setup/carrier.h"

namespace palpate::sensing {

/// Standard deviations of depths that come from the rig's own uncertainty.
///
/// At a fixed pixel of camera and projector, the inverse depth w = 1 / z changes with a parameter p
/// of the rig by dw/dp = -(dx/dp) / (dx/dw), where x is the projector's coordinate along the
/// sinusoid, and its variance is g C g^T with the derivatives g and the rig's covariance C. It
/// varies slowly over the image and with w, so it is tabulated there, and interpolated linearly.
class RigDeviation {
 public:
  /// For images of rows x columns pixels, transposed if those of `carrier` are.
  /// \throws InvalidInput if the rig has a covariance, but the projector lights nothing that the
  /// camera sees.
  RigDeviation(const Rig& rig, Axis axis, const Carrier& carrier, long rows, long columns);

  /// Returns true if the rig has a covariance; if not, `add` must not be called.
  [[nodiscard]] bool is_known() const { return !table_.empty(); }

  /// Moves `sigma` [mm], the deviations of the depths `z` [mm] by noise, to `noise`, and sets
  /// `sigma` to the root of the sum of squares of both parts. NaN stays NaN.
  /// \param part of the image, to which z and sigma belong.
  void add(const Plane& z, const ImagePart& part, Plane& sigma, Plane& noise) const;

 private:
  void fill_nodes();  ///< those that the projector does not light, with the nearest one's values

  double first_ = 0;          ///< [1/mm] inverse depth of the first level
  double step_ = 0;           ///< [1/mm] between levels
  long rows_ = 0;             ///< nodes
  long columns_ = 0;          ///< nodes
  std::vector<float> table_;  ///< [1/mm^2] variances of w: rows x columns x levels
};

}  // namespace palpate::sensing
