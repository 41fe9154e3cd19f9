// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/approach_signal.h"

namespace palpate::probing {

struct ParabolaOptions {
  SignalOptions signal;
  double threshold = 6;  ///< of the difference of the speeds, in standard deviations; > 0
};

/// The rule of thesis 4.4.1, kept as the baseline: the tip has touched when the speed by a parabola
/// through all samples exceeds that by a parabola through the latest 12, by the threshold, at two
/// samples in succession. The standard deviations follow from the quantisation alone.
///
/// It needs a constant force. It reports the position at which it notices the contact, which lies
/// 0.5 to 5 mm inside the object, the deeper the softer.
class ParabolaDetector {
 public:
  /// \throws InvalidInput on an option outside its range.
  explicit ParabolaDetector(const ParabolaOptions& options = {});

  /// True from the sample on at which contact is certain. Real-time safe.
  bool step(const ApproachSample& sample) noexcept;

  [[nodiscard]] bool touched() const noexcept { return touched_; }
  [[nodiscard]] SignalFault fault() const noexcept { return check_.fault(); }
  [[nodiscard]] double position() const noexcept { return position_; }  ///< [mm] at detection

 private:
  static constexpr int kWindow = 12;
  ParabolaOptions options_;
  SignalCheck check_;
  ApproachSample first_;
  int count_ = 0;
  int passed_ = 0;
  bool touched_ = false;
  double position_ = 0;
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d moment_ = Eigen::Vector3d::Zero();
  std::array<ApproachSample, kWindow> latest_{};
};

}  // namespace palpate::probing
