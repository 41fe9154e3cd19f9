// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/closed_form.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "palpate/core/error.h"
#include "specimen/closed_form_fields.h"
#include "specimen/finite_vector.h"

namespace palpate::probing {
namespace {

constexpr double kDistance = 700;       // [mm] of the flat objects from the camera
constexpr double kMeshSpacing = 2;      // [mm]
constexpr double kSheetMargin = 2;      // [mm] between the sheet's mesh and a support
constexpr double kSheetHalfWidth = 70;  // [mm]
constexpr double kTaperWidth = 75;      // [mm]

// [N] Gradient of the sheet's energy by e (local).
Eigen::Vector3d sheet_gradient(const Sheet& sheet, double x, double y, const Eigen::Vector3d& e) {
  const double width = 1 - sheet.taper * y * y / (kTaperWidth * kTaperWidth);
  Eigen::Vector3d gradient(0, sheet.lateral * e.y(), 0);
  for (const double side : {1.0, -1.0}) {
    const double length = sheet.support + side * x;
    const Eigen::Vector3d segment = e + side * length * Eigen::Vector3d::UnitX();
    const double stretched = segment.norm();
    gradient +=
        width * (sheet.tension + sheet.axial * (stretched - length) / length) / stretched * segment;
  }
  if (sheet.block == 0) return gradient;
  const auto logistic = [](double u) { return 0.5 * (1 + std::tanh(u / 2)); };
  const auto window = [&](double at, double low, double high) {
    const double rise = logistic((at - low) / sheet.edge),
                 fall = logistic((high - at) / sheet.edge);
    return Eigen::Vector2d(rise * fall, rise * fall * (fall - rise) / sheet.edge);
  };
  const Eigen::Vector2d in_x = window(x + e.x(), sheet.block_low.x(), sheet.block_high.x());
  const Eigen::Vector2d in_y = window(y + e.y(), sheet.block_low.y(), sheet.block_high.y());
  const double u = (e.z() - sheet.depth) / sheet.softness;
  const double penetration =
      sheet.softness * (std::max(u, 0.0) + std::log1p(std::exp(-std::abs(u))));
  const double energy = sheet.block / 2 * penetration * penetration;
  return gradient + Eigen::Vector3d(in_x[1] * in_y[0] * energy, in_x[0] * in_y[1] * energy,
                                    in_x[0] * in_y[0] * sheet.block * penetration * logistic(u));
}

Eigen::Matrix3d sheet_hessian(const Sheet& sheet, double x, double y, const Eigen::Vector3d& e) {
  constexpr double kDifference = 1e-5;  // [mm]
  Eigen::Matrix3d hessian;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d d = kDifference * Eigen::Vector3d::Unit(k);
    hessian.col(k) = (sheet_gradient(sheet, x, y, e + d) - sheet_gradient(sheet, x, y, e - d)) /
                     (2 * kDifference);
  }
  return (hessian + hessian.transpose()) / 2;
}

struct Rectangle {
  Eigen::Vector2d low, high;
};

Rectangle extent(const Sheet& sheet) {
  const Eigen::Vector2d high(sheet.support - kSheetMargin, kSheetHalfWidth);
  return {-high, high};
}
Rectangle extent(const Beam& beam) { return {{0, -beam.width / 2}, {beam.length, beam.width / 2}}; }
Rectangle extent(const ElasticBody& body) {
  const Eigen::Vector2d high = Eigen::Vector2d::Constant(body.size / 2);
  return {-high, high};
}

template <typename Object>
geometry::TriangleMesh surface_mesh(const Object& object) {
  const Rectangle within = extent(object);
  const Eigen::Vector2d low = within.low, high = within.high;
  const Eigen::Array2i cells = ((high - low) / kMeshSpacing).array().ceil().cast<int>().cwiseMax(1);
  const int row = cells.x() + 1;
  geometry::TriangleMesh mesh;
  mesh.vertices.resize(3, row * (cells.y() + 1));
  for (int j = 0; j <= cells.y(); ++j) {
    for (int i = 0; i <= cells.x(); ++i) {
      mesh.vertices.col(j * row + i) =
          surface_at(object, low.x() + (high.x() - low.x()) * i / cells.x(),
                     low.y() + (high.y() - low.y()) * j / cells.y());
    }
  }
  mesh.triangles.resize(3, 2 * cells.x() * cells.y());
  int triangle = 0;
  for (int j = 0; j < cells.y(); ++j) {
    for (int i = 0; i < cells.x(); ++i) {
      const int corner = j * row + i, above = corner + row;
      mesh.triangles.col(triangle++) << corner, above, corner + 1;
      mesh.triangles.col(triangle++) << corner + 1, above, above + 1;
    }
  }
  return mesh;
}

template <typename Object>
void check_fields(const char* type, Object object) {
  visit_fields(object,
               [&](const char* name, const auto& field, const Interval& range, const char* unit) {
                 const std::string what = std::string(type) + "::" + name;
                 if constexpr (requires { field.x(); }) {
                   require(what, field.x(), range, unit);
                   require(what, field.y(), range, unit);
                 } else {
                   require(what, field, range, unit);
                 }
               });
}

// Objects whose whole surface has a displacement.
template <typename Object>
concept HasField = requires(const Object& object, const Eigen::Vector2d& beside,
                            const Eigen::Vector3d& force) {
  displacement_beside(object, beside, force);
};

// An object, the mesh of its surface, and places and vectors in the world frame.
template <typename Object>
class ClosedFormSpecimen : public Specimen {
 public:
  explicit ClosedFormSpecimen(const Object& object)
      : object_(object), extent_(extent(object)), surface_(surface_mesh(object)) {}

  const geometry::TriangleMesh& surface() const override { return surface_; }

  Eigen::Vector3d displacement(const Eigen::Vector3d& contact,
                               const Eigen::Vector3d& force) const override {
    require_finite("force", force, "N");
    const Eigen::Vector2d at = place(contact);
    const Eigen::Matrix3d frame = frame_at(object_, at.x(), at.y());
    return frame.transpose() * displacement_at(object_, at.x(), at.y(), frame * force);
  }

  bool knows_shape() const override { return HasField<Object>; }

  Eigen::Matrix3Xd deformed_surface(const Eigen::Vector3d& contact,
                                    const Eigen::Vector3d& force) const override {
    if constexpr (!HasField<Object>) {
      return Specimen::deformed_surface(contact, force);
    } else {
      require_finite("force", force, "N");
      const Eigen::Vector2d at = place(contact);
      const Eigen::Matrix3d frame = frame_at(object_, at.x(), at.y());
      Eigen::Matrix3Xd moved = surface_.vertices;
      for (auto vertex : moved.colwise()) {
        vertex += frame.transpose() *
                  displacement_beside(object_, vertex.template head<2>() - at, frame * force);
      }
      return moved;
    }
  }

  FrictionCone friction_cone(const Eigen::Vector3d& contact) const override {
    const Eigen::Vector2d at = place(contact);
    const LocalCone cone = cone_at(object_, at.x(), at.y());
    return {frame_at(object_, at.x(), at.y()).transpose() * cone.axis, cone.friction};
  }

  Retardation retardation() const override {
    return {.share = object_.retarded, .time = object_.retardation_time};
  }

 private:
  Eigen::Vector2d place(const Eigen::Vector3d& contact) const {
    require_finite("contact", contact, "mm");
    return contact.head<2>().cwiseMax(extent_.low).cwiseMin(extent_.high);
  }

  Object object_;
  Rectangle extent_;
  geometry::TriangleMesh surface_;
};

}  // namespace

bool holds(const LocalCone& cone, const Eigen::Vector3d& force) {
  const double along = force.dot(cone.axis);
  return (force - along * cone.axis).norm() <= cone.friction * along;
}

Eigen::Matrix3d frame_at(const Sheet&, double x, double y) {
  const Eigen::Vector3d inward =
      -Eigen::Vector3d(-0.0016 * x, 1.5 / 40 * std::cos(y / 40), -1).normalized();
  const Eigen::Vector3d along = (Eigen::Vector3d::UnitX() - inward * inward.x()).normalized();
  Eigen::Matrix3d frame;
  frame << along.transpose(), inward.cross(along).transpose(), inward.transpose();
  return frame;
}

Eigen::Vector3d surface_at(const Sheet&, double x, double y) {
  const double within = std::min(std::abs(x), 50.0);
  return {x, y, 702 - 0.0008 * within * within + 1.5 * std::sin(y / 40)};
}

LocalCone cone_at(const Sheet& sheet, double x, double y) {
  const double tilt = sheet.tilt * std::numbers::pi / 180;
  const double a = std::sin(tilt * std::cos(y / 25)), b = std::sin(tilt * std::sin(x / 18));
  return {{a, b, std::sqrt(1 - a * a - b * b)},
          sheet.friction + sheet.friction_variation * std::sin(x / 20) * std::cos(y / 30)};
}

Eigen::Vector3d displacement_at(const Sheet& sheet, double x, double y,
                                const Eigen::Vector3d& force) {
  constexpr int kLoads = 12, kIterations = 60;
  constexpr double kLongestStep = 2;           // [mm]
  constexpr double kSmallestStiffness = 1e-4;  // [N/mm]
  constexpr double kResidual = 1e-10;          // [N]
  Eigen::Vector3d e = Eigen::Vector3d::Zero();
  double residual = 0;
  for (int load = 1; load <= kLoads; ++load) {
    const Eigen::Vector3d part_of_force = force * load / static_cast<double>(kLoads);
    for (int i = 0; i < kIterations; ++i) {
      const Eigen::Vector3d unbalanced = sheet_gradient(sheet, x, y, e) - part_of_force;
      residual = unbalanced.norm();
      if (residual < kResidual) break;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(sheet_hessian(sheet, x, y, e));
      const Eigen::Vector3d step =
          -eigen.eigenvectors() *
          (eigen.eigenvectors().transpose() * unbalanced)
              .cwiseQuotient(eigen.eigenvalues().cwiseAbs().cwiseMax(kSmallestStiffness));
      double part = std::min(1.0, kLongestStep / step.norm());
      // Require a smaller residual each time, which suffices for the convex sheet and the block.
      constexpr double kLeastPart = 1e-3;  // of a Newton step
      while (part > kLeastPart &&
             (sheet_gradient(sheet, x, y, e + part * step) - part_of_force).norm() > residual) {
        part /= 2;
      }
      e += part * step;
    }
  }
  if (!(residual < 1e3 * kResidual)) {
    throw SolverError("the sheet has no equilibrium at (" + std::to_string(x) + ", " +
                      std::to_string(y) + ") under " + std::to_string(force.norm()) + " N");
  }
  return e + sheet.compliance * force;
}

Eigen::Matrix3d frame_at(const Beam&, double, double) { return Eigen::Matrix3d::Identity(); }
Eigen::Vector3d surface_at(const Beam&, double x, double y) { return {x, y, kDistance}; }
LocalCone cone_at(const Beam& beam, double, double) { return {{0, 0, 1}, beam.friction}; }

Eigen::Matrix3d bending_compliance(const Beam& beam, double x, double y) {
  const double part = x / beam.length;
  // A force at x causes the moment f_z (x - s) + f_x height at s; 1 / EI of a cantilever is 3
  // bending / length^3.
  const double flexibility = 3 * beam.bending / std::pow(beam.length, 3);
  const Eigen::Vector3d twist(0, -beam.height, y);
  Eigen::Matrix3d compliance = beam.twisting * part * twist * twist.transpose();
  compliance(2, 2) += flexibility * x * x * x / 3;
  compliance(0, 2) += flexibility * beam.height * x * x / 2;
  compliance(2, 0) += flexibility * beam.height * x * x / 2;
  compliance(0, 0) += flexibility * beam.height * beam.height * x + beam.stretching * part;
  compliance(1, 1) += beam.sideways * part * part * part;
  return compliance;
}

Eigen::Vector3d indentation(const Beam& beam, const Eigen::Vector3d& force) {
  const double size = force.norm();
  Eigen::Vector3d displacement(
      beam.shear * force.x(), beam.shear * force.y(),
      beam.pressed * beam.pressed_force * std::asinh(force.z() / beam.pressed_force));
  if (size > 0) {
    displacement +=
        beam.coupled * beam.coupled_force * std::tanh(size / beam.coupled_force) / size * force;
  }
  return displacement;
}

Eigen::Vector3d displacement_at(const Beam& beam, double x, double y,
                                const Eigen::Vector3d& force) {
  const double softer = 1 + beam.local_variation * std::sin(x / 30 + y / 12);
  return softer * indentation(beam, force) + bending_compliance(beam, x, y) * force;
}

Eigen::Matrix3d frame_at(const ElasticBody&, double, double) { return Eigen::Matrix3d::Identity(); }
Eigen::Vector3d surface_at(const ElasticBody&, double x, double y) { return {x, y, kDistance}; }
LocalCone cone_at(const ElasticBody& body, double, double) { return {{0, 0, 1}, body.friction}; }

Eigen::Vector3d displacement_at(const ElasticBody& body, double, double,
                                const Eigen::Vector3d& force) {
  const double nu = body.poisson_ratio, stiffness = body.tool_radius * body.young_modulus;
  const double tangential = (1 + nu) * (2 - nu) / (4 * stiffness);
  const double normal = (1 - nu * nu) / (2 * stiffness);
  return {tangential * force.x(), tangential * force.y(), normal * force.z()};
}

std::unique_ptr<Specimen> make_specimen(const Sheet& sheet) {
  check_fields("Sheet", sheet);
  return std::make_unique<ClosedFormSpecimen<Sheet>>(sheet);
}
std::unique_ptr<Specimen> make_specimen(const Beam& beam) {
  check_fields("Beam", beam);
  return std::make_unique<ClosedFormSpecimen<Beam>>(beam);
}
std::unique_ptr<Specimen> make_specimen(const ElasticBody& body) {
  check_fields("ElasticBody", body);
  return std::make_unique<ClosedFormSpecimen<ElasticBody>>(body);
}

}  // namespace palpate::probing
