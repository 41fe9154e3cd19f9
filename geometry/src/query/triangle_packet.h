// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include <Eigen/Core>
#include <array>
#include <limits>

#include "mesh/triangle_primitives.h"

namespace palpate::geometry {

/// One number for each of four triangles, in one register.
using Lanes = Eigen::Array4f;

/// Bit i is set iff a[i] <= b[i].
inline unsigned where_not_above(const Lanes& a, const Lanes& b) {
#ifdef __SSE2__
  return static_cast<unsigned>(
      _mm_movemask_ps(_mm_cmple_ps(_mm_load_ps(a.data()), _mm_load_ps(b.data()))));
#else
  unsigned bits = 0;
  for (int i = 0; i < 4; ++i) bits |= static_cast<unsigned>(a[i] <= b[i]) << i;
  return bits;
#endif
}

/// Four neighbouring triangles in single precision, to find out which of them are worth a look in
/// double. All coordinates are in the local frame of a mesh, where it fills [-1, 1].
struct TrianglePacket {
  static constexpr int kSize = 4;
  std::array<std::array<Lanes, 3>, 3> corner;  ///< [corner][axis]
  std::array<int, kSize> triangle;             ///< -1: none, and its lane repeats another triangle
};

/// Copies the corners from `vertices`.
void set_corners(TrianglePacket& packet, const Eigen::Matrix3Xd& vertices,
                 const Eigen::Matrix3Xi& triangles);

/// What float arithmetic on coordinates up to 1 may be off by: a point rounded to float is off by
/// half an epsilon of its largest coordinate, and each step after adds a few roundings.
inline constexpr double kFloatMargin =
    16 * static_cast<double>(std::numeric_limits<float>::epsilon());

/// Squared distances of a point to the triangles, not more than the true ones but for
/// `kFloatMargin` times (1 + largest coordinate of the point) on the distance; less for a triangle
/// that single precision cannot tell from a line.
[[nodiscard]] Lanes squared_distances(const Eigen::Vector3f& point, const TrianglePacket& packet);

/// How a segment passes the triangles: lane for lane, coordinates along the segment in the measure
/// of its main axis, 0 at its start.
struct Passing {
  Lanes miss;   ///< > 0: does not come nearer than the margin to the triangle
  Lanes begin;  ///< the triangle's lowest coordinate along the segment
  Lanes end;    ///< its highest
};

/// A segment in single precision.
class SegmentLanes {
 public:
  /// \param margin no less than kFloatMargin times the largest coordinate of mesh and segment.
  SegmentLanes(const Eigen::Vector3d& start, const ShearedSegment& segment, double margin);
  [[nodiscard]] Passing pass(const TrianglePacket& packet) const;
  [[nodiscard]] float margin() const { return margin_; }

 private:
  std::array<int, 3> axis_;
  Eigen::Vector3f start_;  ///< along the axes as ordered by `axis_`
  float shear_0_, shear_1_;
  float sign_;
  float margin_;
};

}  // namespace palpate::geometry
