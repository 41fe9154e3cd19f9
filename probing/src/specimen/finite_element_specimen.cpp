// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/finite_element_specimen.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/geometry/surface_query.h"
#include "specimen/finite_vector.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kSteepest = 70 * std::numbers::pi / 180;  // between normal and line of sight

// The triangles of the boundary, four of each quadratic face, that can be probed.
geometry::TriangleMesh probed_surface(const ContactEquilibrium& solid) {
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
  return mesh;
}

EquilibriumOptions contact_of(const FiniteElementSpecimenOptions& options) {
  require("FiniteElementSpecimenOptions::friction", options.friction, at_least(0).finite());
  EquilibriumOptions contact = options.contact;
  contact.friction = options.microslip ? options.friction : std::numeric_limits<double>::infinity();
  return contact;
}

std::string numbers_of(const Vector3d& v) {
  return "(" + std::to_string(v.x()) + ", " + std::to_string(v.y()) + ", " + std::to_string(v.z()) +
         ")";
}

// [mm] How far the tip has come.
Vector3d tip_motion(const ContactState& start, const Vector3d& place, const Vector3d& force,
                    const ContactResult& found) {
  if (found.stop != ContactStop::converged) {
    throw SolverError("the object has no equilibrium at " + numbers_of(place) +
                      " mm under the force " + numbers_of(force) + " N: " + to_string(found.stop) +
                      " beyond " + std::to_string(found.state.force.norm()) + " N");
  }
  return found.state.tip - start.tip;
}

class FiniteElementContact : public SpecimenContact {
 public:
  FiniteElementContact(const ContactEquilibrium& solid, Vector3d place, Vector3d inward)
      : solid_(solid), place_(std::move(place)), inward_(std::move(inward)) {}

  Vector3d displacement(const Vector3d& force) override {
    require_finite("force", force, "N");
    // Not before, since a contact that the tip cannot reach has no displacement.
    if (!series_) series_.emplace(solid_, solid_.touch(place_, inward_));
    return tip_motion(series_->from(), place_, force, series_->apply_force(force));
  }

 private:
  const ContactEquilibrium& solid_;
  Vector3d place_, inward_;
  std::optional<ContactSeries> series_;
};

class FiniteElementSpecimen : public Specimen {
 public:
  FiniteElementSpecimen(DeformableBody body, const FiniteElementSpecimenOptions& options)
      : friction_(options.friction),
        tip_radius_(options.contact.tip_radius),
        solid_(std::move(body), contact_of(options)),
        surface_(probed_surface(solid_)),
        normals_(geometry::vertex_normals(surface_)),
        query_(surface_) {}

  const geometry::TriangleMesh& surface() const override { return surface_; }

  Vector3d displacement(const Vector3d& contact, const Vector3d& force) const override {
    require_finite("force", force, "N");
    const Place at = place(contact);
    const ContactState start = solid_.touch(at.position, at.inward);
    return tip_motion(start, at.position, force, solid_.apply_force(start, force));
  }

  std::unique_ptr<SpecimenContact> at(const Vector3d& contact) const override {
    const Place there = place(contact);
    return std::make_unique<FiniteElementContact>(solid_, there.position, there.inward);
  }

  FrictionCone friction_cone(const Vector3d& contact) const override {
    return {place(contact).inward, friction_};
  }

  std::optional<double> tip_radius() const override { return tip_radius_; }

 private:
  struct Place {
    Vector3d position, inward;
  };
  Place place(const Vector3d& contact) const {
    require_finite("contact", contact, "mm");
    const geometry::ClosestPoint closest = query_.closest_point(contact);
    if (closest.at.triangle < 0)
      throw InvalidInput("the contact " + numbers_of(contact) + " mm is too far from the object");
    Vector3d normal = Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      normal +=
          closest.at.barycentric[k] * normals_.col(surface_.triangles(k, closest.at.triangle));
    return {closest.position, -normal.normalized()};
  }

  double friction_;
  double tip_radius_;  // [mm]
  ContactEquilibrium solid_;
  geometry::TriangleMesh surface_;
  Eigen::Matrix3Xd normals_;
  geometry::SurfaceQuery query_;
};

}  // namespace

std::unique_ptr<Specimen> make_specimen(DeformableBody body,
                                        const FiniteElementSpecimenOptions& options) {
  return std::make_unique<FiniteElementSpecimen>(std::move(body), options);
}

}  // namespace palpate::probing
