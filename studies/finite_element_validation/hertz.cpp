// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "half_space.h"
#include "report.h"
#include "validation.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

struct HertzCase {
  double slope = 0.05;  // a / R: strains are of this size
  double stiffness = 200;
  double nu = 0.3;
  HalfSpaceMesh mesh = {};
  bool held = false;  // the far side
};

void press_ball(const HertzCase& c) {
  const double radius = kContactRadius / c.slope;
  const probing::Hyperelastic material = material_of(c.nu);
  const Vector3d force(0, 0, hertz_force(material, radius));
  const probing::ContactEquilibrium solid(
      half_space(material, c.mesh, c.held ? Vector3d::Zero() : force),
      {.tip_radius = radius, .friction = 0, .stiffness = c.stiffness});
  const probing::ContactState start = solid.touch(Vector3d::Zero(), Vector3d::UnitZ());
  const Vector3d tip = converged(solid.apply_force(start, force)).tip;
  print_line("a/R " + short_text(c.slope) + ", cells of " + short_text(2.4 / c.mesh.cells) +
                 " a, stiffness " + short_text(c.stiffness) + ", nu " + short_text(c.nu) +
                 (c.held ? ", held at " + short_text(c.mesh.extent) + " a" : std::string()),
             tip.z() + radius, kContactRadius * kContactRadius / radius);
}

}  // namespace

void compare_with_hertz() {
  print_title("Hertz: depth [mm] of a ball without friction");
  press_ball({});
  press_ball({.nu = 0.49});
  print_title("  its error by cause: size of strains");
  for (const double slope : {0.02, 0.1, 0.2}) press_ball({.slope = slope});
  print_title("  stiffness of the contact");
  for (const double stiffness : {50.0, 800.0}) press_ball({.stiffness = stiffness});
  print_title("  a far side that is held");
  for (const double extent : {10.0, 20.0, 40.0})
    press_ball({.mesh = {.extent = extent}, .held = true});
  print_title("  cells");
  for (const int cells : {6, 8}) press_ball({.mesh = {.cells = cells}});
}

}  // namespace palpate::bench
