// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/device_stability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "palpate/core/quantile.h"
#include "palpate/core/require.h"

namespace palpate::haptics {
namespace {

double stiffness_of_contact(const ContactModel& contact, double highest_force) {
  constexpr double kDeepest = 20, kStep = 0.5;  // [mm]
  constexpr int kSides = 8;
  double largest = 0;
  const auto along = [&](const Eigen::Vector3d& direction) {
    for (double depth = 0; depth <= kDeepest; depth += kStep) {
      const Eigen::Vector3d displacement = depth * direction;
      if (force(contact.field, displacement).norm() > highest_force) return;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
          stiffness(contact.field, displacement), Eigen::EigenvaluesOnly);
      largest = std::max(largest, eigen.eigenvalues().maxCoeff());
    }
  };
  along(Eigen::Vector3d::UnitZ());
  for (int side = 0; side < kSides; ++side) {
    const double angle = 2 * std::numbers::pi * side / kSides;
    along(Eigen::Vector3d(std::cos(angle), std::sin(angle), 1).normalized());
  }
  return largest;
}

/// A motion along a line: how far it reaches, and how far it goes to and fro.
class Swing {
 public:
  void add(double place) {
    if (!any_) first_ = low_ = high_ = last_ = place;
    any_ = true;
    low_ = std::min(low_, place);
    high_ = std::max(high_, place);
    way_ += std::abs(place - last_);
    last_ = place;
  }
  [[nodiscard]] double range() const { return high_ - low_; }
  [[nodiscard]] double highest() const { return high_; }
  /// Without what leads on in one direction.
  [[nodiscard]] double to_and_fro() const { return way_ - std::abs(last_ - first_); }

 private:
  bool any_ = false;
  double first_ = 0, last_ = 0, low_ = 0, high_ = 0, way_ = 0;
};

}  // namespace

ModelStiffness model_stiffness(const Model& model, double highest_force) {
  check_model(model);
  require("model_stiffness: highest_force", highest_force, above(0).finite(), "N");
  std::vector<double> all;
  ModelStiffness result;
  for (const ContactModel& contact : model.contacts) {
    all.push_back(force_at_once(model.rate) * stiffness_of_contact(contact, highest_force));
    if (all.back() > result.largest) {
      result.largest = all.back();
      result.stiffest = contact.id;
    }
  }
  result.median = median(all);
  return result;
}

bool presses_calmly(const HandOptions& options, const CouplingOptions& coupling, double stiffness) {
  require("presses_calmly: stiffness", stiffness, above(0).finite(), "N/mm");
  check_coupling(coupling);
  constexpr double kPush = 1;             // [N]
  constexpr double kDecays = 12;          // duration relative to 2 m / b
  constexpr double kShortest = 1;         // [s]
  constexpr double kLongest = 20;         // [s] of hands without damping
  constexpr double kLess = 0.5;           // oscillation at the end relative to the beginning
  constexpr double kQuanta = 3;           // steps of the encoder that count as rest
  constexpr double kRest = 1e-3;          // [mm] that counts as rest with exact encoders
  constexpr double kKilogramHere = 1e-3;  // [N s^2/mm]
  HandOptions pressing = options;
  pressing.push = {0, 0, -kPush};
  pressing.highest_force = std::max(options.highest_force, 1e3 * kPush);
  SimulatedHand hand(TimedPath({{0, Eigen::Vector3d::Zero()}}), pressing);
  hand.activate();
  const auto wall = [&](const Eigen::Vector3d& tool) -> Eigen::Vector3d {
    return {0, 0, std::max(-stiffness * tool.z(), 0.0)};
  };
  const double spring = coupling_stiffness(coupling, options.damping, options.period(),
                                           options.delay * options.period());
  CouplingState state;
  const double decay = 2 * kKilogramHere * options.mass / options.damping;
  const double duration = std::clamp(kDecays * decay, kShortest, kLongest);
  const auto ticks = static_cast<long>(duration / options.period());
  Swing early, late;
  devices::DeviceState measured;
  for (long tick = 0; tick < ticks; ++tick) {
    static_cast<void>(hand.read(measured));
    const Eigen::Vector3d force = coupling.on
                                      ? couple(coupling, spring, measured.tip, state, wall).force
                                      : wall(measured.tip);
    if (!force.allFinite()) return false;
    static_cast<void>(hand.write({.force = force}));
    const long eighth = 8 * tick / ticks;
    if (eighth == 1) early.add(hand.position().z());
    if (eighth == 7) late.add(hand.position().z());
  }
  const double rest = std::max(kQuanta * options.encoder_step, kRest);
  if (late.highest() > rest) return false;  // it was thrown off
  return late.range() < rest || late.to_and_fro() < std::max(kLess * early.to_and_fro(), rest);
}

double largest_calm_stiffness(const HandOptions& hand, const CouplingOptions& coupling) {
  constexpr double kLeast = 1e-3, kMost = 1e3;  // [N/mm]
  constexpr double kAccuracy = 1.01;            // ratio
  if (!presses_calmly(hand, coupling, kLeast)) return 0;
  if (presses_calmly(hand, coupling, kMost)) return kMost;
  double calm = kLeast, wild = kMost;
  while (wild / calm > kAccuracy) {
    const double middle = std::sqrt(calm * wild);
    (presses_calmly(hand, coupling, middle) ? calm : wild) = middle;
  }
  return calm;
}

}  // namespace palpate::haptics
