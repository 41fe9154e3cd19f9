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
using DoubleLanes = Eigen::Array4d;

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

/// Four neighbouring triangles in single precision, to select those to be tested in double. All
/// coordinates are in the local frame of a mesh, where it fills [-1, 1].
struct TrianglePacket {
  static constexpr int kSize = 4;
  std::array<std::array<Lanes, 3>, 3> corner;  ///< [corner][axis]
  std::array<int, kSize> triangle;             ///< -1 if none; its lane then repeats a triangle
};

/// Copies the corners from `vertices`.
void set_corners(TrianglePacket& packet, const Eigen::Matrix3Xd& vertices,
                 const Eigen::Matrix3Xi& triangles);

/// Error bound of float arithmetic on coordinates up to 1: rounding a point to float costs half an
/// epsilon of its largest coordinate, and each further step adds a few roundings.
inline constexpr double kFloatMargin =
    16 * static_cast<double>(std::numeric_limits<float>::epsilon());

/// Lower bounds of the squared distances from a point to the triangles, up to an error of
/// `kFloatMargin` times (1 + largest coordinate of the point) in the distance. The bound is lower
/// for a triangle that is degenerate in single precision.
[[nodiscard]] Lanes squared_distances(const Eigen::Vector3f& point, const TrianglePacket& packet);

/// Lower bounds of the squared distances from a point to the triangles: to their boxes, up to a few
/// roundings in double. From far away these are close, and float bounds are of no use.
[[nodiscard]] DoubleLanes squared_distances(const Eigen::Vector3d& point,
                                            const TrianglePacket& packet);

/// Position of a segment relative to the triangles, lane by lane. Coordinates along the segment are
/// measured on its main axis, 0 at its start.
struct Passing {
  Lanes miss;   ///< > 0 if the segment stays farther than the margin from the triangle
  Lanes begin;  ///< lowest coordinate of the triangle along the segment
  Lanes end;    ///< highest coordinate of the triangle along the segment
};

/// A segment in single precision.
class SegmentLanes {
 public:
  /// \param margin at least kFloatMargin times the largest coordinate of mesh and segment.
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
