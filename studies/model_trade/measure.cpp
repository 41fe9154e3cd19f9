// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <random>

namespace palpate::bench {
namespace {

// Places in reach, and closed ways, that each contact is tried at.
constexpr int kPlaces = 400;
constexpr int kLoops = 40;
// Midpoint rule along a straight way.
constexpr int kSteps = 200;
// [N mm] work below which a way counts as giving energy: far above the rule's error for a smooth
// field, far below what a hand could feel.
constexpr double kNoWork = -1e-4;

double processor_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

double rms(const Predictor& field, const Eigen::Matrix3Xd& displacements,
           const Eigen::Matrix3Xd& forces) {
  double sum = 0;
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    sum += (field.force(displacements.col(i)) - forces.col(i)).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(forces.cols()));
}

double work(const Predictor& field, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  double sum = 0;
  for (int step = 0; step < kSteps; ++step) {
    sum += field.force(from + (step + 0.5) / kSteps * (to - from)).dot(to - from);
  }
  return sum / kSteps;
}

// Anywhere between four places where the object was true: the tool can get there.
Eigen::Vector3d place_in_reach(const Eigen::Matrix3Xd& places, std::mt19937& random) {
  std::exponential_distribution<double> share(1);
  std::uniform_int_distribution<Eigen::Index> pick(0, places.cols() - 1);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const double weight = share(random);
    sum += weight * places.col(pick(random));
    total += weight;
  }
  return sum / total;
}

bool is_passive(const Predictor& field, const Eigen::Matrix3Xd& places, std::mt19937& random) {
  for (int i = 0; i < kPlaces; ++i) {
    if (work(field, Eigen::Vector3d::Zero(), place_in_reach(places, random)) < kNoWork) {
      return false;
    }
  }
  return true;
}

double loop_energy(const Predictor& field, const Eigen::Matrix3Xd& places, std::mt19937& random) {
  double most = 0;
  for (int i = 0; i < kLoops; ++i) {
    const Eigen::Vector3d a = place_in_reach(places, random), b = place_in_reach(places, random),
                          c = place_in_reach(places, random);
    most = std::max(most, std::abs(work(field, a, b) + work(field, b, c) + work(field, c, a)));
  }
  return most;
}

double microseconds_per_force(const Predictor& field, const Eigen::Matrix3Xd& places) {
  constexpr int kRepeats = 20;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const double start = processor_seconds();
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    for (const auto& place : places.colwise()) sum += field.force(place);
  }
  const double seconds = processor_seconds() - start;
  // The sum is used, so that the loop is not optimised away.
  return sum.allFinite() ? 1e6 * seconds / static_cast<double>(kRepeats * places.cols()) : 0;
}

}  // namespace

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(
      std::lround(share * static_cast<double>(values.size() - 1)))];
}

Figures measure(const Method& method, const std::vector<ContactData>& contacts) {
  std::vector<double> training, truth, fit_ms, force_us;
  Figures figures;
  std::mt19937 random(1);
  for (const ContactData& contact : contacts) {
    const double start = processor_seconds();
    const Predictor field = method.fit(contact);
    fit_ms.push_back(1e3 * (processor_seconds() - start));
    training.push_back(rms(field, contact.displacements, contact.forces));
    truth.push_back(rms(field, contact.truth_displacements, contact.truth_forces));
    force_us.push_back(microseconds_per_force(field, contact.truth_displacements));
    if (!is_passive(field, contact.truth_displacements, random)) figures.not_passive += 1;
    figures.loop_energy =
        std::max(figures.loop_energy, loop_energy(field, contact.truth_displacements, random));
    figures.numbers += static_cast<double>(field.numbers);
  }
  const double count = static_cast<double>(contacts.size());
  figures.training_rms = quantile(training, 0.5);
  figures.truth_rms = quantile(truth, 0.5);
  figures.truth_rms_p90 = quantile(truth, 0.9);
  figures.not_passive *= 100 / count;
  figures.numbers /= count;
  figures.fit_ms = quantile(fit_ms, 0.5);
  figures.force_us = quantile(force_us, 0.5);
  return figures;
}

}  // namespace palpate::bench
