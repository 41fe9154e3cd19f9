// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Weights of contacts at a place of the surface. Three contacts have weight if the surface's
/// triangle lies inside one triangle of contacts, four if it crosses an edge between two; each of
/// its corners has at most three.
struct ContactWeights {
  static constexpr int kMaxCount = 9;
  int count = 0;                            ///< 0 if no contact has influence, or no such place
  std::array<int, kMaxCount> contacts{};    ///< the first `count`: all different
  std::array<double, kMaxCount> weights{};  ///< the first `count`: >= 0, sum to 1
};

/// Computes the weights of contacts at any place of a surface. The weights are linear in each
/// triangle between those of its corners, and hence continuous. A triangle that contains contacts
/// is subdivided at them, so that each contact has weight one at its own place. Thread-safe, does
/// not allocate, does not throw.
class ContactLocator {
 public:
  /// A contact whose `triangle` is -1 is not on the surface and is ignored.
  /// \throws InvalidInput if the mesh or a place is not valid, if the weights are not those of the
  /// mesh's vertices, or, naming the vertex, if a weight is negative, not finite, or of a contact
  /// that does not exist.
  ContactLocator(const TriangleMesh& surface, std::span<const SurfacePoint> contacts,
                 const SurfaceWeights& weights);

  [[nodiscard]] ContactWeights locate(const SurfacePoint& at) const noexcept;

 private:
  struct Row {
    std::array<double, 3> weights;
    std::array<int, 3> contacts;  ///< -1 for no (further) contact
  };
  /// A part of a triangle that is subdivided at contacts.
  struct Piece {
    std::array<int, 3> rows;
    Eigen::Matrix3d from_triangle;  ///< maps barycentric coordinates
  };
  struct Triangle {
    std::array<int, 3> rows;
    int first_piece;  ///< -1 if not subdivided
  };

  void cut(int triangle, std::span<const SurfacePoint> contacts, std::span<const int> inside);

  std::vector<Row> rows_;  ///< first those of vertices, then those of contacts
  std::vector<Triangle> triangles_;
  std::vector<Piece> pieces_;  ///< grouped by triangle
  std::vector<int> end_;       ///< by first piece: end of the pieces of its triangle
};

}  // namespace palpate::geometry
