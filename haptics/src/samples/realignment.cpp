// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/realignment.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "samples/repeated_forces.h"

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

// Returns true if a sample makes a pair beside that of its group.
bool has_own_pair(const probing::Sample& sample) {
  return !sample.slipped && has_tangential_stage(sample);
}

Eigen::Index count_pairs(const std::map<long long, Group>& groups) {
  Eigen::Index pairs = 0;
  for (const auto& [id, group] : groups) {
    ++pairs;
    for (const probing::Sample* sample : group) pairs += has_own_pair(*sample) ? 1 : 0;
  }
  return pairs;
}

// Fewer positions do not distinguish an outlier from the scatter of the others, and all but one of
// them do not determine a direction of least scatter.
constexpr std::size_t kMinPositions = 4;

// Of an even number of values, the mean of the two middle ones.
double mean_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*std::max_element(values.begin(), middle) + *middle) / 2;
}

// Median per component. Unlike the mean, it is hardly moved by a minority of outliers.
Eigen::Vector3d median_position(const Group& group) {
  Eigen::Vector3d result;
  for (Eigen::Index component = 0; component < 3; ++component) {
    std::vector<double> values;
    for (const probing::Sample* sample : group) values.push_back(sample->a[component]);
    result[component] = mean_median(std::move(values));
  }
  return result;
}

// The samples of a group whose `a` is no outlier.
Group inliers(const Group& group) {
  if (group.size() < kMinPositions) return group;
  const Eigen::Vector3d center = median_position(group);
  std::vector<double> distances;
  for (const probing::Sample* sample : group) distances.push_back((sample->a - center).norm());
  const double most = kOutlierRatio * mean_median(distances);
  Group kept;
  for (std::size_t i = 0; i < group.size(); ++i) {
    if (distances[i] <= most) kept.push_back(group[i]);
  }
  return kept;
}

Eigen::Vector3d mean_position(const Group& group) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const probing::Sample* sample : group) sum += sample->a / static_cast<double>(group.size());
  return sum;
}

// Of the normal force of a group: the forces along the normal, or all of them where there was no
// tangential stage.
Eigen::Vector3d settled_force(const Group& group, const Eigen::Vector3d& normal) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  bool tangential = false;
  for (const probing::Sample* sample : group) {
    sum += sample->force / static_cast<double>(group.size());
    tangential = tangential || has_tangential_stage(*sample);
  }
  return tangential ? Eigen::Vector3d(sum.dot(normal) * normal) : sum;
}

// Sum of squares, n - 1 times the variance, of the positions in the direction of least scatter. The
// smallest eigenvalue of their covariance would be too small, because its direction is fitted to
// the same positions. Instead, the others determine the direction for each position. This gives the
// unbiased variance for isotropic noise whatever n; otherwise the expectation is never below the
// least variance. (The scatter of the others about their mean is less by n / (n - 1) d_i d_i^T,
// with d_i relative to the mean of all.)
double least_sum_of_squares(const Group& group, const Eigen::Vector3d& mean) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const probing::Sample* sample : group) {
    scatter += (sample->a - mean) * (sample->a - mean).transpose();
  }
  const double n = static_cast<double>(group.size());
  double sum = 0;
  for (const probing::Sample* sample : group) {
    const Eigen::Vector3d off = sample->a - mean;
    const Eigen::Matrix3d others = scatter - n / (n - 1) * off * off.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(others);
    const double part = eigen.eigenvectors().col(0).dot(off);
    sum += part * part;
  }
  return sum;
}

// A group under its normal force, which the tool applied in the direction -normal.
struct Level {
  Group group;
  double force = 0;                              // [N] mean along -normal
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // [mm] mean displacement
};

// Levels whose forces have at most this ratio give the compliance between them.
constexpr double kOtherLevel = 0.8;

// Derivative of the settled position by the normal force at a level [mm/N]: that of the parabola
// through it and the next levels below and above.
Eigen::Vector3d compliance_at(const Level& level, const std::vector<Level>& ascending) {
  Level below;  // without a force the tool is at the contact
  const Level* above = nullptr;
  for (const Level& other : ascending) {
    if (other.force > 0 && other.force <= kOtherLevel * level.force) below = other;
    if (above == nullptr && level.force <= kOtherLevel * other.force) above = &other;
  }
  const double down = level.force - below.force;
  const Eigen::Vector3d secant = (level.at - below.at) / down;
  if (above == nullptr) return secant;
  const double up = above->force - level.force;
  return (up * secant + down * (above->at - level.at) / up) / (down + up);
}

}  // namespace

bool has_tangential_stage(const probing::Sample& sample) { return sample.a != sample.b; }

std::optional<double> pooled_displacement_noise(std::span<const ForceSamples> contacts) {
  double variance = 0, degrees = 0;
  for (const ForceSamples& contact : contacts) {
    if (!contact.displacement_noise) continue;
    variance +=
        contact.degrees_of_freedom * *contact.displacement_noise * *contact.displacement_noise;
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
  double sum_of_squares = 0;
  for (const auto& [id, group] : groups) {
    const Group kept = inliers(group);
    const Eigen::Vector3d mean_a = mean_position(kept);
    if (kept.size() >= kMinPositions) {
      sum_of_squares += least_sum_of_squares(kept, mean_a);
      result.degrees_of_freedom += static_cast<int>(kept.size()) - 1;
    }
    result.kinds.push_back(PairKind::settled);
    result.displacements.col(pair) = mean_a - contact.position;
    result.forces.col(pair++) = settled_force(kept, normal);
    for (const probing::Sample* sample : group) {
      if (!has_own_pair(*sample)) continue;
      result.kinds.push_back(sample->on_friction_boundary ? PairKind::friction_boundary
                                                          : PairKind::held);
      result.displacements.col(pair) = sample->b - sample->a + mean_a - contact.position;
      result.forces.col(pair++) = sample->force;
    }
  }
  if (result.degrees_of_freedom > 0) {
    result.displacement_noise = std::sqrt(sum_of_squares / result.degrees_of_freedom);
  }
  return result;
}

std::vector<RepeatedForce> repeated_forces(const probing::Contact& contact,
                                           std::span<const probing::Sample> samples) {
  const Eigen::Vector3d normal = contact.normal.normalized();
  std::vector<Level> levels;
  for (const auto& [id, group] : group_samples(contact.id, samples)) {
    const Group kept = inliers(group);
    levels.push_back(
        {kept, -settled_force(kept, normal).dot(normal), mean_position(kept) - contact.position});
  }
  std::ranges::stable_sort(levels, {}, &Level::force);
  std::vector<RepeatedForce> repeated;
  for (const Level& level : levels) {
    if (level.group.size() < 2 || !(level.force > 0)) continue;
    const Eigen::Vector3d compliance = compliance_at(level, levels);
    if (compliance.isZero(0)) continue;
    const Eigen::Vector3d stiffness = compliance / compliance.squaredNorm();
    double sum = 0;
    for (const probing::Sample* sample : level.group) {
      const double recorded = -sample->force.dot(normal) - level.force;
      const double told = stiffness.dot(sample->a - contact.position - level.at);
      sum += (recorded - told) * (recorded - told);
    }
    const auto freedom = static_cast<int>(level.group.size()) - 1;
    repeated.push_back({stiffness.norm(), sum / freedom, freedom});
  }
  return repeated;
}

double repeated_force_noise(std::span<const RepeatedForce> groups, double displacement_noise) {
  constexpr double kShown = 3;  // variances this many times their standard error count
  constexpr int kRounds = 5;    // after which the weights rest
  double variance = 0;
  for (int round = 0; round < kRounds; ++round) {
    double sum = 0, weights = 0;
    for (const RepeatedForce& group : groups) {
      const double position = std::pow(displacement_noise * group.stiffness, 2);
      const double expected = round == 0 ? group.variance : variance + position;
      if (!(expected > 0)) continue;
      const double weight = group.degrees_of_freedom / (expected * expected);
      sum += weight * (group.variance - position);
      weights += weight;
    }
    variance = sum / weights;
    if (!(variance > kShown * std::sqrt(2 / weights))) return 0;
  }
  return std::sqrt(variance);
}

}  // namespace palpate::haptics
