// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/realignment.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace palpate::haptics {
namespace {

using Group = std::vector<const probing::Sample*>;

std::map<long long, Group> group_samples(long long contact,
                                         std::span<const probing::Sample> samples) {
  std::map<long long, Group> groups;
  for (const probing::Sample& sample : samples) {
    if (sample.contact == contact) groups[sample.group].push_back(&sample);
  }
  return groups;
}

Eigen::Index count_pairs(const std::map<long long, Group>& groups) {
  Eigen::Index pairs = 0;
  for (const auto& [id, group] : groups) {
    ++pairs;
    for (const probing::Sample* sample : group) pairs += sample->slipped ? 0 : 1;
  }
  return pairs;
}

// Three components need more than as many positions for a least direction of their scatter.
constexpr std::size_t kMinPositions = 8;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Eigen::Vector3d mean_of(const std::vector<Eigen::Vector3d>& positions) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& position : positions) {
    sum += position / static_cast<double>(positions.size());
  }
  return sum;
}

// Positions `a` of a group without outliers.
std::vector<Eigen::Vector3d> inliers(const Group& group) {
  std::vector<Eigen::Vector3d> all, kept;
  for (const probing::Sample* sample : group) all.push_back(sample->a);
  const Eigen::Vector3d mean = mean_of(all);
  std::vector<double> distances;
  for (const Eigen::Vector3d& position : all) distances.push_back((position - mean).norm());
  const double most = kOutlierRatio * median(distances);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (distances[i] <= most) kept.push_back(all[i]);
  }
  return kept;
}

// Of the same noise in all directions n + 1 positions seem to have less in one of them: of the
// smallest eigenvalue of the covariance only 1 - kShortfall / sqrt(n) is expected (simulated with
// normal noise; 2 % off from n = 16 on).
constexpr double kShortfall = 2;

// Smallest variance of the positions in any direction.
double least_variance(const std::vector<Eigen::Vector3d>& positions, const Eigen::Vector3d& mean) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& position : positions) {
    scatter += (position - mean) * (position - mean).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter, Eigen::EigenvaluesOnly);
  const double degrees = static_cast<double>(positions.size() - 1);
  return std::max(0.0, eigen.eigenvalues()[0]) / (degrees * (1 - kShortfall / std::sqrt(degrees)));
}

}  // namespace

std::optional<double> pooled_displacement_noise(std::span<const ForceSamples> contacts) {
  double variance = 0, degrees = 0;
  for (const ForceSamples& contact : contacts) {
    if (contact.degrees_of_freedom == 0) continue;
    variance +=
        contact.degrees_of_freedom * contact.displacement_noise * contact.displacement_noise;
    degrees += contact.degrees_of_freedom;
  }
  if (degrees == 0) return std::nullopt;
  return std::sqrt(variance / degrees);
}

ForceSamples realign(const probing::Contact& contact, std::span<const probing::Sample> samples) {
  const std::map<long long, Group> groups = group_samples(contact.id, samples);
  const Eigen::Vector3d normal = contact.normal.normalized();
  ForceSamples result;
  result.displacements.resize(3, count_pairs(groups));
  result.forces.resize(3, result.displacements.cols());
  Eigen::Index pair = 0;
  double variance = 0;
  for (const auto& [id, group] : groups) {
    const std::vector<Eigen::Vector3d> positions = inliers(group);
    const Eigen::Vector3d mean_a = mean_of(positions);
    if (positions.size() >= kMinPositions) {
      const int degrees = static_cast<int>(positions.size()) - 1;
      variance += degrees * least_variance(positions, mean_a);
      result.degrees_of_freedom += degrees;
    }
    double mean_normal_force = 0;
    for (const probing::Sample* sample : group) {
      mean_normal_force += sample->force.dot(normal) / static_cast<double>(group.size());
    }
    result.displacements.col(pair) = mean_a - contact.position;
    result.forces.col(pair++) = mean_normal_force * normal;
    for (const probing::Sample* sample : group) {
      if (sample->slipped) continue;
      result.displacements.col(pair) = sample->b - sample->a + mean_a - contact.position;
      result.forces.col(pair++) = sample->force;
    }
  }
  if (result.degrees_of_freedom > 0) {
    result.displacement_noise = std::sqrt(variance / result.degrees_of_freedom);
  }
  return result;
}

}  // namespace palpate::haptics
