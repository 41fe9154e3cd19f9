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

/// How a contact's field becomes that of another place: p(x) = energy p_k(displacement x), and so
/// f(x) = energy displacement^T f_k(displacement x).
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

/// The force field at any place of the surface, in blended frames (thesis 5.3.2.2).
///
/// f(c, delta) = R_c sum_k w_k beta_k A_k^T g_k(A_k R_c^T delta); the weights w_k are those of
/// `geometry::ContactLocator`, in place of barycentric coordinates on flat triangles.
/// With `BlendRule::forces` R_c is the (Karcher) mean of the contacts' frames, A_k = I and
/// beta_k = 1: Eq 5.10. That lets a stiff neighbour resist displacements far beyond its own, and
/// jumps where frames differ by about half a turn and have no single mean, as x axes of contacts
/// must somewhere on a closed surface.
/// With `BlendRule::compliances` every field is carried to the place by the smallest turn T_k of
/// the inward normal there, so that its x axis does not matter, and warped to yield to the
/// reference force as the place does, whose compliance (u, c) is interpolated by the contacts'
/// trends (docs/model-file.md has the formula). R_c has as z axis the mean of the inward normals.
/// With (u_k, c_k) that of contact k in R_c, beta_k = u_z / u_kz, and A_k = B_k M_k: M_k maps u to
/// u_k, has the third row (0, 0, 1 / beta_k) and the upper left block (c_k # c^-1) / sqrt(beta_k),
/// # the geometric mean of matrices; B_k = (T_k R_k)^T R_c leads to the local frame R_k of the
/// contact, which g_k is in. Either way the force is the gradient of sum_k w_k beta_k p_k(A_k R_c^T
/// delta): energies stay convex, and so nowhere below zero, if the contacts' are (a certified one
/// may be led out of the ball it is certified in); at a contact it is the contact's own field; and
/// it is continuous along the surface. It is the force of the tool ON THE OBJECT; what a user feels
/// is its opposite. A place outside all triangles of contacts has the weights that the
/// triangulation gave it. Real-time safe once made; thread-safe. A place that is not finite gives
/// zero force; a place off the surface has the force of the nearest one on it.
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
