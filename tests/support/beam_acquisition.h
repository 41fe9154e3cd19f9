// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "strip_acquisition.h"

// Measurements of a foam beam clamped at one end (thesis Figure 6.1) whose truth is known: a force
// on its upper side indents the foam and bends the whole beam. The upper side is the plane z = 700
// mm, seen by a camera; the beam runs along x from its clamp at x = 0; local frames are the
// camera's. Only the records of the library are used.
namespace palpate::testing {

/// Material of the beam. The displacement under a force f is the gradient of
///   shear / 2 (f_x^2 + f_y^2) + pressed h^2 u(f_z / h) + coupled c^2 log cosh(|f| / c),
///   u(s) = s asinh s - sqrt(1 + s^2),
/// for the foam, a stiffening curve that is the same everywhere, plus the linear terms of the
/// beam's bending, stretching and twisting.
struct Beam {
  double length = 200;  ///< [mm]
  double width = 40;    ///< [mm] |y| <= width / 2
  double height = 15;   ///< [mm] of the upper side over the beam's axis

  double shear = 0.35;         ///< [mm/N] of the foam
  double pressed = 1.6;        ///< [mm/N] of the foam at rest, along z
  double pressed_force = 0.8;  ///< [N] h, where stiffening starts
  double coupled = 0.5;        ///< [mm/N] of the foam at rest, along each axis
  double coupled_force = 1.5;  ///< [N] c, where stiffening starts
  double local_variation = 0;  ///< relative amplitude by which the foam varies over the beam

  double bending = 4;        ///< [mm/N] at the tip by a force along z
  double sideways = 0.8;     ///< [mm/N] at the tip by a force along y
  double stretching = 0.05;  ///< [mm/N] at the tip by a force along x
  double twisting = 0.002;   ///< [1/(N mm)] angle at the tip by a torque

  double friction = 0.8;
};

/// [mm/N] compliance of the whole beam: that of a cantilever loaded at its upper side.
inline Eigen::Matrix3d beam_compliance(const Beam& beam, double x, double y) {
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

/// [mm] displacement of the foam under a force.
inline Eigen::Vector3d beam_indentation(const Beam& beam, const Eigen::Vector3d& force) {
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

inline Eigen::Matrix3d frame_at(const Beam&, double, double) { return Eigen::Matrix3d::Identity(); }
inline Eigen::Vector3d surface_at(const Beam&, double x, double y) { return {x, y, 700}; }
inline StripCone cone_at(const Beam& beam, double, double) { return {{0, 0, 1}, beam.friction}; }
inline Eigen::Vector3d displacement_at(const Beam& beam, double x, double y,
                                       const Eigen::Vector3d& force) {
  const double softer = 1 + beam.local_variation * std::sin(x / 30 + y / 12);
  return softer * beam_indentation(beam, force) + beam_compliance(beam, x, y) * force;
}

/// Three rows of ten contacts.
inline std::vector<Eigen::Vector2d> beam_places(const Beam& beam = {}) {
  std::vector<Eigen::Vector2d> places;
  for (int row = -1; row <= 1; ++row) {
    for (int k = 0; k < 10; ++k) {
      places.emplace_back((0.08 + 0.1 * k) * beam.length, 0.35 * row * beam.width);
    }
  }
  return places;
}

/// Every `every`th place, from the second on, is probed densely, and the others with 10 samples
/// each; contacts have the ids of their places.
inline probing::Acquisition beam_acquisition(const Beam& beam, std::size_t every,
                                             const StripProbing& dense) {
  constexpr double kRatio = 0.5;
  const StripProbing sparse{
      .normal_forces = {0.8, 2.4}, .directions = 4, .seed = dense.seed + 1000};
  probing::Acquisition acquisition;
  ObjectProbe<Beam> densely(beam, dense), sparsely(beam, sparse, 1'000'000);
  const std::vector<Eigen::Vector2d> places = beam_places(beam);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i % every == 1) {
      densely.probe(acquisition, places[i].x(), places[i].y());
    } else {
      sparsely.probe_sparsely(acquisition, places[i].x(), places[i].y(), kRatio);
    }
  }
  return acquisition;
}

/// Mesh of the upper side.
inline geometry::TriangleMesh beam_surface(const Beam& beam = {}) {
  constexpr int kAlong = 20, kAcross = 4;
  geometry::TriangleMesh mesh;
  mesh.vertices.resize(3, (kAlong + 1) * (kAcross + 1));
  mesh.triangles.resize(3, 2 * kAlong * kAcross);
  for (int j = 0; j <= kAcross; ++j) {
    for (int i = 0; i <= kAlong; ++i) {
      mesh.vertices.col(j * (kAlong + 1) + i) =
          surface_at(beam, beam.length * i / kAlong, beam.width * (j / double{kAcross} - 0.5));
    }
  }
  int triangle = 0;
  for (int j = 0; j < kAcross; ++j) {
    for (int i = 0; i < kAlong; ++i) {
      const int corner = j * (kAlong + 1) + i, above = corner + kAlong + 1;
      mesh.triangles.col(triangle++) << corner, above, corner + 1;
      mesh.triangles.col(triangle++) << corner + 1, above, above + 1;
    }
  }
  return mesh;
}

}  // namespace palpate::testing
