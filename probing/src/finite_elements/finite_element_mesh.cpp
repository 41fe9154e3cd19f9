// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/finite_element_mesh.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "finite_elements/finite_element_tools.h"
#include "finite_elements/quadratic_tetrahedron.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::probing {
namespace {

constexpr double kLeastExtent = 1;      // [mm] across; smaller meshes seem to be in metres
constexpr double kLeastQuality = 1e-3;  // of the Jacobian, relative to its mean: flatter elements
                                        // are refused
constexpr int kFaceCorners[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

int edge_node(int a, int b) {
  constexpr int kNodes[4][4] = {{-1, 4, 6, 7}, {4, -1, 5, 8}, {6, 5, -1, 9}, {7, 8, 9, -1}};
  return kNodes[a][b];
}

struct Grid {
  std::array<int, 3> cells;
  int node(int i, int j, int k) const { return i + (cells[0] + 1) * (j + (cells[1] + 1) * k); }
};

// The six tetrahedra of each cell, around the diagonal from one of its corners to the opposite one
// (Kuhn 1960). `mirrored(axis, index)` tells whether that corner lies on the upper side.
template <typename Mirrored>
std::vector<std::array<int, 4>> grid_tetrahedra(const Grid& grid, const Mirrored& mirrored) {
  constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  std::vector<std::array<int, 4>> result;
  std::array<int, 3> cell{};
  for (cell[2] = 0; cell[2] < grid.cells[2]; ++cell[2]) {
    for (cell[1] = 0; cell[1] < grid.cells[1]; ++cell[1]) {
      for (cell[0] = 0; cell[0] < grid.cells[0]; ++cell[0]) {
        std::array<int, 3> start = cell, step{1, 1, 1};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          if (!mirrored(static_cast<int>(axis), cell[axis])) continue;
          ++start[axis];
          step[axis] = -1;
        }
        for (const auto& order : kOrders) {
          std::array<int, 3> at = start;
          std::array<int, 4> corners{grid.node(at[0], at[1], at[2])};
          for (std::size_t k = 0; k < 3; ++k) {
            const auto axis = static_cast<std::size_t>(order[k]);
            at[axis] += step[axis];
            corners[k + 1] = grid.node(at[0], at[1], at[2]);
          }
          result.push_back(corners);
        }
      }
    }
  }
  return result;
}

double signed_volume(const Eigen::Matrix3Xd& nodes, const std::array<int, 4>& t) {
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k)
    edges.col(k) = nodes.col(t[static_cast<std::size_t>(k) + 1]) - nodes.col(t[0]);
  return edges.determinant() / 6;
}

void check_increasing(const char* name, const std::vector<double>& coordinates) {
  if (coordinates.size() < 2) {
    throw InvalidInput(std::string("box_mesh(): ") + name + " has " +
                       std::to_string(coordinates.size()) + " coordinates; it must have 2 or more");
  }
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    if (std::isfinite(coordinates[i]) && (i == 0 || coordinates[i] > coordinates[i - 1])) continue;
    throw InvalidInput(std::string("box_mesh(): ") + name + "[" + std::to_string(i) + "] is " +
                       std::to_string(coordinates[i]) +
                       " mm; coordinates must be finite and increase strictly");
  }
}

std::string element_name(Eigen::Index e) { return "element " + std::to_string(e); }

}  // namespace

FiniteElementMesh with_middle_nodes(const Eigen::Matrix3Xd& corners,
                                    const std::vector<std::array<int, 4>>& tetrahedra) {
  FiniteElementMesh mesh;
  mesh.elements.resize(10, static_cast<Eigen::Index>(tetrahedra.size()));
  mesh.regions.assign(tetrahedra.size(), 0);
  std::map<std::pair<int, int>, int> middles;
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    std::array<int, 4> t = tetrahedra[e];
    if (signed_volume(corners, t) < 0) std::swap(t[2], t[3]);
    auto element = mesh.elements.col(static_cast<Eigen::Index>(e));
    for (int a = 0; a < 4; ++a) {
      element[a] = t[static_cast<std::size_t>(a)];
      for (int b = 0; b < a; ++b) {
        const int m = t[static_cast<std::size_t>(a)], n = t[static_cast<std::size_t>(b)];
        const int next = static_cast<int>(corners.cols()) + static_cast<int>(middles.size());
        element[edge_node(a, b)] = middles.try_emplace(std::minmax(m, n), next).first->second;
      }
    }
  }
  mesh.nodes.resize(3, corners.cols() + static_cast<Eigen::Index>(middles.size()));
  mesh.nodes.leftCols(corners.cols()) = corners;
  for (const auto& [ends, node] : middles) {
    mesh.nodes.col(node) = (corners.col(ends.first) + corners.col(ends.second)) / 2;
  }
  return mesh;
}

FiniteElementMesh box_mesh(const std::vector<double>& x, const std::vector<double>& y,
                           const std::vector<double>& z) {
  check_increasing("x", x);
  check_increasing("y", y);
  check_increasing("z", z);
  const Grid grid{{static_cast<int>(x.size()) - 1, static_cast<int>(y.size()) - 1,
                   static_cast<int>(z.size()) - 1}};
  Eigen::Matrix3Xd corners(3, static_cast<Eigen::Index>(x.size() * y.size() * z.size()));
  Eigen::Index node = 0;
  for (const double zk : z)
    for (const double yj : y)
      for (const double xi : x) corners.col(node++) << xi, yj, zk;
  return with_middle_nodes(
      corners, grid_tetrahedra(grid, [](int /*axis*/, int index) { return index % 2 == 1; }));
}

FiniteElementMesh ball_mesh(const Eigen::Vector3d& centre, double radius, int cells) {
  require("ball_mesh(): centre", centre.sum(), finite(), "mm");
  require("ball_mesh(): radius", radius, above(0).finite(), "mm");
  require("ball_mesh(): cells", cells, at_least(2));
  if (cells % 2 != 0) {
    throw InvalidInput("ball_mesh(): cells is " + std::to_string(cells) + "; it must be even");
  }
  const Grid grid{{cells, cells, cells}};
  const int row = cells + 1;
  Eigen::Matrix3Xd corners(3, row * row * row);
  std::vector<bool> outside(static_cast<std::size_t>(corners.cols()));
  for (int k = 0; k < row; ++k) {
    for (int j = 0; j < row; ++j) {
      for (int i = 0; i < row; ++i) {
        const Eigen::Vector3d cube = (2 * Eigen::Vector3d(i, j, k) / cells).array() - 1;
        const Eigen::Vector3d square = cube.cwiseAbs2();
        // From a cube to a ball, shells to shells.
        Eigen::Vector3d ball;
        for (int a = 0; a < 3; ++a) {
          const double u = square[(a + 1) % 3], v = square[(a + 2) % 3];
          ball[a] = cube[a] * std::sqrt(1 - u / 2 - v / 2 + u * v / 3);
        }
        corners.col(grid.node(i, j, k)) = radius * ball;
        outside[static_cast<std::size_t>(grid.node(i, j, k))] =
            std::min({i, j, k}) == 0 || std::max({i, j, k}) == cells;
      }
    }
  }
  // Diagonals point away from the centre, so that no element has two faces on the boundary.
  FiniteElementMesh mesh = with_middle_nodes(
      corners, grid_tetrahedra(grid, [&](int /*axis*/, int index) { return index < cells / 2; }));
  for (const BoundaryFace& face : boundary_faces(mesh)) {
    for (int k = 3; k < 6; ++k) mesh.nodes.col(face.nodes[k]).normalize();
    for (int k = 3; k < 6; ++k) mesh.nodes.col(face.nodes[k]) *= radius;
  }
  mesh.nodes.colwise() += centre;
  return mesh;
}

ElementNodes element_nodes(const FiniteElementMesh& mesh, const Eigen::Matrix3Xd& positions,
                           Eigen::Index element) {
  ElementNodes result;
  for (int a = 0; a < 10; ++a) result.col(a) = positions.col(mesh.elements(a, element));
  return result;
}

void check_finite_element_mesh(const FiniteElementMesh& mesh) {
  if (mesh.elements.cols() == 0) {
    throw InvalidInput("FiniteElementMesh has no elements; it must have at least one tetrahedron");
  }
  if (mesh.regions.size() != static_cast<std::size_t>(mesh.elements.cols())) {
    throw InvalidInput("FiniteElementMesh::regions has " + std::to_string(mesh.regions.size()) +
                       " entries; it must have one for each of the " +
                       std::to_string(mesh.elements.cols()) + " elements");
  }
  for (Eigen::Index n = 0; n < mesh.nodes.cols(); ++n) {
    if (mesh.nodes.col(n).allFinite()) continue;
    throw InvalidInput("node " + std::to_string(n) + " is not finite");
  }
  std::vector<bool> used(static_cast<std::size_t>(mesh.nodes.cols()), false);
  for (Eigen::Index e = 0; e < mesh.elements.cols(); ++e) {
    for (const int node : mesh.elements.col(e)) {
      if (node < 0 || node >= mesh.nodes.cols()) {
        throw InvalidInput(element_name(e) + " has node " + std::to_string(node) + "; there are " +
                           std::to_string(mesh.nodes.cols()));
      }
      used[static_cast<std::size_t>(node)] = true;
    }
    if (mesh.regions[static_cast<std::size_t>(e)] < 0) {
      throw InvalidInput(element_name(e) + " has region " +
                         std::to_string(mesh.regions[static_cast<std::size_t>(e)]) +
                         "; it must be >= 0");
    }
    const double quality = shape_quality(element_nodes(mesh, mesh.nodes, e));
    if (!(quality >= kLeastQuality)) {
      throw InvalidInput(element_name(e) + " is inverted or flat (its least Jacobian is " +
                         std::to_string(quality) + " of the mean); mesh the object again");
    }
  }
  const auto lost = std::find(used.begin(), used.end(), false);
  if (lost != used.end()) {
    throw InvalidInput("node " + std::to_string(lost - used.begin()) +
                       " belongs to no element; remove it");
  }
  const Eigen::Vector3d extent = mesh.nodes.rowwise().maxCoeff() - mesh.nodes.rowwise().minCoeff();
  if (extent.norm() < kLeastExtent) {
    throw InvalidInput("the mesh is " + std::to_string(extent.norm()) +
                       " mm across; it seems to be in metres: multiply its coordinates by 1000");
  }
}

std::vector<BoundaryFace> boundary_faces(const FiniteElementMesh& mesh) {
  std::map<std::array<int, 3>, std::pair<BoundaryFace, int>> faces;
  for (Eigen::Index e = 0; e < mesh.elements.cols(); ++e) {
    const auto element = mesh.elements.col(e);
    for (const auto& corners : kFaceCorners) {
      BoundaryFace face;
      face.element = static_cast<int>(e);
      std::array<int, 3> key{};
      for (int k = 0; k < 3; ++k) {
        key[static_cast<std::size_t>(k)] = face.nodes[k] = element[corners[k]];
        face.nodes[3 + k] = element[edge_node(corners[k], corners[(k + 1) % 3])];
      }
      std::sort(key.begin(), key.end());
      ++faces.try_emplace(key, face, 0).first->second.second;
    }
  }
  std::vector<BoundaryFace> result;
  for (const auto& [key, found] : faces) {
    if (found.second == 1) result.push_back(found.first);
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.element < b.element; });
  return result;
}

double volume(const FiniteElementMesh& mesh) {
  double sum = 0;
  for (Eigen::Index e = 0; e < mesh.elements.cols(); ++e) {
    for (const TetrahedronPoint& point : tetrahedron_points(element_nodes(mesh, mesh.nodes, e)))
      sum += point.weight;
  }
  return sum;
}

}  // namespace palpate::probing
