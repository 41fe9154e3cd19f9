// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/contact_locator.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// What the model says at one place of the surface, whatever the displacement.
struct Blend {
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();       ///< blended R_c; z presses inwards
  Eigen::Vector3d friction_axis = Eigen::Vector3d::UnitZ();  ///< unit, world
  double friction = 0;
  geometry::ContactWeights contacts;  ///< none: no such place, or nothing known there
};

/// The force field at any place of the surface: Eq 5.10 in blended frames (thesis 5.3.2.2).
///
/// f(c, delta) = R_c sum_k w_k g_k(R_c^T delta), R_c the mean of the contacts' frames; the weights
/// w_k are those of `geometry::ContactLocator`, in place of barycentric coordinates on flat
/// triangles. It is the force of the tool ON THE OBJECT; what a user feels is its opposite.
/// Real-time safe once made; thread-safe. A place that is not finite gives zero force; a place off
/// the surface has the force of the nearest one on it.
class BlendedField {
 public:
  /// \throws InvalidInput if `check_model` refuses.
  explicit BlendedField(const Model& model);

  [[nodiscard]] Blend blend(const geometry::SurfacePoint& contact) const noexcept;
  [[nodiscard]] Blend blend(const Eigen::Vector3d& contact) const noexcept;
  [[nodiscard]] Eigen::Vector3d force(const Blend& at,
                                      const Eigen::Vector3d& displacement) const noexcept;
  [[nodiscard]] Eigen::Vector3d force(const Eigen::Vector3d& contact,
                                      const Eigen::Vector3d& displacement) const noexcept;

  [[nodiscard]] const geometry::SurfaceQuery& surface() const noexcept { return surface_; }

 private:
  std::vector<ContactModel> contacts_;
  geometry::SurfaceQuery surface_;
  geometry::ContactLocator locator_;
};

/// Parts of a force on the object against the friction cone: f_N along the cone's axis, |f_T|
/// across.
struct FrictionParts {
  double normal = 0;
  double tangential = 0;
  /// [N] |f_T| - mu f_N: > 0 means the contact does not hold (Eq 5.16)
  double excess = 0;
};
[[nodiscard]] FrictionParts friction_parts(const Blend& at, const Eigen::Vector3d& force) noexcept;

}  // namespace palpate::haptics
