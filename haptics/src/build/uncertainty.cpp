// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "build/left_out_blend.h"
#include "model/force_variance.h"
#include "palpate/geometry/median.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/rounding.h"
#include "palpate/parallel_for.h"

namespace palpate::haptics {
namespace {

// The errors relative to the force, at the distance of left-out contacts, among which the
// most likely is chosen: 0, and kTried between these, in equal ratios.
constexpr double kLeastBetween = 1e-3, kMostBetween = 10;
constexpr int kTried = 33;
// Assumed standard deviation, among places, of the logarithm of the part between contacts: it
// differs by a factor of two.
const double kSpread = std::log(2);
constexpr int kBetweenDigits = 3;

using Losses = Eigen::Vector<double, kTried + 1>;

struct LeftOutErrors {
  std::vector<double> squares, known, unit;  // [N^2] of each sample
};

LeftOutErrors left_out_errors(const Model& model, const BlendedField& field, const Blend& at,
                              std::size_t contact, const ForceSamples& samples,
                              const MeasurementNoise& noise) {
  const ContactModel& self = model.contacts[contact];
  LeftOutErrors result;
  for (Eigen::Index j = 0; j < samples.forces.cols(); ++j) {
    const Eigen::Vector3d displacement = self.frame * samples.displacements.col(j);
    const Eigen::Vector3d error =
        field.force(at, displacement) - self.frame * samples.forces.col(j);
    const ForceVariance parts = force_variance(model.contacts, at, self.position, displacement);
    result.squares.push_back(error.squaredNorm());
    result.known.push_back(parts.contacts +
                           noise_variance(noise, field.stiffness(at, displacement)));
    result.unit.push_back(parts.distance);
  }
  return result;
}

// -2 log likelihood of the errors at a contact for each value that is tried. They are not
// independent of each other; together they count as one.
Losses losses_of(const LeftOutErrors& errors, const Losses& tried) {
  Losses sum = Losses::Zero();
  for (std::size_t j = 0; j < errors.squares.size(); ++j) {
    for (Eigen::Index t = 0; t < tried.size(); ++t) {
      const double variance = errors.known[j] + tried(t) * tried(t) * errors.unit[j];
      if (variance > 0) sum(t) += std::log(variance) + errors.squares[j] / variance;
    }
  }
  return sum / static_cast<double>(errors.squares.size());
}

}  // namespace

double noise_variance(const MeasurementNoise& noise, const Eigen::Matrix3d& stiffness) {
  return 3 * noise.force * noise.force +
         noise.displacement * noise.displacement * stiffness.squaredNorm();
}

Model with_uncertainty(Model model, std::span<const ForceSamples> samples,
                       const MeasurementNoise& noise) {
  model.noise = MeasurementNoise{round_to_digits(noise.force, kBetweenDigits),
                                 round_to_digits(noise.displacement, kBetweenDigits)};
  const LeftOutBlends blends(model, model.interpolation.rule);
  const BlendedField field(model);
  std::vector<std::optional<LeftOutErrors>> errors(model.contacts.size());
  std::vector<double> distances(model.contacts.size(), 0);
  parallel_for(model.contacts.size(), [&](std::size_t i) {
    const std::optional<Blend> at = blends.at(i);
    if (!at) return;
    errors[i] = left_out_errors(model, field, *at, i, samples[i], noise);
    for (std::size_t k = 0; k < static_cast<std::size_t>(at->contacts.count); ++k) {
      const auto other = static_cast<std::size_t>(at->contacts.contacts[k]);
      distances[i] += at->contacts.weights[k] *
                      (model.contacts[other].position - model.contacts[i].position).squaredNorm();
    }
  });
  std::vector<double> known;
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (errors[i] && distances[i] > 0) known.push_back(distances[i]);
  if (known.empty()) {
    for (ContactModel& contact : model.contacts) contact.uncertainty.reset();
    return model;
  }
  const double unit = std::pow(geometry::median(std::move(known)), -kErrorGrowth / 2);
  Losses tried = Losses::Zero();
  for (int t = 0; t < kTried; ++t)
    tried(t + 1) =
        unit * kLeastBetween * std::pow(kMostBetween / kLeastBetween, t / (kTried - 1.0));
  std::vector<Losses> losses(errors.size(), Losses::Zero());
  parallel_for(errors.size(), [&](std::size_t i) {
    if (errors[i]) losses[i] = losses_of(*errors[i], tried);
  });
  Losses all = Losses::Zero();
  for (const Losses& of_contact : losses) all += of_contact;
  Eigen::Index typical = 0;
  all.minCoeff(&typical);
  // The first value, 0, counts as one step below the next.
  const double step = std::log(kMostBetween / kLeastBetween) / (kTried - 1);
  Losses prior;
  for (Eigen::Index t = 0; t < prior.size(); ++t)
    prior(t) = std::pow(step * static_cast<double>(t - typical) / kSpread, 2);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!model.contacts[i].uncertainty) continue;
    Losses here = losses[i] + prior;
    for (const int other : blends.neighbours()[i]) here += losses[static_cast<std::size_t>(other)];
    Eigen::Index best = 0;
    here.minCoeff(&best);
    model.contacts[i].uncertainty->between = round_to_digits(tried(best), kBetweenDigits);
  }
  return model;
}

}  // namespace palpate::haptics
