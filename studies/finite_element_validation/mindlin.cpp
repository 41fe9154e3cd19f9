// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mindlin.h"

#include <cmath>
#include <string>
#include <vector>

#include "half_space.h"
#include "report.h"
#include "validation.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

constexpr double kMindlinFriction = 0.5;
constexpr double kMindlinSlope = 0.05;  // a / R
constexpr double kMindlinTip = kContactRadius / kMindlinSlope;
constexpr double kMindlinPoisson =
    0.49;  // Mindlin neglects how shear changes pressure, which is 0 at 1/2
constexpr double kMindlinStiffness = 200;

MindlinContact mindlin_contact() {
  const probing::Hyperelastic material = material_of(kMindlinPoisson);
  return {.limit = kMindlinFriction * hertz_force(material, kMindlinTip),
          .compliance = (2 - probing::poisson_ratio(material)) / material.shear_modulus,
          .radius = kContactRadius};
}

void compare_displacement(double part) {
  const probing::Hyperelastic material = material_of(kMindlinPoisson);
  const double normal = hertz_force(material, kMindlinTip);
  const Vector3d force(part * kMindlinFriction * normal, 0, normal);
  const probing::ContactEquilibrium solid(
      half_space(material, {}, force),
      {.tip_radius = kMindlinTip, .friction = kMindlinFriction, .stiffness = kMindlinStiffness});
  const probing::ContactState start = solid.touch(Vector3d::Zero(), Vector3d::UnitZ());
  const probing::ContactResult pressed = solid.apply_force(start, Vector3d(0, 0, normal));
  const probing::ContactResult dragged = solid.apply_force(converged(pressed), force);
  // The motion of the far side has moved the surface before the tip came.
  const double before = solid.rest()(0, start.place) - solid.body().mesh.nodes(0, start.place);
  print_line("at " + short_text(part) + " of the limit", converged(dragged).tip.x() + before,
             mindlin_displacement(mindlin_contact(), part));
}

// Simpson's rule over an even number of equal intervals.
double simpson(const std::vector<double>& values, double interval) {
  double sum = 0;
  for (std::size_t i = 0; i + 2 < values.size(); i += 2)
    sum += values[i] + 4 * values[i + 1] + values[i + 2];
  return sum * interval / 3;
}

void compare_loss(double part) {
  const probing::Hyperelastic material = material_of(kMindlinPoisson);
  const double normal = hertz_force(material, kMindlinTip);
  const double largest = part * kMindlinFriction * normal;
  const probing::ContactEquilibrium solid(
      half_space(material, {}),
      {.tip_radius = kMindlinTip, .friction = kMindlinFriction, .stiffness = kMindlinStiffness});
  const probing::ContactState start = solid.touch(Vector3d::Zero(), Vector3d::UnitZ());
  probing::ContactState at = converged(solid.apply_force(start, Vector3d(0, 0, normal)));
  at = converged(solid.apply_force(at, Vector3d(largest, 0, normal)));
  constexpr int kIntervals = 6;
  // The integral of the displacement over the force, back and forth.
  const auto half_cycle = [&](double sign) {
    std::vector<double> places{at.tip.x()};
    for (int i = 1; i <= kIntervals; ++i) {
      const double across = sign * largest * (2.0 * i / kIntervals - 1);
      at = converged(solid.apply_force(at, Vector3d(across, 0, normal)));
      places.push_back(at.tip.x());
    }
    return simpson(places, sign * 2 * largest / kIntervals);
  };
  const double back = half_cycle(-1), forth = half_cycle(1);
  print_line("cycle between +-" + short_text(part) + " of the limit", -(back + forth),
             mindlin_loss(mindlin_contact(), part));
}

}  // namespace

double mindlin_displacement(const MindlinContact& c, double part) {
  return 3 * c.limit * c.compliance / (16 * c.radius) * (1 - std::pow(1 - part, 2.0 / 3));
}

double mindlin_loss(const MindlinContact& c, double part) {
  return 9 * c.limit * c.limit * c.compliance / (10 * c.radius) *
         (1 - std::pow(1 - part, 5.0 / 3) - 5 * part / 6 * (1 + std::pow(1 - part, 2.0 / 3)));
}

void compare_with_mindlin() {
  print_title("Cattaneo and Mindlin: displacement [mm] of a ball that is dragged");
  for (const double part : {0.3, 0.6, 0.8, 0.9}) compare_displacement(part);
  print_title("Mindlin and Deresiewicz: energy [N mm] that a cycle loses");
  for (const double part : {0.5, 0.8}) compare_loss(part);
}

}  // namespace palpate::bench
