// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace palpate::geometry {

/// A piece with more corners is parted before it is cut or halved.
inline constexpr int kMostToCut = 10;

/// A piece that is convex has one corner more after it is cut. One that is not, by rounding, has at
/// most half as many more.
inline constexpr int kMostPieceCorners = kMostToCut + kMostToCut / 2;

/// A convex part of one triangle, and the triangle of the target that it is compared with.
struct DistancePiece {
  std::array<Eigen::Vector3d, kMostPieceCorners> corners;
  int count = 0;
  int triangle = -1;   ///< -1 if not known yet
  int cuts = 0;        ///< since the last halving
  bool asked = false;  ///< `triangle` is the one nearest to the centre

  void add(const Eigen::Vector3d& corner) { corners[static_cast<std::size_t>(count++)] = corner; }
  [[nodiscard]] const Eigen::Vector3d& corner(int i) const {
    return corners[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] Eigen::Vector3d centre() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < count; ++i) sum += corner(i) - corner(0);
    return corner(0) + sum / count;
  }
  /// Upper bound of the distance of the piece's points from `point`.
  [[nodiscard]] double reach(const Eigen::Vector3d& point) const {
    double squared = 0;
    for (int i = 0; i < count; ++i) squared = std::max(squared, (corner(i) - point).squaredNorm());
    return std::sqrt(squared);
  }
};

struct CutLine {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;  ///< unit length
};

/// The parts of a piece on both sides of a plane. Corners within `on_line` [mm] of it belong to
/// both.
inline std::pair<DistancePiece, DistancePiece> cut_in_two(const DistancePiece& piece,
                                                          const CutLine& line, double on_line) {
  std::array<double, kMostPieceCorners> side{};
  for (int i = 0; i < piece.count; ++i) {
    side[static_cast<std::size_t>(i)] = (piece.corner(i) - line.point).dot(line.normal);
  }
  DistancePiece before, behind;
  before.triangle = behind.triangle = piece.triangle;
  const int sides = piece.count == 2 ? 1 : piece.count;  // a line has only one side
  for (int i = 0; i < piece.count; ++i) {
    const int j = (i + 1) % piece.count;
    const double here = side[static_cast<std::size_t>(i)];
    const double there = side[static_cast<std::size_t>(j)];
    if (here >= -on_line) before.add(piece.corner(i));
    if (here <= on_line) behind.add(piece.corner(i));
    const bool crosses =
        (here > on_line && there < -on_line) || (here < -on_line && there > on_line);
    if (crosses && i < sides) {
      const Eigen::Vector3d crossing =
          piece.corner(i) + here / (here - there) * (piece.corner(j) - piece.corner(i));
      before.add(crossing);
      behind.add(crossing);
    }
  }
  return {before, behind};
}

}  // namespace palpate::geometry
