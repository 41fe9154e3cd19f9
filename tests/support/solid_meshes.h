// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "finite_elements/quadratic_tetrahedron.h"
#include "palpate/probing/contact_equilibrium.h"

// Solids of finite elements whose answers are known. Lengths in mm.
namespace palpate::support {

/// Coordinates that divide a length evenly.
inline std::vector<double> evenly(double from, double to, int cells) {
  std::vector<double> result;
  for (int i = 0; i <= cells; ++i) result.push_back(from + (to - from) * i / cells);
  return result;
}

/// Holds the nodes whose undeformed places fulfil `condition`.
template <typename Condition>
void support_where(probing::DeformableBody& body, const Condition& condition) {
  for (int n = 0; n < body.mesh.nodes.cols(); ++n)
    if (condition(Eigen::Vector3d(body.mesh.nodes.col(n)))) body.supported.push_back(n);
}

/// Moves the supported nodes by `motion` of their undeformed places.
template <typename Motion>
void move_supports(probing::DeformableBody& body, const Motion& motion) {
  body.support_moves.resize(3, static_cast<Eigen::Index>(body.supported.size()));
  for (std::size_t k = 0; k < body.supported.size(); ++k)
    body.support_moves.col(static_cast<Eigen::Index>(k)) =
        motion(Eigen::Vector3d(body.mesh.nodes.col(body.supported[k])));
}

/// One mesh of several whose nodes coincide where they meet, to a millionth of a millimetre.
class JoinedMesh {
 public:
  void add(const probing::FiniteElementMesh& part) {
    constexpr double kPlaces = 1e6;  // [1/mm]
    std::vector<int> node_of(static_cast<std::size_t>(part.nodes.cols()));
    for (Eigen::Index n = 0; n < part.nodes.cols(); ++n) {
      std::array<long long, 3> key{};
      for (std::size_t i = 0; i < 3; ++i)
        key[i] = std::llround(kPlaces * part.nodes(static_cast<Eigen::Index>(i), n));
      const auto [known, added] = nodes_of_place_.try_emplace(key, static_cast<int>(nodes_.size()));
      if (added) nodes_.emplace_back(part.nodes.col(n));
      node_of[static_cast<std::size_t>(n)] = known->second;
    }
    for (const auto element : part.elements.colwise()) {
      elements_.emplace_back();
      for (int a = 0; a < 10; ++a)
        elements_.back()[a] = node_of[static_cast<std::size_t>(element[a])];
    }
  }

  [[nodiscard]] probing::FiniteElementMesh mesh() const {
    probing::FiniteElementMesh result;
    result.nodes.resize(3, static_cast<Eigen::Index>(nodes_.size()));
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      result.nodes.col(static_cast<Eigen::Index>(n)) = nodes_[n];
    result.elements.resize(10, static_cast<Eigen::Index>(elements_.size()));
    for (std::size_t e = 0; e < elements_.size(); ++e)
      result.elements.col(static_cast<Eigen::Index>(e)) = elements_[e];
    result.regions.assign(elements_.size(), 0);
    return result;
  }

 private:
  std::vector<Eigen::Vector3d> nodes_;
  std::vector<Eigen::Matrix<int, 10, 1>> elements_;
  std::map<std::array<long long, 3>, int> nodes_of_place_;
};

/// The place of a point `on_cube`, whose largest coordinate is +-1, in layer 0, 1, ... about it.
using LayerPlace = std::function<Eigen::Vector3d(const Eigen::Vector3d& on_cube, double layer)>;

/// The layers on one side of a cube; `v` and `w` are axes of it, w the outward one. `cells` is even
/// along the axis across; along `v` from `low` to 1 they are `cells_v`.
inline probing::FiniteElementMesh layers_on_side(const Eigen::Vector3d& v, const Eigen::Vector3d& w,
                                                 double low, int cells, int cells_v, int layers,
                                                 const LayerPlace& place) {
  probing::FiniteElementMesh mesh =
      probing::box_mesh(evenly(-1, 1, cells), evenly(low, 1, cells_v), evenly(0, layers, layers));
  const Eigen::Vector3d u = v.cross(w);
  for (auto node : mesh.nodes.colwise())
    node = place(node.x() * u + node.y() * v + w, node.z()).eval();
  return mesh;
}

/// The direction of a point on a cube; points at equal distances get nearly equal angles.
inline Eigen::Vector3d even_direction(const Eigen::Vector3d& on_cube) {
  return Eigen::Vector3d((std::numbers::pi / 4 * on_cube).array().tan()).normalized();
}

/// The solid between two spheres about the origin, of curved elements. `cells` along a quarter of
/// a great circle, even.
inline probing::FiniteElementMesh spherical_shell_mesh(double inner, double outer, int cells,
                                                       int layers) {
  const LayerPlace place = [&](const Eigen::Vector3d& on_cube, double layer) {
    return Eigen::Vector3d((inner + (outer - inner) * layer / layers) * even_direction(on_cube));
  };
  using Eigen::Vector3d;
  JoinedMesh whole;
  for (const double side : {-1.0, 1.0}) {
    const std::pair<Vector3d, Vector3d> axes[3] = {{Vector3d::UnitZ(), side * Vector3d::UnitX()},
                                                   {Vector3d::UnitZ(), side * Vector3d::UnitY()},
                                                   {Vector3d::UnitY(), side * Vector3d::UnitZ()}};
    for (const auto& [v, w] : axes)
      whole.add(layers_on_side(v, w, -1, cells, cells, layers, place));
  }
  return whole.mesh();
}

/// Half a ball about the origin, z >= 0: even cells in the box |x|, |y|, z <= `box`, and shells
/// around it, whose outer radii are `radii`. `cells` along a side of the box, even.
inline probing::FiniteElementMesh half_ball_mesh(double box, int cells,
                                                 const std::vector<double>& radii) {
  const LayerPlace place = [&](const Eigen::Vector3d& on_cube, double layer) {
    const auto at = [&](int k) -> Eigen::Vector3d {
      if (k == 0) return box * on_cube;
      return radii.at(static_cast<std::size_t>(k) - 1) * even_direction(on_cube);
    };
    const int below = static_cast<int>(layer);
    const double part = layer - below;
    return part == 0 ? at(below) : Eigen::Vector3d((1 - part) * at(below) + part * at(below + 1));
  };
  using Eigen::Vector3d;
  const int layers = static_cast<int>(radii.size());
  JoinedMesh whole;
  whole.add(probing::box_mesh(evenly(-box, box, cells), evenly(-box, box, cells),
                              evenly(0, box, cells / 2)));
  for (const double side : {-1.0, 1.0}) {
    for (const Vector3d& w :
         {Vector3d(side * Vector3d::UnitX()), Vector3d(side * Vector3d::UnitY())})
      whole.add(layers_on_side(Vector3d::UnitZ(), w, 0, cells, cells / 2, layers, place));
  }
  whole.add(layers_on_side(Vector3d::UnitY(), Vector3d::UnitZ(), -1, cells, cells, layers, place));
  return whole.mesh();
}

/// [N] Forces of the solid alone, without contact, on each node; at supports the forces that hold
/// it. Written apart from the solver's own sum.
inline Eigen::Matrix3Xd node_forces(const probing::DeformableBody& body,
                                    const Eigen::Matrix3Xd& positions) {
  const auto nodes_of = [&](const Eigen::Matrix3Xd& of, Eigen::Index e) {
    probing::ElementNodes nodes;
    for (int a = 0; a < 10; ++a) nodes.col(a) = of.col(body.mesh.elements(a, e));
    return nodes;
  };
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, positions.cols());
  for (Eigen::Index e = 0; e < body.mesh.elements.cols(); ++e) {
    const auto region = static_cast<std::size_t>(body.mesh.regions[static_cast<std::size_t>(e)]);
    const probing::ElementForce element =
        element_force(probing::tetrahedron_points(nodes_of(body.mesh.nodes, e)),
                      body.materials[region], nodes_of(positions, e));
    if (!element.valid) throw std::runtime_error("an element is inverted");
    for (int a = 0; a < 10; ++a) forces.col(body.mesh.elements(a, e)) += element.force.col(a);
  }
  return forces;
}

}  // namespace palpate::support
