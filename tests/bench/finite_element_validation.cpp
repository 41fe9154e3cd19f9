// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Compares the contact of finite elements with closed forms that need larger meshes than tests
// have time for: Hertz, Cattaneo and Mindlin, and the energy that a sticking tip loses in a loop.
// Prints the figures of docs/probing.md.
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "palpate/probing/contact_equilibrium.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kRadius = 20;  // [mm] of the tip
constexpr double kContact = 2;  // [mm] radius of the contact that forces are chosen for

// Fine cells about the middle, growing outwards to `far`.
std::vector<double> graded(double cell, double fine, double growth, double far, bool both) {
  std::vector<double> right{0};
  while (right.back() < fine - cell / 2) right.push_back(right.back() + cell);
  for (double size = cell; right.back() < far;) {
    size *= growth;
    right.push_back(right.back() + size);
  }
  std::vector<double> result;
  if (both)
    for (std::size_t i = right.size() - 1; i > 0; --i) result.push_back(-right[i]);
  result.insert(result.end(), right.begin(), right.end());
  return result;
}

// A block at least 20 contact radii deep and wide to each side, held at its lower side and its
// flanks.
DeformableBody half_space(double cell, double growth) {
  DeformableBody body;
  const auto across = graded(cell, 1.5 * kContact, growth, 20 * kContact, true);
  body.mesh = box_mesh(across, across, graded(cell, kContact, growth, 20 * kContact, false));
  body.materials = {{.shear_modulus = 0.04, .bulk_modulus = 0.04 * 13 / 6}};  // nu = 0.3
  const Vector3d low = body.mesh.nodes.rowwise().minCoeff();
  const Vector3d high = body.mesh.nodes.rowwise().maxCoeff();
  for (int n = 0; n < body.mesh.nodes.cols(); ++n) {
    const Vector3d at = body.mesh.nodes.col(n);
    if (at.z() == high.z() || (at.head<2>().array() == low.head<2>().array()).any() ||
        (at.head<2>().array() == high.head<2>().array()).any())
      body.supported.push_back(n);
  }
  return body;
}

void report(const char* what, double found, double exact) {
  std::printf("%-52s %10.5f %10.5f %+7.2f %%\n", what, found, exact, 100 * (found / exact - 1));
  std::fflush(stdout);
}

void hertz_and_mindlin(double cell, double growth, double stiffness) {
  const DeformableBody body = half_space(cell, growth);
  const double nu = poisson_ratio(body.materials[0]), e = young_modulus(body.materials[0]);
  const double plane = e / (1 - nu * nu), g = body.materials[0].shear_modulus;
  const double force = 4.0 / 3 * plane * std::pow(kContact, 3) / kRadius;
  constexpr double kFriction = 0.5;
  const ContactEquilibrium solid(
      body, {.tip_radius = kRadius, .friction = kFriction, .stiffness = stiffness});
  std::printf("cells of %.2f contact radii, contact stiffness %g, %d nodes\n", cell / kContact,
              stiffness, static_cast<int>(body.mesh.nodes.cols()));
  const ContactState start = solid.touch(Vector3d::Zero(), Vector3d::UnitZ());
  const ContactEquilibrium smooth(body,
                                  {.tip_radius = kRadius, .friction = 0, .stiffness = stiffness});
  for (const double part : {0.5, 1.0}) {
    const ContactResult pressed = smooth.apply_force(start, Vector3d(0, 0, part * force));
    report(part < 1 ? "Hertz, half the force: depth [mm]" : "Hertz: depth [mm]",
           pressed.state.tip.z() - start.tip.z(),
           std::pow(kContact * kContact * kContact * part, 2.0 / 3) / kRadius);
  }
  ContactState at = solid.apply_force(start, Vector3d(0, 0, force)).state;
  const double before = at.tip.x();
  for (const double part : {0.3, 0.6, 0.8, 0.9}) {
    const ContactResult dragged =
        solid.apply_force(at, Vector3d(part * kFriction * force, 0, force));
    if (dragged.stop != ContactStop::converged)
      std::printf("not converged: %s\n", to_string(dragged.stop));
    at = dragged.state;
    const std::string what =
        "Mindlin at " + std::to_string(part).substr(0, 3) + " of the limit: displacement [mm]";
    report(
        what.c_str(), at.tip.x() - before,
        3 * kFriction * force * (2 - nu) / (16 * g * kContact) * (1 - std::pow(1 - part, 2.0 / 3)));
  }
}

}  // namespace
}  // namespace palpate::probing

int main() {
  using palpate::probing::hertz_and_mindlin;
  std::printf("%-52s %10s %10s\n", "", "found", "exact");
  hertz_and_mindlin(1, 3, 200);
  hertz_and_mindlin(1, 3, 50);
  hertz_and_mindlin(0.667, 2.2, 200);
}
