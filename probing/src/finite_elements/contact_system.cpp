// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/contact_system.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "finite_elements/finite_element_tools.h"

namespace palpate::probing {
namespace {

using FaceNodes = Eigen::Matrix<double, 3, 6>;

// Shape functions of a face at barycentric coordinates.
Eigen::Matrix<double, 6, 1> face_shape(const Eigen::Vector3d& l) {
  Eigen::Matrix<double, 6, 1> n;
  for (int a = 0; a < 3; ++a) {
    n[a] = l[a] * (2 * l[a] - 1);
    n[3 + a] = 4 * l[a] * l[(a + 1) % 3];
  }
  return n;
}

// Columns: derivatives by the second and third coordinate, the first being one minus them.
Eigen::Matrix<double, 6, 2> face_gradients(const Eigen::Vector3d& l) {
  Eigen::Matrix<double, 6, 3> by = Eigen::Matrix<double, 6, 3>::Zero();
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    by(a, a) = 4 * l[a] - 1;
    by(3 + a, a) = 4 * l[b];
    by(3 + a, b) = 4 * l[a];
  }
  Eigen::Matrix<double, 6, 2> result;
  result << by.col(1) - by.col(0), by.col(2) - by.col(0);
  return result;
}

// Points in m^2 equal parts of a triangle, three in each (exact to degree 2 there).
std::shared_ptr<const FaceRule> face_rule(int m) {
  auto rule = std::make_shared<FaceRule>();
  std::vector<Eigen::Vector3d> at;
  const auto add = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                       const Eigen::Vector3d& c) {
    at.emplace_back((4 * a + b + c) / (6 * m));
    at.emplace_back((a + 4 * b + c) / (6 * m));
    at.emplace_back((a + b + 4 * c) / (6 * m));
  };
  for (int i = 0; i < m; ++i) {
    for (int j = 0; i + j < m; ++j) {
      const auto corner = [&](int k, int l) { return Eigen::Vector3d(m - k - l, k, l); };
      add(corner(i, j), corner(i + 1, j), corner(i, j + 1));
      if (i + j + 1 < m) add(corner(i + 1, j + 1), corner(i, j + 1), corner(i + 1, j));
    }
  }
  rule->shapes.resize(6, static_cast<Eigen::Index>(at.size()));
  for (std::size_t k = 0; k < at.size(); ++k) {
    rule->shapes.col(static_cast<Eigen::Index>(k)) = face_shape(at[k]);
    rule->gradients.push_back(face_gradients(at[k]));
  }
  rule->weight = 1.0 / static_cast<double>(at.size());
  return rule;
}

FaceNodes face_nodes(const Eigen::Matrix3Xd& positions, const BoundaryFace& face) {
  FaceNodes result;
  for (int k = 0; k < 6; ++k) result.col(k) = positions.col(face.nodes[k]);
  return result;
}

// A quadratic face lies within the convex hull of these points.
FaceNodes control_points(const FaceNodes& nodes) {
  FaceNodes result = nodes;
  for (int a = 0; a < 3; ++a)
    result.col(3 + a) = 2 * nodes.col(3 + a) - (nodes.col(a) + nodes.col((a + 1) % 3)) / 2;
  return result;
}

// Returns true if a plane separates a face from the ball around the origin. Gilbert's iteration
// looks for the nearest point of the hull; if it does not reach it, a face counts as near.
bool is_beyond(const FaceNodes& nodes, double radius) {
  constexpr int kSteps = 4;
  const FaceNodes hull = control_points(nodes);
  Eigen::Index index = 0;
  hull.colwise().squaredNorm().minCoeff(&index);
  Eigen::Vector3d nearest = hull.col(index);
  for (int step = 0; step < kSteps; ++step) {
    const double support = (nearest.transpose() * hull).minCoeff(&index);
    if (support > radius * nearest.norm()) return true;
    const Eigen::Vector3d way = hull.col(index) - nearest;
    const double length = way.squaredNorm();
    if (length == 0) return false;
    nearest += std::clamp(-nearest.dot(way) / length, 0.0, 1.0) * way;
  }
  return false;
}

constexpr double kPointSpacing = 0.25;  // [tip radii] side of the parts of a face, at most
constexpr int kFinest = 16;             // parts along the side of a face, at most

ContactFace contact_face(const DeformableBody& body, const EquilibriumOptions& options,
                         const BoundaryFace& face,
                         std::map<int, std::shared_ptr<const FaceRule>>& rules) {
  ContactFace result;
  result.face = face;
  const FaceNodes nodes = face_nodes(body.mesh.nodes, face);
  for (int a = 0; a < 6; ++a)
    for (int b = 0; b < a; ++b)
      result.reach = std::max(result.reach, (nodes.col(a) - nodes.col(b)).norm());
  const double parts = std::ceil(result.reach / (kPointSpacing * options.tip_radius));
  const int m = static_cast<int>(std::clamp(parts, 2.0, double{kFinest}));
  std::shared_ptr<const FaceRule>& rule = rules[m];
  if (!rule) rule = face_rule(m);
  result.rule = rule;
  result.weights.resize(rule->shapes.cols());
  for (std::size_t k = 0; k < rule->gradients.size(); ++k) {
    const Eigen::Matrix<double, 3, 2> tangents = nodes * rule->gradients[k];
    result.weights[static_cast<Eigen::Index>(k)] =
        rule->weight * tangents.col(0).cross(tangents.col(1)).norm() / 2;
  }
  const int region = body.mesh.regions[static_cast<std::size_t>(face.element)];
  const Hyperelastic& material = body.materials[static_cast<std::size_t>(region)];
  result.stiffness =
      options.stiffness * young_modulus(material) / std::sqrt(2 * result.weights.sum());
  return result;
}

// The anchors of a state in the order of points.
class AnchorCursor {
 public:
  explicit AnchorCursor(const std::vector<ContactAnchor>& anchors) : anchors_(anchors) {}
  std::optional<Eigen::Vector3d> at(int point) {
    while (next_ < anchors_.size() && anchors_[next_].point < point) ++next_;
    if (next_ == anchors_.size() || anchors_[next_].point != point) return std::nullopt;
    return anchors_[next_].direction;
  }

 private:
  const std::vector<ContactAnchor>& anchors_;
  std::size_t next_ = 0;
};

}  // namespace

ContactSystem::ContactSystem(const DeformableBody& body, const EquilibriumOptions& options)
    : body_(body),
      options_(options),
      faces_of_element_(static_cast<std::size_t>(body.mesh.elements.cols())),
      fixed_(static_cast<std::size_t>(body.mesh.nodes.cols()), false) {
  for (Eigen::Index e = 0; e < body.mesh.elements.cols(); ++e) {
    points_.push_back(tetrahedron_points(element_nodes(body.mesh, body.mesh.nodes, e)));
    packed_points_.emplace_back(points_.back());
  }
  std::map<int, std::shared_ptr<const FaceRule>> rules;
  int next_point = 0;
  for (const BoundaryFace& face : boundary_faces(body.mesh)) {
    faces_of_element_[static_cast<std::size_t>(face.element)].push_back(
        static_cast<int>(faces_.size()));
    faces_.push_back(contact_face(body, options, face, rules));
    faces_.back().first_point = next_point;
    next_point += static_cast<int>(faces_.back().weights.size());
  }
  for (const int node : body.supported) fixed_[static_cast<std::size_t>(node)] = true;
}

SystemForces ContactSystem::forces(const Eigen::Matrix3Xd& positions, const Eigen::Vector3d& tip,
                                   const ContactState* start) const {
  SystemForces result;
  result.nodes.setZero(positions.size());
  Eigen::Map<Eigen::Matrix3Xd> nodes(result.nodes.data(), 3, positions.cols());
  for (Eigen::Index e = 0; e < body_.mesh.elements.cols(); ++e) {
    const auto region = static_cast<std::size_t>(body_.mesh.regions[static_cast<std::size_t>(e)]);
    const ElementForce element =
        element_force(packed_points_[static_cast<std::size_t>(e)], body_.materials[region],
                      element_nodes(body_.mesh, positions, e));
    if (!element.valid) return result;
    for (int a = 0; a < 10; ++a) nodes.col(body_.mesh.elements(a, e)) += element.force.col(a);
  }
  result.valid = true;
  add_obstacles(positions, result);
  if (start) add_tip(positions, tip, *start, result);
  for (const int node : body_.supported) {
    result.reaction = std::hypot(result.reaction, nodes.col(node).norm());
    nodes.col(node).setZero();
  }
  return result;
}

void ContactSystem::add_obstacles(const Eigen::Matrix3Xd& positions, SystemForces& result) const {
  for (const RigidBlock& block : body_.obstacles) {
    for (const ContactFace& face : faces_) {
      const FaceNodes nodes = face_nodes(positions, face.face);
      if (((nodes.rowwise().maxCoeff() - block.low).array() < -face.reach).any() ||
          ((nodes.rowwise().minCoeff() - block.high).array() > face.reach).any())
        continue;
      for (Eigen::Index p = 0; p < face.weights.size(); ++p) {
        const auto shape = face.rule->shapes.col(p);
        const auto pushed = obstacle_traction(block, face.stiffness, nodes * shape);
        if (!pushed) continue;
        for (int k = 0; k < 6; ++k)
          result.nodes.segment<3>(3 * face.face.nodes[k]) -=
              face.weights[p] * shape[k] * pushed->traction;
      }
    }
  }
}

void ContactSystem::add_tip(const Eigen::Matrix3Xd& positions, const Eigen::Vector3d& tip,
                            const ContactState& start, SystemForces& result) const {
  AnchorCursor anchors(start.anchors);
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const ContactFace& face = faces_[f];
    const FaceNodes nodes = face_nodes(positions, face.face).colwise() - tip;
    if (is_beyond(nodes, options_.tip_radius)) continue;
    const FaceNodes before = face_nodes(start.positions, face.face).colwise() - start.tip;
    const TipLaw law{options_.tip_radius, options_.friction, face.stiffness, face.stiffness};
    for (Eigen::Index p = 0; p < face.weights.size(); ++p) {
      const auto shape = face.rule->shapes.col(p);
      const Eigen::Vector3d at = nodes * shape;
      if (at.squaredNorm() >= options_.tip_radius * options_.tip_radius) continue;
      const int index = face.first_point + static_cast<int>(p);
      const auto contact = tip_traction(law, at, before * shape, anchors.at(index));
      if (!contact) continue;
      const Eigen::Vector3d force = face.weights[p] * contact->traction;
      for (int k = 0; k < 6; ++k)
        result.nodes.segment<3>(3 * face.face.nodes[k]) -= shape[k] * force;
      result.tip += force;
      result.contacts.push_back(
          {static_cast<int>(f), static_cast<int>(p), face.weights[p] * contact->tangent});
      result.anchors.push_back({index, contact->anchor});
      result.slipping += contact->slips;
    }
  }
}

ElementMatrix ContactSystem::tangent(const Eigen::Matrix3Xd& positions, int element) const {
  const auto e = static_cast<std::size_t>(element);
  const auto region = static_cast<std::size_t>(body_.mesh.regions[e]);
  ElementMatrix result = element_tangent(points_[e], body_.materials[region],
                                         element_nodes(body_.mesh, positions, element));
  if (body_.obstacles.empty()) return result;
  for (const int f : faces_of_element_[e]) {
    const ContactFace& face = faces_[static_cast<std::size_t>(f)];
    const FaceNodes nodes = face_nodes(positions, face.face);
    std::array<int, 6> local{};
    for (int k = 0; k < 6; ++k) {
      for (int a = 0; a < 10; ++a)
        if (body_.mesh.elements(a, element) == face.face.nodes[k])
          local[static_cast<std::size_t>(k)] = a;
    }
    for (const RigidBlock& block : body_.obstacles) {
      for (Eigen::Index p = 0; p < face.weights.size(); ++p) {
        const auto shape = face.rule->shapes.col(p);
        const auto pushed = obstacle_traction(block, face.stiffness, nodes * shape);
        if (!pushed) continue;
        for (int a = 0; a < 6; ++a) {
          for (int b = 0; b < 6; ++b) {
            result.block<3, 3>(3 * local[static_cast<std::size_t>(a)],
                               3 * local[static_cast<std::size_t>(b)]) -=
                face.weights[p] * shape[a] * shape[b] * pushed->tangent;
          }
        }
      }
    }
  }
  return result;
}

double ContactSystem::elastic_energy(const Eigen::Matrix3Xd& positions) const {
  double sum = 0;
  for (Eigen::Index e = 0; e < body_.mesh.elements.cols(); ++e) {
    const auto region = static_cast<std::size_t>(body_.mesh.regions[static_cast<std::size_t>(e)]);
    sum += element_force(packed_points_[static_cast<std::size_t>(e)], body_.materials[region],
                         element_nodes(body_.mesh, positions, e))
               .energy;
  }
  return sum;
}

}  // namespace palpate::probing
