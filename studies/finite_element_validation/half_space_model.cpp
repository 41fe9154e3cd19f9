// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/half_space_model.h"

#include <string>
#include <vector>

#include "half_space.h"
#include "report.h"
#include "solid_meshes.h"
#include "validation.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

constexpr double kModelPoisson = 0.45;
const probing::Contact kOrigin{.id = 0, .position = Vector3d::Zero(), .normal = -Vector3d::UnitZ()};

haptics::HalfSpaceModel model_of(const probing::Hyperelastic& material) {
  return {.young_modulus = probing::young_modulus(material),
          .poisson_ratio = probing::poisson_ratio(material),
          .tool_radius = kContactRadius};
}

// The end of the tool as a disk of the surface that is moved.
void move_disk(const char* what, const Vector3d& displacement) {
  const double a = kContactRadius;
  // Layers that are thin beside the edge of the disk, where stresses are singular.
  const std::vector<double> radii{0.85 * a, a,     1.08 * a, 1.25 * a, 1.7 * a,
                                  3 * a,    6 * a, 12 * a,   24 * a,   48 * a};
  probing::DeformableBody body;
  constexpr double kBox = 0.42;  // [a]
  body.mesh = support::half_ball_mesh(kBox * a, 6, radii);
  body.materials = {material_of(kModelPoisson)};
  constexpr double kOnSphere = 1e-9;
  const auto on_disk = [&](const Vector3d& at) {
    return at.z() < kOnSphere && at.norm() < a * (1 + kOnSphere);
  };
  support::support_where(body, [&](const Vector3d& at) {
    return on_disk(at) || at.norm() > radii.back() * (1 - kOnSphere);
  });
  support::move_supports(body, [&](const Vector3d& at) -> Vector3d {
    return on_disk(at) ? displacement : Vector3d::Zero();
  });
  const haptics::HalfSpaceModel model = model_of(body.materials[0]);
  const probing::ContactEquilibrium solid(std::move(body));
  Vector3d held = Vector3d::Zero();
  const Eigen::Matrix3Xd forces = support::node_forces(solid.body(), solid.rest());
  for (const int node : solid.body().supported)
    if (on_disk(solid.body().mesh.nodes.col(node))) held += forces.col(node);
  const Vector3d direction = displacement.normalized();
  print_line(what, held.dot(direction),
             haptics::force(model, kOrigin, displacement).dot(direction));
}

// A ball that sticks has, for small changes of force, the stiffness of a disk of the size of its
// contact.
void drag_sticking_ball() {
  constexpr double kSlope = 0.05;   // a / R
  constexpr double kChange = 0.01;  // of the normal force
  const double radius = kContactRadius / kSlope;
  const probing::Hyperelastic material = material_of(kModelPoisson);
  const double normal = hertz_force(material, radius);
  const probing::ContactEquilibrium solid(half_space(material, {.extent = 40}),
                                          {.tip_radius = radius, .stiffness = 200});
  const probing::ContactState start = solid.touch(Vector3d::Zero(), Vector3d::UnitZ());
  const probing::ContactState pressed = converged(solid.apply_force(start, Vector3d(0, 0, normal)));
  const haptics::HalfSpaceModel model = model_of(material);
  for (const Vector3d& direction : {Vector3d(Vector3d::UnitZ()), Vector3d(Vector3d::UnitX())}) {
    const Vector3d change = kChange * normal * direction;
    const Vector3d moved =
        converged(solid.apply_force(pressed, pressed.force + change)).tip - pressed.tip;
    print_line(direction.z() > 0 ? "sticking ball, further along the normal: stiffness [N/mm]"
                                 : "sticking ball, across: stiffness [N/mm]",
               kChange * normal / moved.dot(direction),
               kChange * normal / haptics::displacement(model, kOrigin, change).dot(direction));
  }
}

}  // namespace

void compare_with_half_space_model() {
  print_title("HalfSpaceModel (far side held at 48 and 40 contact radii)");
  constexpr double kSmall = 1e-3 * kContactRadius;
  move_disk("round punch, along the normal: force [N]", kSmall * Vector3d::UnitZ());
  move_disk("round punch, across: force [N]", kSmall * Vector3d::UnitX());
  drag_sticking_ball();
}

}  // namespace palpate::bench
