// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/probed_solid.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "specimen/finite_vector.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kSteepest = 70 * std::numbers::pi / 180;  // between normal and line of sight

// A part of the boundary at rest, and the nodes that its vertices are.
struct ProbedSurface {
  geometry::TriangleMesh mesh;
  std::vector<int> nodes;
};

// The triangles of the boundary, four of each quadratic face, that can be probed.
ProbedSurface probed_surface(const ContactEquilibrium& solid) {
  constexpr int kParts[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
  std::vector<bool> held(static_cast<std::size_t>(solid.rest().cols()), false);
  for (const int node : solid.body().supported) held[static_cast<std::size_t>(node)] = true;
  std::vector<int> index(held.size(), -1), nodes;
  std::vector<Eigen::Vector3i> triangles;
  for (const BoundaryFace& face : solid.faces()) {
    const Vector3d a = solid.rest().col(face.nodes[0]);
    const Vector3d normal = (solid.rest().col(face.nodes[1]) - a)
                                .cross(solid.rest().col(face.nodes[2]) - a)
                                .normalized();
    const bool seen = -normal.dot(a.normalized()) > std::cos(kSteepest);
    bool free = true;
    for (const int node : face.nodes) free &= !held[static_cast<std::size_t>(node)];
    if (!seen || !free) continue;
    for (const auto& part : kParts) {
      Eigen::Vector3i triangle;
      for (int k = 0; k < 3; ++k) {
        const int node = face.nodes[part[k]];
        int& at = index[static_cast<std::size_t>(node)];
        if (at < 0) {
          at = static_cast<int>(nodes.size());
          nodes.push_back(node);
        }
        triangle[k] = at;
      }
      triangles.push_back(triangle);
    }
  }
  if (triangles.empty()) {
    throw InvalidInput(
        "a camera at the origin sees no free part of the object; place it before the camera, about "
        "z = 700 mm, with its free side towards -z");
  }
  geometry::TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t n = 0; n < nodes.size(); ++n)
    mesh.vertices.col(static_cast<Eigen::Index>(n)) = solid.rest().col(nodes[n]);
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    mesh.triangles.col(static_cast<Eigen::Index>(t)) = triangles[t];
  return {std::move(mesh), std::move(nodes)};
}

EquilibriumOptions contact_of(const FiniteElementSpecimenOptions& options) {
  require("FiniteElementSpecimenOptions::friction", options.friction, at_least(0).finite());
  EquilibriumOptions contact = options.contact;
  contact.friction = options.microslip ? options.friction : std::numeric_limits<double>::infinity();
  return contact;
}

}  // namespace

ProbedSolid::ProbedSolid(DeformableBody body, const FiniteElementSpecimenOptions& options)
    : equilibrium_(std::move(body), contact_of(options)) {
  ProbedSurface probed = probed_surface(equilibrium_);
  surface_ = std::move(probed.mesh);
  nodes_ = std::move(probed.nodes);
  normals_ = geometry::vertex_normals(surface_);
  query_.emplace(surface_);
}

ProbedPlace ProbedSolid::place(const Vector3d& contact) const {
  require_finite("contact", contact, "mm");
  const geometry::ClosestPoint closest = query_->closest_point(contact);
  if (closest.at.triangle < 0) {
    throw InvalidInput(
        fmt::format("the contact ({:.6g}, {:.6g}, {:.6g}) mm is too far from the object",
                    contact.x(), contact.y(), contact.z()));
  }
  Vector3d normal = Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    normal += closest.at.barycentric[k] * normals_.col(surface_.triangles(k, closest.at.triangle));
  return {closest.position, -normal.normalized()};
}

}  // namespace palpate::probing
