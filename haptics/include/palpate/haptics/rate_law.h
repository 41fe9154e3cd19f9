// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::haptics {

/// A part of an object's force that fades with time.
struct RateTerm {
  double share = 0;  ///< > 0, of the force that stays, right after a sudden displacement
  double time = 1;   ///< [s] > 0, in which it fades to 1/e where the force is linear

  friend bool operator==(const RateTerm&, const RateTerm&) = default;
};

/// The memory of an object of its motion: the delayed displacement of each term.
struct DelayedDisplacements {
  static constexpr std::size_t kMost = 2;  ///< terms
  std::array<Eigen::Vector3d, kMost> of = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
};

// How force depends on the rate of displacement: a generalised Maxwell solid with the forces of a
// field F = grad E. At the displacement u, with the delayed displacements z_i,
//
//     f = F(u) + sum_i g_i F(u - z_i),    dz_i/dt = (u - z_i) / tau_i,
//
// with g_i = `share` and tau_i = `time`. At rest, z_i = u and the force is that of the field. For
// displacements so small that F is linear, this is quasi-linear viscoelasticity with a Prony
// series: a sudden displacement u gives F(u) (1 + sum_i g_i exp(-t / tau_i)).
//
// It is passive where E is convex with its minimum E(0) = 0, for any motion. The stored energy
// S = E(u) + sum_i g_i E(u - z_i) is >= 0, and
//
//     dS/dt = F(u).du/dt + sum_i g_i F(u - z_i).(du/dt - dz_i/dt)
//           = f.du/dt - sum_i g_i / tau_i F(u - z_i).(u - z_i),
//
// where each last term is >= 0, because for a convex E with its minimum at 0
// F(w).w >= E(w) - E(0) >= 0. So f.du/dt, the power that is put in, is at least dS/dt. The same
// holds for steps: with z held, the work of a motion is the change of S; `relax`, with u held, only
// shrinks w = u - z to part of itself, and E(part w) <= part E(w).

/// Force right after a sudden displacement over the force that stays: 1 + sum g_i.
[[nodiscard]] double force_at_once(std::span<const RateTerm> terms) noexcept;

/// Moves the delayed displacements on by a time in which the displacement stays: exactly.
/// Real-time safe. \param seconds a time that is not > 0 changes nothing.
void relax(std::span<const RateTerm> terms, const Eigen::Vector3d& displacement, double seconds,
           DelayedDisplacements& delayed) noexcept;

/// The path of a tool at one contact over time; it moves at constant velocity between moments.
struct ToolHistory {
  std::vector<double> time;        ///< [s] N, ascending
  Eigen::Matrix3Xd displacements;  ///< [mm] 3 x N
  /// N: a new path begins here, at zero displacement and without memory of the previous one.
  std::vector<bool> begins;
};

/// [mm] u - z_i of a term at each moment of a path, 3 x N: exactly. A new path begins with a touch:
/// the tool has come from zero displacement as fast as it goes on, or, if it does not go deeper, at
/// once. \param time [s] of the term.
[[nodiscard]] Eigen::Matrix3Xd displacement_ahead(const ToolHistory& path, double time);

}  // namespace palpate::haptics
