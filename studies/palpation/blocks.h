// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/specimen.h"

namespace palpate::bench {

/// A soft block with a stiff inclusion below its upper side, which is at z = `kTop`. Both are of
/// square columns of elements, so that the outline of the inclusion is known exactly.
struct InclusionBlock {
  std::string name;
  std::shared_ptr<const probing::Specimen> specimen;
  /// Of each column, from x and y = -`kHalf` on: the part of the inclusion that it belongs to, from
  /// 1; 0: none.
  Eigen::MatrixXi part;
  int parts = 0;

  /// The part below a place; 0: none.
  [[nodiscard]] int part_at(double x, double y) const;
  /// [mm] 2 x N, along the outline, half a millimetre apart.
  [[nodiscard]] Eigen::Matrix2Xd outline() const;
};

inline constexpr double kTop = 700, kHalf = 24, kColumn = 4;  // [mm]
inline constexpr double kTipRadius = 4;                       // [mm]

/// Triangle, rectangle, circle and two circles.
[[nodiscard]] std::vector<InclusionBlock> inclusion_blocks();

/// The upper side, in squares of 1 mm whose corners do not lie on borders of columns.
[[nodiscard]] geometry::TriangleMesh upper_side();

}  // namespace palpate::bench
