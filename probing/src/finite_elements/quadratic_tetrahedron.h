// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "palpate/probing/hyperelastic.h"

// The element with ten nodes. The isochoric stress is integrated at four points; the volumetric one
// follows from the mean ratio of volumes of the element (mean dilatation: Nagtegaal, Parks and Rice
// 1974), so that nearly incompressible materials do not lock.
namespace palpate::probing {

using ElementNodes = Eigen::Matrix<double, 3, 10>;    // a column is a node
using ElementMatrix = Eigen::Matrix<double, 30, 30>;  // unknown 3 a + i: direction i of node a

struct TetrahedronPoint {
  ElementNodes gradients;  // [1/mm] of the shape functions by undeformed coordinates
  double weight = 0;       // [mm^3] of undeformed volume; <= 0 if the element is inverted there
};
using TetrahedronPoints = std::array<TetrahedronPoint, 4>;

[[nodiscard]] TetrahedronPoints tetrahedron_points(const ElementNodes& nodes);

// The same, the four points side by side, so that their forces are computed together.
struct PackedPoints {
  using Lanes = Eigen::Array4d;  // a number of each point

  PackedPoints(
      const TetrahedronPoints& points);  // NOLINT(*-explicit-*): another layout of the same

  std::array<std::array<Lanes, 3>, 10> gradients;  // of each node, by each coordinate
  Lanes weights;
};

// The ten shape functions at a place given by its barycentric coordinates.
[[nodiscard]] Eigen::Matrix<double, 10, 1> shape_functions(const Eigen::Vector4d& place);

// The corners of each edge's middle node, in the order of the nodes 4 to 9.
inline constexpr int kEdgeCorners[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

// The least ratio of the Jacobian at the nodes and the points to its mean; <= 0 if inverted.
[[nodiscard]] double shape_quality(const ElementNodes& nodes);

struct ElementForce {
  ElementNodes force;  // [N] the derivative of the energy
  double energy = 0;   // [N mm]
  bool valid = false;  // all volumes are positive; if not, force and energy mean nothing
};
[[nodiscard]] ElementForce element_force(const PackedPoints& points, const Hyperelastic& material,
                                         const ElementNodes& positions);

// [N/mm] The derivative of the force, symmetric. The volumes must be positive.
[[nodiscard]] ElementMatrix element_tangent(const TetrahedronPoints& points,
                                            const Hyperelastic& material,
                                            const ElementNodes& positions);

}  // namespace palpate::probing
