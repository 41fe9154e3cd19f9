// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "palpate/geometry/contact_locator.h"
#include "palpate/geometry/error_growth.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Maps a contact's field to another place: p(x) = energy p_k(displacement x), and therefore
/// f(x) = energy displacement^T f_k(displacement x).
struct FieldWarp {
  Eigen::Matrix3d displacement = Eigen::Matrix3d::Identity();
  double energy = 1;
};

/// Properties of the model at one place of the surface, independent of the displacement.
struct Blend {
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();        ///< of friction; z points inwards
  Eigen::Matrix3d field_frame = Eigen::Matrix3d::Identity();  ///< R_c of `BlendedField`
  Eigen::Vector3d friction_axis = Eigen::Vector3d::UnitZ();   ///< unit, world
  double friction = 0;
  double load_exponent = 0;   ///< of the friction, as in `ContactModel`
  double friction_force = 0;  ///< [N] as in `Model`
  geometry::ContactWeights
      contacts;  ///< empty if there is no such place, or nothing is known there
  /// A_k and beta_k of `BlendedField`, of the first `contacts.count`.
  std::array<FieldWarp, geometry::ContactWeights::kMaxCount> warps{};
};

/// Error of the force, relative to it, for each unit by which the logarithm of the compliance of a
/// place differs from that of a contact.
inline constexpr double kContrastError = 0.17;

/// The force field at any place of the surface, in blended frames (thesis 5.3.2.2).
///
///     f(c, delta) = R_c sum_k w_k beta_k A_k^T g_k(A_k R_c^T delta)
///
/// The weights w_k are those of `geometry::ContactLocator` instead of barycentric coordinates on
/// flat triangles. The force is that of the tool ON THE OBJECT; a user feels its opposite.
///
/// `BlendRule::forces`: R_c is the Karcher mean of the contacts' frames, A_k = I, and beta_k = b is
/// the same for all: by how much the place is stronger than the weighted mean of its contacts, by
/// the trends of their strengths. With b = 1 this is Eq 5.10. With this rule a stiff neighbour
/// resists displacements far beyond its own, and the force jumps where frames differ by about half
/// a turn and have no single mean, which x axes of contacts must do somewhere on a closed surface.
///
/// `BlendRule::compliances`: every field is rotated to the place by the smallest rotation T_k of
/// the inward normal, so that its x axis does not matter, and warped to yield to the reference
/// force as the place does. The compliance (u, c) of the place is interpolated with the contacts'
/// trends (the formula is in docs/model-file.md). The z axis of R_c is the mean of the inward
/// normals. With the compliance (u_k, c_k) of contact k in R_c, beta_k = u_z / u_kz and A_k = B_k
/// M_k. M_k maps u to u_k, has the third row (0, 0, 1 / beta_k) and the upper left block (c_k #
/// c^-1) / sqrt(beta_k), where # is the geometric mean of matrices. B_k = (T_k R_k)^T R_c maps to
/// the local frame R_k of the contact, in which g_k is given.
///
/// With both rules
/// - the force is the gradient of sum_k w_k beta_k p_k(A_k R_c^T delta): energies stay convex, and
///   so >= 0, if the contacts' are (a certified field may be evaluated outside its certified ball);
/// - at a contact the field is the contact's own;
/// - the force is continuous along the surface.
///
/// A place outside all triangles of contacts has the weights that the triangulation gave it. A
/// place off the surface has the force of its nearest surface point; a place that is not finite has
/// zero force. Thread-safe; real-time safe after construction.
class BlendedField {
 public:
  /// \throws InvalidInput if `check_model` rejects the model.
  explicit BlendedField(const Model& model);

  [[nodiscard]] Blend blend(const geometry::SurfacePoint& contact) const noexcept;
  [[nodiscard]] Blend blend(const Eigen::Vector3d& contact) const noexcept;
  [[nodiscard]] Eigen::Vector3d force(const Blend& at,
                                      const Eigen::Vector3d& displacement) const noexcept;
  [[nodiscard]] Eigen::Vector3d force(const Eigen::Vector3d& contact,
                                      const Eigen::Vector3d& displacement) const noexcept;

  /// [N/mm] Derivative of the force by the displacement.
  [[nodiscard]] Eigen::Matrix3d stiffness(const Blend& at,
                                          const Eigen::Vector3d& displacement) const noexcept;

  /// [N] Standard error of the force at a place: the root of the expected squared length of its
  /// error. With the stiffness K_k and force f_k that contact k gives here, f = sum_k w_k f_k, and
  /// the contact's `ContactUncertainty` (force F, displacement D, across a, between b)
  ///
  ///     sum_k w_k (F_k^2 |A_k|^2 beta_k^2 / 3 + D_k^2 |K_k|^2 + a_k^2 |f_k across|^2)
  ///       + kContrastError^2 |f|^2 sum_k w_k log^2 beta_k
  ///       + (sum_k w_k b_k^2) s^geometry::kErrorGrowth |f|^2
  ///
  /// with Frobenius norms and s = `geometry::error_reach` along the surface. Empty if a contact
  /// there has no uncertainty, or there is no contact. Beyond the displacements that were measured
  /// the error may be larger.
  [[nodiscard]] std::optional<double> deviation(const geometry::SurfacePoint& contact,
                                                const Eigen::Vector3d& displacement) const noexcept;
  [[nodiscard]] std::optional<double> deviation(const Eigen::Vector3d& contact,
                                                const Eigen::Vector3d& displacement) const noexcept;

  /// Weights of the contacts at a place, as `blend` uses them.
  [[nodiscard]] geometry::ContactWeights weights(
      const geometry::SurfacePoint& contact) const noexcept {
    return locator_.locate(contact);
  }

  [[nodiscard]] const geometry::SurfaceQuery& surface() const noexcept { return surface_; }

 private:
  std::vector<ContactModel> contacts_;
  geometry::TriangleMesh mesh_;
  Interpolation interpolation_;
  double friction_force_;
  std::vector<Eigen::Matrix3d> pressing_frames_;
  geometry::SurfaceQuery surface_;
  geometry::ContactLocator locator_;

  void warp_fields(const geometry::SurfacePoint& place, Blend& at) const noexcept;
};

/// Components of a force on the object relative to the friction cone: f_N along its axis, and |f_T|
/// perpendicular to it.
struct FrictionParts {
  double normal = 0;
  double tangential = 0;
  /// [N] |f_T| - mu f_N: the contact slips if > 0 (Eq 5.16)
  double excess = 0;
};
[[nodiscard]] FrictionParts friction_parts(const Blend& at, const Eigen::Vector3d& force) noexcept;

}  // namespace palpate::haptics
