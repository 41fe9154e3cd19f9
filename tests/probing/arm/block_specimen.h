// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <numbers>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/specimen.h"
#include "palpate/probing/virtual_arm.h"
#include "test_surfaces.h"

namespace palpate::probing::support {

/// A block with a flat top, the plane z = 0 for |x|, |y| <= 50 mm, that stiffens as it is pressed.
class BlockSpecimen final : public Specimen {
 public:
  explicit BlockSpecimen(double stiffness, double friction = 0.9)
      : stiffness_(stiffness), friction_(friction), mesh_(geometry::test::flat_sheet(20, 20, 5)) {
    mesh_.vertices.colwise() -= Eigen::Vector3d(50, 50, 0);
  }
  const geometry::TriangleMesh& surface() const override { return mesh_; }
  Eigen::Vector3d displacement(const Eigen::Vector3d&,
                               const Eigen::Vector3d& force) const override {
    const double softening = 1 / (1 + 0.1 * force.norm());
    return Eigen::Vector3d(force.x(), force.y(), 0.8 * force.z()) * softening / stiffness_;
  }
  FrictionCone friction_cone(const Eigen::Vector3d&) const override {
    return {.axis = -Eigen::Vector3d::UnitZ(), .coefficient = friction_};
  }

 private:
  double stiffness_, friction_;
  geometry::TriangleMesh mesh_;
};

/// An arm whose tip stands `height` [mm] above the middle of the block, y upwards.
inline VirtualArmOptions arm_above_block(double height) {
  VirtualArmOptions options;
  const Eigen::Vector3d p_base_block =
      tip_position(options.geometry, options.joints) - Eigen::Vector3d(0, height, 0);
  Eigen::Isometry3d T_base_world = Eigen::Isometry3d::Identity();
  T_base_world.linear() =
      Eigen::AngleAxisd(-std::numbers::pi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  T_base_world.translation() = p_base_block;
  options.T_world_base = T_base_world.inverse();
  return options;
}

}  // namespace palpate::probing::support
