// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include "report.h"
#include "solid_meshes.h"
#include "validation.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

// Displacements of a tip of 5 mm on a block of 32 x 32 x 12 mm.
std::vector<Vector3d> displacements(double cell, const std::vector<Vector3d>& places,
                                    const std::vector<Vector3d>& forces) {
  const int across = static_cast<int>(32 / cell), deep = static_cast<int>(12 / cell);
  probing::DeformableBody body;
  body.mesh = probing::box_mesh(support::evenly(-16, 16, across), support::evenly(-16, 16, across),
                                support::evenly(0, 12, deep));
  body.materials = {{.shear_modulus = 0.05, .bulk_modulus = 1}};
  support::support_where(body, [](const Vector3d& at) { return at.z() == 12; });
  const probing::ContactEquilibrium solid(std::move(body), {.load_steps = 2});
  std::vector<Vector3d> result;
  for (const Vector3d& place : places) {
    const probing::ContactState start = solid.touch(place, Vector3d::UnitZ());
    for (const Vector3d& force : forces)
      result.push_back(converged(solid.apply_force(start, force)).tip - start.tip);
  }
  return result;
}

}  // namespace

void compare_with_halved_mesh() {
  print_title("Displacement [mm] with cells of 4 mm (found) and of 2 mm (exact), tip of 5 mm");
  const std::vector<Vector3d> places{{0, 0, 0}, {1.3, -2.2, 0}, {7, 5, 0}};
  const std::vector<Vector3d> forces{{0, 0, 0.3}, {0, 0, 1.2}, {0.5, -0.2, 1.2}};
  const auto coarse = displacements(4, places, forces), fine = displacements(2, places, forces);
  for (std::size_t i = 0; i < fine.size(); ++i) {
    const Vector3d &place = places[i / forces.size()], &force = forces[i % forces.size()];
    const std::string what = "at (" + short_text(place.x()) + ", " + short_text(place.y()) +
                             ") mm, force (" + short_text(force.x()) + ", " +
                             short_text(force.y()) + ", " + short_text(force.z()) + ") N";
    print_line(what, coarse[i].norm(), fine[i].norm());
    print_line("  difference of the vectors, relative",
               (coarse[i] - fine[i]).norm() / fine[i].norm());
  }
}

}  // namespace palpate::bench
