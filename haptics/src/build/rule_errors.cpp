// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/rule_errors.h"

#include <cmath>
#include <limits>
#include <vector>

#include "build/left_out_blend.h"
#include "palpate/core/parallel_for.h"

namespace palpate::haptics {
namespace {

// Squared errors of each contact; NaN where it cannot be predicted.
std::vector<double> left_out_squares_of(const Model& model, std::span<const ForceSamples> samples,
                                        Compared compared) {
  const LeftOutBlends blends(model);
  const BlendedField field(model);
  std::vector<double> squares(samples.size(), std::numeric_limits<double>::quiet_NaN());
  parallel_for(samples.size(), [&](std::size_t i) {
    const std::optional<Blend> at = blends.at(i);
    if (!at) return;
    const Eigen::Matrix3d& frame = model.contacts[i].frame;
    double sum = 0;
    for (Eigen::Index j = 0; j < samples[i].forces.cols(); ++j) {
      const Eigen::Vector3d error =
          frame.transpose() * field.force(*at, frame * samples[i].displacements.col(j)) -
          samples[i].forces.col(j);
      sum += compared == Compared::along_pressing ? error.z() * error.z() : error.squaredNorm();
    }
    squares[i] = sum;
  });
  return squares;
}

}  // namespace

double left_out_pressing_error(const Model& model, std::span<const ForceSamples> samples) {
  const std::vector<double> squares = left_out_squares_of(model, samples, Compared::along_pressing);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (std::isnan(squares[i])) continue;
    sum += squares[i];
    count += static_cast<double>(samples[i].forces.cols());
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

std::optional<RuleErrors> left_out_errors_of_rules(const Model& by_compliances,
                                                   const Model& by_forces,
                                                   std::span<const ForceSamples> samples,
                                                   Compared compared) {
  const std::vector<double> compliances = left_out_squares_of(by_compliances, samples, compared),
                            forces = left_out_squares_of(by_forces, samples, compared);
  RuleErrors sums;
  double count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (std::isnan(compliances[i]) || std::isnan(forces[i])) continue;
    sums.compliances += compliances[i];
    sums.forces += forces[i];
    count += static_cast<double>(samples[i].forces.cols());
  }
  if (!(count > 0)) return std::nullopt;
  return RuleErrors{std::sqrt(sums.compliances / count), std::sqrt(sums.forces / count)};
}

}  // namespace palpate::haptics
