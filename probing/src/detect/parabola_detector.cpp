// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/parabola_detector.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "palpate/core/require.h"

namespace palpate::probing {
namespace {

/// A speed and its variance in units of the variance of a position.
struct ParabolaSpeed {
  double speed = 0;
  double variance = 0;
};

Eigen::Vector3d parabola_row(double time) { return {1, time, time * time}; }

ParabolaSpeed speed_of_parabola(const Eigen::Matrix3d& information, const Eigen::Vector3d& moment,
                                double time) {
  const Eigen::LDLT<Eigen::Matrix3d> factor(information);
  const Eigen::Vector3d slope(0, 1, 2 * time);
  return {slope.dot(factor.solve(moment)), slope.dot(factor.solve(slope))};
}

}  // namespace

ParabolaDetector::ParabolaDetector(const ParabolaOptions& options)
    : options_(options), check_(options.signal) {
  require("ParabolaOptions::threshold", options.threshold, above(0));
}

bool ParabolaDetector::step(const ApproachSample& sample) noexcept {
  if (touched_ || check_.check(sample) != SignalFault::none) return touched_;
  if (count_ == 0) first_ = sample;
  latest_[static_cast<std::size_t>(count_ % kWindow)] = sample;
  const double now = sample.time - first_.time;
  const Eigen::Vector3d row = parabola_row(now);
  information_ += row * row.transpose();
  moment_ += row * (sample.position - first_.position);
  if (++count_ < 2 * kWindow) return false;

  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const ApproachSample& one : latest_) {
    const Eigen::Vector3d r = parabola_row(one.time - sample.time);
    information += r * r.transpose();
    moment += r * (one.position - first_.position);
  }
  const ParabolaSpeed global = speed_of_parabola(information_, moment_, now);
  const ParabolaSpeed local = speed_of_parabola(information, moment, 0);
  const double deviation =
      options_.signal.quantum * std::sqrt((global.variance + local.variance) / 12);
  passed_ = global.speed - local.speed > options_.threshold * deviation ? passed_ + 1 : 0;
  if (passed_ == 2) {
    touched_ = true;
    position_ = sample.position;
  }
  return touched_;
}

}  // namespace palpate::probing
