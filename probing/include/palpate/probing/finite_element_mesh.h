// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// A solid of quadratic tetrahedra. The nodes of an element are its corners 0 to 3 and the middles
/// of its edges 01, 12, 02, 03, 13, 23; corners 1, 2, 3 turn counterclockwise as seen from 0's
/// opposite side, so that volumes are positive.
struct FiniteElementMesh {
  Eigen::Matrix3Xd nodes;                           ///< 3 x N [mm]
  Eigen::Matrix<int, 10, Eigen::Dynamic> elements;  ///< 10 x E
  std::vector<int> regions;                         ///< E, 0 <= region
};

/// A block divided at the given coordinates [mm], each strictly increasing. Cells become six
/// tetrahedra each, mirrored from cell to cell so that no direction is preferred. Region 0.
/// \throws InvalidInput if coordinates do not increase, or fewer than two are given.
[[nodiscard]] FiniteElementMesh box_mesh(const std::vector<double>& x, const std::vector<double>& y,
                                         const std::vector<double>& z);

/// A ball whose boundary faces are curved. `cells` across its diameter, even. Region 0.
/// \throws InvalidInput unless radius > 0 [mm] and `cells` is even and >= 2.
[[nodiscard]] FiniteElementMesh ball_mesh(const Eigen::Vector3d& centre, double radius, int cells);

/// Reads the tetrahedra of a Gmsh file, ASCII, format 2.2 or 4.1; linear ones get straight middle
/// nodes. The region of an element is its first physical group or, without, 0. Other elements are
/// passed over, and nodes that no tetrahedron uses are dropped.
/// \throws FileError naming the line, what was found, and what would be right.
[[nodiscard]] FiniteElementMesh read_gmsh(const std::filesystem::path& path);

/// \throws InvalidInput naming the element or node, if an index is outside its range, a coordinate
/// is not finite, an element is inverted or flat, a node belongs to no element, or the mesh is so
/// small (below 1 mm across) that it seems to be in metres.
void check_finite_element_mesh(const FiniteElementMesh& mesh);

/// A face of the boundary: its corners turn outwards, then the middles of edges 01, 12, 20.
struct BoundaryFace {
  Eigen::Matrix<int, 6, 1> nodes;
  int element = 0;
};
[[nodiscard]] std::vector<BoundaryFace> boundary_faces(const FiniteElementMesh& mesh);

/// [mm^3] The volume, by the quadrature of the elements.
[[nodiscard]] double volume(const FiniteElementMesh& mesh);

}  // namespace palpate::probing
