// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Weights of the contacts at a place of the surface: of three where the surface's triangle lies in
/// one triangle of contacts, of four where it lies across an edge between two; never of more than
/// three at each of its corners.
struct ContactWeights {
  static constexpr int kMaxCount = 9;
  int count = 0;                            ///< 0 = no contact has influence, or no such place
  std::array<int, kMaxCount> contacts{};    ///< the first `count`: all different
  std::array<double, kMaxCount> weights{};  ///< the first `count`: >= 0, sum to 1
};

/// Weights of contacts at any place of the surface, linear in each of its triangles between the
/// weights of its corners, and so continuous. A triangle that contacts lie in is cut at them, so
/// that each has weight one at its own place. Thread-safe, does not allocate, does not throw.
class ContactLocator {
 public:
  /// A contact whose `triangle` is -1 is not on the surface: nothing is cut for it.
  /// \throws InvalidInput on a bad mesh, a bad place, weights that are not those of the mesh's
  /// vertices, or naming the vertex where one is negative or not finite, or of no contact.
  ContactLocator(const TriangleMesh& surface, std::span<const SurfacePoint> contacts,
                 const SurfaceWeights& weights);

  [[nodiscard]] ContactWeights locate(const SurfacePoint& at) const noexcept;

 private:
  struct Row {
    std::array<double, 3> weights;
    std::array<int, 3> contacts;  ///< -1 = no (further) contact
  };
  /// A part of a triangle between contacts and corners.
  struct Piece {
    std::array<int, 3> rows;
    Eigen::Matrix3d from_triangle;  ///< maps barycentric coordinates
  };
  struct Triangle {
    std::array<int, 3> rows;
    int first_piece;  ///< -1 = in one piece
  };

  void cut(int triangle, std::span<const SurfacePoint> contacts, std::span<const int> inside);

  std::vector<Row> rows_;  ///< of vertices, then of contacts
  std::vector<Triangle> triangles_;
  std::vector<Piece> pieces_;  ///< of one triangle after the other
  std::vector<int> end_;       ///< by first piece: where those of its triangle end
};

}  // namespace palpate::geometry
