// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "half_space.h"
#include "mindlin.h"
#include "report.h"
#include "solid_meshes.h"
#include "validation.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

const std::vector<double> kAcross{0.04, 0.12, 0.25};  // [normal force]

enum class Loop { line, circle };

// The work of a tip that goes round, over the sum of its amounts. The second round counts: in the
// first, points find the places at which they stick.
double lost_part(const probing::ContactEquilibrium& solid, const probing::ContactState& pressed,
                 double across, Loop loop) {
  constexpr int kSteps = 16;
  const double normal = pressed.force.z();
  const auto force = [&](int i) {
    const double angle = 2 * std::numbers::pi * i / kSteps;
    return Vector3d(across * std::cos(angle), loop == Loop::line ? 0 : across * std::sin(angle),
                    normal);
  };
  probing::ContactState at = converged(solid.apply_force(pressed, force(0)));
  double work = 0, amount = 0;
  for (int i = 1; i <= 2 * kSteps; ++i) {
    const probing::ContactState next = converged(solid.apply_force(at, force(i)));
    const double part = (at.force + next.force).dot(next.tip - at.tip) / 2;
    if (i > kSteps) {
      work += part;
      amount += std::abs(part);
    }
    at = next;
  }
  return work / amount;
}

void measure_loops(const std::string& what, const probing::ContactEquilibrium& solid,
                   const probing::ContactState& pressed, const std::vector<double>& parts) {
  for (const double part : parts) {
    for (const Loop loop : {Loop::line, Loop::circle}) {
      print_line(what + (loop == Loop::line ? ", +-" : ", circle of ") + short_text(100 * part) +
                     " % of the normal force",
                 lost_part(solid, pressed, part * pressed.force.z(), loop));
    }
  }
}

void measure_half_space() {
  constexpr double kRadius = 20 * kContactRadius;  // [mm]
  const probing::Hyperelastic material = material_of(0.49);
  const probing::ContactEquilibrium solid(
      half_space(material, {}), {.tip_radius = kRadius, .stiffness = 200, .tolerance = 1e-9});
  const probing::ContactState start = solid.touch(Vector3d::Zero(), Vector3d::UnitZ());
  measure_loops("half-space, a/R 0.05", solid,
                converged(solid.apply_force(start, {0, 0, hertz_force(material, kRadius)})),
                {0.25});
}

void measure_block(int cells, int layers) {
  probing::DeformableBody body;
  body.mesh = probing::box_mesh(support::evenly(-20, 20, cells), support::evenly(-20, 20, cells),
                                support::evenly(0, 16, layers));
  body.materials = {{.shear_modulus = 0.05, .bulk_modulus = 0.5}};
  support::support_where(body, [](const Vector3d& at) { return at.z() == 16; });
  const probing::ContactEquilibrium solid(std::move(body), {.tolerance = 1e-9});
  const probing::ContactState start = solid.touch({1.5, -2, 0}, Vector3d::UnitZ());
  measure_loops("block, cells of " + short_text(40.0 / cells) + " mm, 1.2 N", solid,
                converged(solid.apply_force(start, {0, 0, 1.2})), kAcross);
}

}  // namespace

void measure_sticking_loops() {
  print_title("Part of the work that a sticking tip loses in a cycle (exact: 0)");
  measure_half_space();
  measure_block(4, 2);
  measure_block(8, 3);
  print_title("  for comparison: what friction of 0.8 would lose, by Mindlin and Deresiewicz");
  const MindlinContact any{.limit = 1, .compliance = 1, .radius = 1};
  for (const double part : kAcross) {
    const double of_limit = part / 0.8;
    print_line("+-" + short_text(100 * part) + " % of the normal force",
               mindlin_loss(any, of_limit) / (2 * of_limit * mindlin_displacement(any, of_limit)));
  }
}

}  // namespace palpate::bench
