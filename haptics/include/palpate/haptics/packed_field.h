// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "palpate/haptics/blended_field.h"

namespace palpate::haptics {

/// The same number of four contacts, or of four bases: one register of AVX2, two of SSE2.
struct alignas(32) Lanes {
  std::array<double, 4> of{};
};

/// One place of a `PackedField`, ready for any displacement. A value; belongs to the field that
/// made it, and may be passed to it again for the next place, which is then faster if the same
/// contacts have weight there.
struct PlaceField {
  /// The contribution of a contact to any place: 63 numbers (`packed_field.cpp` lists them).
  static constexpr int kConstants = 63;
  static constexpr int kPacks = 3;  ///< of four contacts: `ContactWeights::kMaxCount` fits

  std::uint64_t owner = 0;    ///< which `PackedField`; 0 for none
  int count = 0;              ///< contacts with weight; 0: nothing is known at the place
  double friction = 0;        ///< coefficient
  double load_exponent = 0;   ///< of the friction, as in `ContactModel`
  double friction_force = 0;  ///< [N] as in `Model`
  Eigen::Vector3d cone_axis = Eigen::Vector3d::UnitZ();  ///< unit, of the friction cone; inwards
  Eigen::Vector3d friction_axis = Eigen::Vector3d::UnitZ();  ///< as in `Blend`, of any length

  std::array<int, 4 * kPacks> contacts{};  ///< the first `count`
  std::array<std::array<Lanes, kConstants>, kPacks> constants{};
  /// Maps a displacement in the world to that of each contact in its pressing frame, row by row.
  std::array<std::array<Lanes, 9>, kPacks> to_local{};
  std::array<Lanes, kPacks>
      scale{};  ///< of each contact's energy: weight times `FieldWarp::energy`
};

/// Force and elastic energy at a displacement.
struct FieldForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] on the OBJECT, world
  double energy = 0;                                ///< [N mm]
};

/// A `BlendedField` for real-time loops: the same forces to 1e-11 N, in about a fifth of the time.
///
/// Contacts and bases are computed four at a time, with AVX2 if the processor has it; both ways
/// give the same bits. The part that does not depend on the displacement is kept in a `PlaceField`.
/// If the closed form does not hold at a place (`BlendRule::forces`, a contact without compliance,
/// nearly opposite inward normals), `BlendedField` blends it. Thread-safe; real-time safe after
/// construction.
class PackedField {
 public:
  /// \throws InvalidInput if `check_model` rejects the model.
  explicit PackedField(const Model& model);

  /// Moves `place` to a point of the surface. \param position [mm] the same point.
  void move_to(const geometry::SurfacePoint& point, const Eigen::Vector3d& position,
               PlaceField& place) const noexcept;

  /// Force and energy; zero for a displacement that is not finite.
  [[nodiscard]] FieldForce force(const PlaceField& place,
                                 const Eigen::Vector3d& displacement) const noexcept;

  /// With the part that depends on the rate (rate_law.h). \param delayed displacements, in the
  /// world.
  [[nodiscard]] FieldForce force(const PlaceField& place, const Eigen::Vector3d& displacement,
                                 const DelayedDisplacements& delayed) const noexcept;

  /// Dependence of forces on the rate; empty if there is none.
  [[nodiscard]] std::span<const RateTerm> rate() const noexcept { return rate_; }

  [[nodiscard]] std::uint64_t id() const noexcept { return id_; }
  [[nodiscard]] const BlendedField& blended() const noexcept { return blended_; }

  /// Four isotropic bases of one contact, in its pressing frame. Padded with weight 0.
  struct IsotropicBases {
    Lanes weight, squared_epsilon;
    std::array<Lanes, 3> center;
  };
  /// Four ridges: |ridge| = 1, offset = ridge . center.
  struct RidgeBases {
    Lanes weight, squared_epsilon, offset;
    std::array<Lanes, 3> ridge;
  };
  /// The range of the bases of a contact, in groups of four.
  struct BaseRange {
    int first_isotropic = 0, isotropic_end = 0, first_ridge = 0, ridge_end = 0;
  };

 private:
  BlendedField blended_;
  std::vector<IsotropicBases> isotropic_;
  std::vector<RidgeBases> ridges_;
  std::vector<BaseRange> ranges_;                                      // by contact
  std::vector<std::array<double, PlaceField::kConstants>> constants_;  // by contact
  std::vector<Eigen::Matrix3d> local_to_pressing_;                     // by contact
  double reach_ = 0, friction_force_ = 0;
  std::vector<RateTerm> rate_;
  std::uint64_t id_;
  bool by_compliance_ = false;
  std::vector<char> has_compliance_;  // by contact

  void pack(const ContactModel& contact);
  void select(const geometry::ContactWeights& weights, PlaceField& place) const noexcept;
  void copy_blend(const geometry::SurfacePoint& point, PlaceField& place) const noexcept;
};

/// The same as for a `Blend`.
[[nodiscard]] FrictionParts friction_parts(const PlaceField& at,
                                           const Eigen::Vector3d& force) noexcept;

}  // namespace palpate::haptics
