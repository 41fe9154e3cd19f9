// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <string>

#include "report.h"
#include "solid_meshes.h"
#include "validation.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

struct Ball {
  double radius, friction, shear_modulus;  // [mm], -, [N/mm^2]
  double width, height;                    // [mm] of the block
  int cells, layers;
};

// [N] The tangential force from which on no equilibrium is found.
double sliding_force(probing::ContactSeries& presses, double normal, double friction) {
  constexpr double kInterval = 0.01;                       // of the normal force
  const Vector3d across(std::cos(0.2), std::sin(0.2), 0);  // along no line of the mesh
  double held = 0, slid = std::tan(std::atan(friction) + 0.15) * normal;
  while (slid - held > kInterval * normal) {
    const double tried = (held + slid) / 2;
    const probing::ContactResult found =
        presses.apply_force(normal * Vector3d::UnitZ() + tried * across);
    (found.stop == probing::ContactStop::converged ? held : slid) = tried;
  }
  return (held + slid) / 2;
}

void slide(const Ball& ball) {
  probing::DeformableBody body;
  const double side = ball.width / 2;
  body.mesh = probing::box_mesh(support::evenly(-side, side, ball.cells),
                                support::evenly(-side, side, ball.cells),
                                support::evenly(0, ball.height, ball.layers));
  body.materials = {{.shear_modulus = ball.shear_modulus, .bulk_modulus = 20 * ball.shear_modulus}};
  support::support_where(body, [&](const Vector3d& at) { return at.z() == ball.height; });
  const probing::ContactEquilibrium solid(std::move(body),
                                          {.tip_radius = ball.radius, .friction = ball.friction});
  const probing::ContactState start = solid.touch(Vector3d::Zero(), Vector3d::UnitZ());
  for (const double normal : {0.15, 0.5, 1.1}) {
    probing::ContactSeries presses(solid, start);
    const double depth =
        (converged(presses.apply_force(normal * Vector3d::UnitZ())).tip - start.tip).z();
    print_line("ball of " + short_text(ball.radius) + " mm, " + short_text(ball.shear_modulus) +
                   " N/mm^2, " + short_text(normal) + " N, depth " + short_text(depth) + " mm",
               sliding_force(presses, normal, ball.friction) / normal, ball.friction);
  }
}

}  // namespace

void measure_slides() {
  print_title("Tangential over normal force at which a ball slides; exact: of a point");
  slide({5, 0.9, 0.05, 40, 15, 8, 3});
  slide({5, 0.9, 0.02, 40, 15, 8, 3});
  slide({5, 0.4, 0.05, 40, 15, 8, 3});
  slide({4, 0.6, 0.05, 36, 14, 8, 3});
  slide({5, 0.9, 0.05, 40, 15, 12, 5});
}

}  // namespace palpate::bench
