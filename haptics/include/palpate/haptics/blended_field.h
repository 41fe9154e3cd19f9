// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "palpate/geometry/contact_locator.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// How the field of a contact is warped for another place: p(x) = energy p_k(displacement x), and
/// so f(x) = energy displacement^T f_k(displacement x).
struct FieldWarp {
  Eigen::Matrix3d displacement = Eigen::Matrix3d::Identity();
  double energy = 1;
};

/// What the model says at one place of the surface, whatever the displacement.
struct Blend {
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();        ///< of friction; z presses inwards
  Eigen::Matrix3d field_frame = Eigen::Matrix3d::Identity();  ///< R_c of `BlendedField`
  Eigen::Vector3d friction_axis = Eigen::Vector3d::UnitZ();   ///< unit, world
  double friction = 0;
  geometry::ContactWeights contacts;  ///< none: no such place, or nothing known there
  /// A_k and beta_k of `BlendedField`, of the first `contacts.count`.
  std::array<FieldWarp, geometry::ContactWeights::kMaxCount> warps{};
};

/// The force of the tool on the object at any place of the surface, for any displacement (thesis
/// 5.3.2.2). docs/model-file.md has the formulas step by step.
///
/// At a contact it is the contact's own force, and with `BlendRule::compliances` it is continuous
/// along the surface. A place off the surface has the force of the nearest place on it; a place
/// that is not finite has no force. Real-time safe once constructed; thread-safe.
//
// f(c, delta) = R_c sum_k w_k beta_k A_k^T g_k(A_k R_c^T delta), with the weights w_k of
// `geometry::ContactLocator`. It is the gradient of sum_k w_k beta_k p_k(A_k R_c^T delta), so the
// energy is convex if those of the contacts are.
//
// `BlendRule::forces`: R_c is the Karcher mean of the contacts' frames, A_k = I, beta_k = 1 (Eq
// 5.10). A stiff neighbour then resists displacements far beyond its own, and the force jumps where
// frames differ by about half a turn and have no single mean.
//
// `BlendRule::compliances`: R_c has the mean of the inward normals as z axis. Each field is carried
// to the place by the smallest turn T_k of its normal and warped so that it yields to the reference
// force as the place does, whose compliance (u, c) the contacts' trends give. With the compliance
// (u_k, c_k) of contact k in R_c, beta_k = u_z / u_kz and A_k = B_k M_k. M_k maps u to u_k and has
// the third row (0, 0, 1 / beta_k) and the upper left block (c_k # c^-1) / sqrt(beta_k), where # is
// the geometric mean of matrices. B_k = (T_k R_k)^T R_c leads to the local frame of the contact.
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
  geometry::TriangleMesh mesh_;
  Interpolation interpolation_;
  std::vector<Eigen::Matrix3d> pressing_frames_;
  geometry::SurfaceQuery surface_;
  geometry::ContactLocator locator_;

  void warp_fields(const geometry::SurfacePoint& place, Blend& at) const noexcept;
};

/// The parts of a force on the object along (f_N) and across (|f_T|) the axis of the friction cone.
struct FrictionParts {
  double normal = 0;
  double tangential = 0;
  double excess = 0;  ///< [N] |f_T| - mu f_N: > 0 means that the contact slips (Eq 5.16)
};
[[nodiscard]] FrictionParts friction_parts(const Blend& at, const Eigen::Vector3d& force) noexcept;

}  // namespace palpate::haptics
