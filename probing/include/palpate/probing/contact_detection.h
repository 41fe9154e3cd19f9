// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/approach_signal.h"

namespace palpate::probing {

/// Prior knowledge of an approach.
///
/// Free motion follows m s'' = f(t) + e with the commanded force f, a mass m that is nearly known,
/// and a small unknown constant e (friction and gravity that were not compensated). On the object
/// the force of a spring is subtracted, which begins to act at the contact.
struct ApproachModel {
  double mass = 0.08;            ///< [kg] of the tip along the approach; > 0
  double mass_deviation = 0.2;   ///< standard deviation relative to `mass`; in (0, 1)
  double force_deviation = 0.1;  ///< [N] standard deviation of e; > 0
  double speed_deviation = 5;  ///< [mm/s] standard deviation of the speed at the first sample; > 0
};

struct ContactOptions {
  ApproachModel model;
  SignalOptions signal;
  double threshold = 10;       ///< of the test statistic, in standard deviations; > 0
  double softest = 0.008;      ///< [N/mm] a spring softer than this is not taken for an object; > 0
  double least_deviation = 6;  ///< [quanta] that the spring must have held the tip back; > 0
  double longest_approach = 3;  ///< [s] at 1 kHz; > 0
};

/// [N] Pushes with `push` at rest and ever less towards `speed_limit` [mm/s], so that the free tip
/// is no faster when it meets the object. The peak force on a stiff object grows with that speed.
[[nodiscard]] constexpr double approach_force(double speed, double push,
                                              double speed_limit) noexcept {
  return push * (1 - speed / speed_limit);
}

/// Tells, sample by sample, when the tip has touched the object (thesis 4.4.1).
///
/// Each test asks how much better the motion is explained by a spring that began to act 8, 16, ...
/// 512 samples ago. The commanded force is part of the model, so the tip may be braked meanwhile.
/// The thesis' rule is `ParabolaDetector`. `estimate_contact` then finds the surface.
class ContactDetector {
 public:
  /// Allocates all it will need. \throws InvalidInput on an option outside its range.
  explicit ContactDetector(const ContactOptions& options = {});

  /// True from the sample on at which contact is certain. Real-time safe. After a fault, samples
  /// are ignored.
  bool step(const ApproachSample& sample) noexcept;

  [[nodiscard]] bool touched() const noexcept { return touched_; }
  [[nodiscard]] SignalFault fault() const noexcept { return fault_; }
  /// [mm/s] by a line through the latest 10 samples; 0 before there are as many.
  [[nodiscard]] double speed() const noexcept;
  /// All samples so far, for `estimate_contact`.
  [[nodiscard]] std::span<const ApproachSample> samples() const noexcept { return samples_; }

 private:
  [[nodiscard]] bool test(int lag) const noexcept;

  static constexpr int kLags = 7;
  ContactOptions options_;
  SignalCheck check_;
  SignalFault fault_ = SignalFault::none;
  bool touched_ = false;
  std::vector<ApproachSample> samples_;
  std::vector<double> travel_;   // double integral of the force, at each sample
  double impulse_ = 0;           // integral of the force
  Eigen::Matrix4d information_;  // of the free motion, in units of the quantisation
  Eigen::Vector4d moment_ = Eigen::Vector4d::Zero();
  std::array<int, kLags> passed_{};  // tests in succession that found a contact
};

/// The surface as estimated from an approach.
struct ContactEstimate {
  double time = 0;                ///< [s]
  double position = 0;            ///< [mm] of the surface, along the approach
  double position_deviation = 0;  ///< [mm] standard deviation, up to a factor 2
  double stiffness = 0;           ///< [N/mm] of the object at the touch
  double speed = 0;               ///< [mm/s] of the tip at the touch
};

/// Finds the change point of an approach: the time from which a spring must act so that the motion
/// is explained best. All samples must be from before the arm reacts to the touch otherwise than
/// through `force`. Takes milliseconds; not for the loop.
/// \return nothing if no spring stiffer than `softest` explains the motion better.
/// \throws InvalidInput naming the sample if the signal is faulty, or if there are fewer than 20.
[[nodiscard]] std::optional<ContactEstimate> estimate_contact(
    std::span<const ApproachSample> samples, const ContactOptions& options = {});

}  // namespace palpate::probing
