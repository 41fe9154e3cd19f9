// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <limits>
#include <optional>

#include "palpate/core/fields.h"
#include "palpate/geometry/eigen_alignment.h"

namespace palpate::haptics {

/// [N/mm] The stiffest spring that a sampled loop renders without giving energy: b / (T/2 + T_d)
/// (Colgate and Schenkel 1997, with delay).
/// \param damping [N s/mm] of the device, \param period [s], \param delay [s] from a measurement to
/// the force that answers it, beyond the hold of the period.
[[nodiscard]] double passive_stiffness(double damping, double period, double delay) noexcept;

/// [N s/mm] The damping with which a spring of this stiffness is passive.
[[nodiscard]] double passive_damping(double stiffness, double period, double delay) noexcept;

/// [N/mm] The stiffest spring that can balance a hand at rest, whatever its force: 2 c / q. The
/// encoder turns the spring's force into steps of K q, and dry friction c holds half a step. On a
/// stiffer one a hand between two steps never rests. With a damping for `passive_stiffness`, the
/// loop up to this one gives no energy at all, as friction takes what an error of q/2 gives (Abbott
/// and Okamura 2005; Diolaiti et al. 2006).
/// \param friction c [N] of the device, \param resolution q [mm] of its encoders; infinite for 0.
[[nodiscard]] double quiet_stiffness(double friction, double resolution) noexcept;

/// [N] The dry friction with which a spring of this stiffness is quiet: K q / 2.
[[nodiscard]] double quiet_friction(double stiffness, double resolution) noexcept;

/// A spring between the device and a massless tool, which alone touches the model (Colgate, Stanley
/// and Brown 1995). The device never feels more than this spring, however stiff the model is. The
/// meaning, unit and range of each field stand in its list, `visit`, where their names begin with
/// "coupling".
struct CouplingOptions {
  bool on = true;
  std::optional<double> stiffness = {};  ///< [N/mm] at the device
  double safety = 0.5;
  double least_damping = 5e-4;
  double tolerance = 1e-3;
  int most_steps = 8;
};

void visit(CouplingOptions& options, FieldVisitor& visitor);

/// \throws InvalidInput on an option outside its range, or one that another makes meaningless.
void check_coupling(const CouplingOptions& options);

/// [N/mm] The stiffness of the spring, at the device.
[[nodiscard]] double coupling_stiffness(const CouplingOptions& options, double damping,
                                        double period, double delay) noexcept;

/// State that the spring keeps from one tick to the next.
struct CouplingState {
  bool known = false;  ///< false before the first tick
  bool touching = false;
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();       ///< [mm]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();      ///< [N] of the model on the user there
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();  ///< [N/mm] of the model, as it showed
};

struct CoupledTool {
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();   ///< [mm]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] of the spring on the user
  double residual = 0;  ///< [N] by which the forces of spring and model differ
};

/// Finds the tool at which spring and model balance, by Broyden's method between tools that touch.
/// If it does not in this tick, it continues in the next one; the force is that of the spring.
/// \param stiffness [N/mm] > 0 of the spring. \param device [mm]
/// \param model gives the force on the user [N] of a tool; the last call is with the tool found.
template <typename Model>
[[nodiscard]] CoupledTool couple(const CouplingOptions& options, double stiffness,
                                 const Eigen::Vector3d& device, CouplingState& state,
                                 Model&& model) noexcept;

// Implementation

template <typename Model>
CoupledTool couple(const CouplingOptions& options, double stiffness, const Eigen::Vector3d& device,
                   CouplingState& state, Model&& model) noexcept {
  const Eigen::Matrix3d spring = stiffness * Eigen::Matrix3d::Identity();
  // The step to where the spring balances a model with the stiffness observed so far.
  const auto step = [&](const Eigen::Vector3d& residual) -> Eigen::Vector3d {
    const Eigen::Vector3d full = (spring + state.stiffness).inverse() * residual;
    // Unless that leads up the residual or too far, as after a slip: then as if the model were
    // soft.
    const Eigen::Vector3d soft = residual / stiffness;
    return full.dot(residual) > 0 && full.norm() < 2 * soft.norm() ? full : soft;
  };
  // The model is at least this stiff along a path on which it takes its force back.
  const auto raise = [&](const Eigen::Vector3d& way, const Eigen::Vector3d& force, double factor) {
    const double square = way.squaredNorm();
    if (square == 0) return;
    const double seen = way.dot(state.stiffness * way) / square;
    const double least = factor * force.dot(way) / square;
    if (least > seen) state.stiffness += (least - seen) / square * way * way.transpose();
  };
  constexpr double kBeyondSecant = 4;  // each step that left the object is shortened by this factor
  if (!state.touching) state.stiffness.setZero();
  // The latest tool that touched, and the next tool to try.
  bool has_inside = state.touching;
  Eigen::Vector3d inside = state.tool, inside_force = state.force;
  bool tried_device = !state.touching;
  Eigen::Vector3d tool = device;
  if (state.touching) tool = inside + step(stiffness * (device - inside) + inside_force);

  CoupledTool best{.residual = -1};
  Eigen::Vector3d best_force = Eigen::Vector3d::Zero();
  bool last_is_best = true;
  for (int i = 0; i < options.most_steps && tool.allFinite(); ++i) {
    const Eigen::Vector3d force = model(tool);
    const Eigen::Vector3d residual = stiffness * (device - tool) + force;
    const double length = residual.norm();
    last_is_best = length >= 0 && (best.residual < 0 || length < best.residual);
    if (!(length >= 0)) break;  // NaN
    if (last_is_best) {
      best = {tool, stiffness * (tool - device), length};
      best_force = force;
    }
    if (length <= options.tolerance) break;
    if (!force.isZero(0)) {
      const Eigen::Vector3d way = tool - inside;
      if (has_inside && way.squaredNorm() > 0) {
        state.stiffness -=
            (force - inside_force + state.stiffness * way) * way.transpose() / way.squaredNorm();
      } else if (!has_inside && state.known) {
        raise(state.tool - tool, force, 1);  // it was free in the tick before
      }
      has_inside = true;
      inside = tool;
      inside_force = force;
      tool += step(residual);
    } else if (!tried_device) {
      tried_device = true;
      tool = device;  // the user left the object
    } else {
      raise(tool - inside, inside_force, kBeyondSecant);
      tool = inside + step(stiffness * (device - inside) + inside_force);
    }
  }
  if (best.residual < 0) {  // the model's force is not finite
    state = {};
    return {device, Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()), 0};
  }
  if (!last_is_best) static_cast<void>(model(best.tool));
  state.known = true;
  state.touching = !best_force.isZero(0);
  state.tool = best.tool;
  state.force = best_force;
  return best;
}

}  // namespace palpate::haptics
