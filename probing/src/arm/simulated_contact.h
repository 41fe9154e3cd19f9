// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "palpate/geometry/surface_query.h"
#include "palpate/probing/specimen.h"

namespace palpate::probing {

/// A tip on a specimen, in the world frame. The object's displacement is linearised about the
/// latest force at which it was computed; its slope is updated by Powell's symmetric formula. The
/// specimen must outlive it, and may throw out of each function.
class SimulatedContact {
 public:
  /// \param structure [N/mm] between the encoders and the tip.
  SimulatedContact(const Specimen& specimen, double structure);

  /// Once in each tick, before the tip is moved: looks for the surface below it, or below the
  /// contact. \param tip [mm] by the encoders, as below.
  void find_surface(const Eigen::Vector3d& tip, std::uint64_t tick);
  /// [N] of the tip on the object, without damping; none if it does not press.
  [[nodiscard]] std::optional<Eigen::Vector3d> press(const Eigen::Vector3d& tip);
  /// Once in each tick, after the tip was moved: computes the displacement again where the force
  /// has changed, and lets the retarded part follow for `period` [s].
  void settle(double period);
  void leave() { touches_ = near_ = false; }

  [[nodiscard]] bool touches() const { return touches_; }
  [[nodiscard]] const Eigen::Vector3d& place() const { return place_; }  ///< [mm] on the surface
  [[nodiscard]] double slid() const { return slid_; }                    ///< [mm] since the touch

 private:
  [[nodiscard]] Eigen::Vector3d strain(const Eigen::Vector3d& tip) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> slide(const Eigen::Vector3d& tip,
                                                     const Eigen::Vector3d& tangential);
  void touch(const Eigen::Vector3d& tip);
  void refresh();
  void refresh_at(const Eigen::Vector3d& force);
  void creep(double period);
  void soften();

  const Specimen& specimen_;
  geometry::SurfaceQuery query_;
  Eigen::Matrix3Xd normals_;
  double structure_;  // [N/mm]
  Retardation retardation_;
  double prompt_;  // share of the displacement that is not retarded

  std::uint64_t tick_ = 0;
  bool near_ = false;  // the surface is within a tick's motion
  bool touches_ = false;
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();
  double slid_ = 0;
  Eigen::Vector3d surface_point_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d surface_normal_ = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d cone_place_ = Eigen::Vector3d::Zero();
  FrictionCone cone_;
  Eigen::Vector3d elastic_ = Eigen::Vector3d::Zero();       // [N] force without damping
  Eigen::Vector3d reference_ = Eigen::Vector3d::Zero();     // [N] force of the linearisation
  Eigen::Vector3d displacement_ = Eigen::Vector3d::Zero();  // [mm] under it
  Eigen::Vector3d late_ = Eigen::Vector3d::Zero();          // [mm] retarded part
  Eigen::Matrix3d slope_ = Eigen::Matrix3d::Zero();         // [mm/N]
  Eigen::Matrix3d softness_ = Eigen::Matrix3d::Zero();      // [mm/N] with the arm's structure
  Eigen::Matrix3d softness_inverse_ = Eigen::Matrix3d::Zero();
  std::uint64_t tick_of_reference_ = 0;
};

}  // namespace palpate::probing
