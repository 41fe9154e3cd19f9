// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/cone_posterior.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/probing/measurable.h"

namespace palpate::probing {
namespace {

constexpr int kAngles = 15, kTilts = 11;  // cells of the grid along each unknown
constexpr int kAxes = kTilts * kTilts;    // which are the same for all angles
/// Half-width of the grid, in standard deviations.
constexpr double kReach = 3.5;
/// The outcome of a trial is blurred by a variance of the squared size of a cell over this. 12
/// would be the variance of a position anywhere in a cell.
constexpr double kBlur = 48;
constexpr double kLapse = 0.02;  // probability that a slip was judged wrongly, either way
constexpr double kCertain = 8;   // standard deviations beyond which a trial's outcome is certain
/// Probabilities, each at least `kLapse`, that are multiplied before their logarithm is taken.
constexpr std::size_t kFactors = 100;
/// The grid is centred again until each standard deviation changes by less than this fraction of
/// itself, and each mean by less than this fraction of its standard deviation.
constexpr double kSteadyShare = 0.1;
constexpr int kMaxSteps = 25;
/// [rad] Assumed spread of the angle between contacts. It counts like `kAssumedContacts` known
/// contacts.
constexpr double kAssumedSpread = 0.1;
constexpr double kAssumedContacts = 2;
constexpr double kLargestAngle = 1.55;  // [rad]: a coefficient of 48

/// The normal distribution function, interpolated linearly between 256 values a standard deviation:
/// within 5e-7, which is little against `kLapse`, in a tenth of the time of std::erfc.
class NormalTable {
 public:
  NormalTable() {
    for (int i = 0; i < kSize; ++i)
      values_[static_cast<std::size_t>(i)] =
          std::erfc((kCertain - i / kPerDeviation) / std::numbers::sqrt2) / 2;
  }
  double operator()(double z) const {
    if (z >= kCertain) return 1;
    if (!(z > -kCertain)) return 0;
    const double place = (z + kCertain) * kPerDeviation;
    const auto below = static_cast<std::size_t>(place);
    return values_[below] +
           (place - static_cast<double>(below)) * (values_[below + 1] - values_[below]);
  }

 private:
  static constexpr double kPerDeviation = 256;
  static constexpr int kSize = static_cast<int>(2 * kCertain * kPerDeviation) + 1;
  std::array<double, kSize> values_;
};

const NormalTable& normal_table() {
  static const NormalTable table;
  return table;
}

/// A force's parts along each axis of the grid and across it.
struct AxisForces {
  Eigen::Array<double, kAxes, 1> along, across;
};

AxisForces split_force(const Eigen::Vector3d& force, const Eigen::Matrix4Xd& cells) {
  AxisForces parts;
  for (int k = 0; k < kAxes; ++k) {
    const double x = cells(2, k), y = cells(3, k);
    parts.along[k] = (force.x() * x + force.y() * y + force.z()) / std::sqrt(1 + x * x + y * y);
    parts.across[k] =
        std::sqrt(std::max(force.squaredNorm() - parts.along[k] * parts.along[k], 0.0));
  }
  return parts;
}

/// Quantile of a distribution given by the weights of equal cells, uniform within each cell.
double cell_quantile(const Eigen::VectorXd& weights, double low, double step, double part) {
  double below = 0;
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    if (below + weights[i] >= part) {
      return low + step * (static_cast<double>(i) - 0.5 + (part - below) / weights[i]);
    }
    below += weights[i];
  }
  return low + step * (static_cast<double>(weights.size()) - 0.5);
}

}  // namespace

ConePrior pooled_prior(std::span<const ConeEstimate> cones, double force_noise) {
  ConePrior prior{.force_noise = force_noise};
  std::vector<ConeEstimate> known;
  for (const ConeEstimate& cone : cones) {
    if (cone.angle_deviation < kAssumedSpread) known.push_back(cone);
  }
  if (known.empty()) return prior;
  const auto count = static_cast<double>(known.size());
  double mean = 0, squares = 0, uncertainty = 0, tilts = 0;
  for (const ConeEstimate& cone : known) mean += cone.angle / count;
  for (const ConeEstimate& cone : known) {
    squares += (cone.angle - mean) * (cone.angle - mean);
    uncertainty += cone.angle_deviation * cone.angle_deviation / count;
    tilts += (cone.tilt * cone.tilt + cone.axis_error * cone.axis_error) / 2;
  }
  const double spread = (squares + kAssumedContacts * kAssumedSpread * kAssumedSpread) /
                        (count - 1 + kAssumedContacts);
  prior.angle = mean;
  prior.angle_deviation = std::sqrt(spread + (spread + uncertainty) / count);
  prior.tilt_deviation =
      std::sqrt((tilts + kAssumedContacts * prior.tilt_deviation * prior.tilt_deviation) /
                (count + kAssumedContacts));
  return prior;
}

ConePosterior::ConePosterior(const Eigen::Vector3d& pressing, const ConePrior& prior)
    : prior_(prior) {
  require("ConePrior::angle", prior.angle, at_least(0).at_most(kLargestAngle), "rad");
  require("ConePrior::angle_deviation", prior.angle_deviation, above(0).finite(), "rad");
  require("ConePrior::tilt_deviation", prior.tilt_deviation, above(0).finite(), "rad");
  require("ConePrior::force_noise", prior.force_noise, above(0).at_most(kLargestMeasurement), "N");
  if (!(pressing.norm() > 0) || !pressing.allFinite())
    throw InvalidInput("ConePosterior: the pressing direction must be finite and not zero");
  frame_ = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), pressing).matrix();
  mean_ = {prior.angle, 0, 0};
  deviation_ = {prior.angle_deviation, prior.tilt_deviation, prior.tilt_deviation};
  follow();
}

void ConePosterior::add(std::span<const ConeTrial> trials) {
  for (const ConeTrial& trial : trials)
    trials_.push_back({frame_.transpose() * trial.force, trial.slipped});
  follow();
}

// Computes the weights of the cells of a box. Trials are blurred by the size of a cell, so that a
// coarse grid does not miss a narrow distribution.
void ConePosterior::fill(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const Eigen::Vector3d step =
      (high - low).cwiseQuotient(Eigen::Vector3d(kAngles - 1, kTilts - 1, kTilts - 1));
  cells_.resize(4, kAngles * kAxes);
  angles_.setLinSpaced(kAngles, low[0], high[0]);
  Eigen::VectorXd cost(cells_.cols());
  Eigen::Index cell = 0;
  for (int i = 0; i < kAngles; ++i) {
    const double angle = angles_[i], sine = std::sin(angle), cosine = std::cos(angle);
    const double of_angle = std::pow((angle - prior_.angle) / prior_.angle_deviation, 2) / 2;
    for (int j = 0; j < kTilts; ++j) {
      for (int k = 0; k < kTilts; ++k, ++cell) {
        const double x = low[1] + step[1] * j, y = low[2] + step[2] * k;
        cells_.col(cell) << sine, cosine, x, y;
        cost[cell] =
            of_angle + (x * x + y * y) / (2 * prior_.tilt_deviation * prior_.tilt_deviation);
      }
    }
  }
  const double blur = (step[0] * step[0] + std::max(step[1] * step[1], step[2] * step[2])) / kBlur;
  const NormalTable& normal_probability = normal_table();
  Eigen::ArrayXd product = Eigen::ArrayXd::Ones(cells_.cols());
  for (std::size_t t = 0; t < trials_.size(); ++t) {
    const Eigen::Vector3d& force = trials_[t].force;
    const double square = force.squaredNorm();
    const double noise = std::sqrt(prior_.force_noise * prior_.force_noise + blur * square);
    const AxisForces parts = split_force(force, cells_);
    for (int i = 0; i < kAngles; ++i) {
      const double sine = cells_(0, i * kAxes), cosine = cells_(1, i * kAxes);
      for (int k = 0; k < kAxes; ++k) {
        const double slips =
            normal_probability((cosine * parts.across[k] - sine * parts.along[k]) / noise);
        product[i * kAxes + k] *=
            kLapse + (1 - 2 * kLapse) * (trials_[t].slipped ? slips : 1 - slips);
      }
    }
    if ((t + 1) % kFactors != 0 && t + 1 != trials_.size()) continue;
    cost -= product.log().matrix();
    product.setOnes();
  }
  weights_ = (cost.minCoeff() - cost.array()).exp().matrix();
  weights_ /= weights_.sum();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), square = Eigen::Vector3d::Zero();
  for (cell = 0; cell < cells_.cols(); ++cell) {
    const Eigen::Vector3d at(angles_[cell / kAxes], cells_(2, cell), cells_(3, cell));
    mean += weights_[cell] * at;
    square += weights_[cell] * at.cwiseProduct(at);
  }
  mean_ = mean;
  deviation_ =
      (square - mean.cwiseProduct(mean)).cwiseMax(step.cwiseProduct(step) / 12).cwiseSqrt();
}

void ConePosterior::follow() {
  for (int i = 0; i < kMaxSteps; ++i) {
    const Eigen::Vector3d mean = mean_, deviation = deviation_;
    Eigen::Vector3d low = mean - kReach * deviation, high = mean + kReach * deviation;
    low[0] = std::max(low[0], 0.0);
    constexpr double kNarrowest = 1e-4;  // [rad] least width of the grid
    high[0] = std::clamp(high[0], low[0] + kNarrowest, kLargestAngle);
    fill(low, high);
    const bool steady =
        ((mean_ - mean).cwiseAbs().array() < kSteadyShare * deviation_.array()).all() &&
        ((deviation_ - deviation).cwiseAbs().array() < kSteadyShare * deviation_.array()).all();
    if (steady) break;
  }
}

double ConePosterior::slip_probability(const Eigen::Vector3d& force) const {
  const NormalTable& normal_probability = normal_table();
  const AxisForces parts = split_force(frame_.transpose() * force, cells_);
  double probability = 0;
  for (int i = 0; i < kAngles; ++i) {
    const double sine = cells_(0, i * kAxes), cosine = cells_(1, i * kAxes);
    for (int k = 0; k < kAxes; ++k) {
      const double distance = cosine * parts.across[k] - sine * parts.along[k];
      probability += weights_[i * kAxes + k] * normal_probability(distance / prior_.force_noise);
    }
  }
  return probability;
}

ConeEstimate ConePosterior::estimate() const {
  ConeEstimate result;
  Eigen::VectorXd of_angle(kAngles);
  for (int i = 0; i < kAngles; ++i) of_angle[i] = weights_.segment(i * kAxes, kAxes).sum();
  const double step = angles_[1] - angles_[0];
  const auto at = [&](double part) {
    return std::clamp(cell_quantile(of_angle, angles_[0], step, part), 0.0, kLargestAngle);
  };
  result.angle = mean_[0];
  result.angle_deviation = deviation_[0];
  result.least_angle = at(0.05);
  result.low = std::tan(at(0.025));
  result.high = std::tan(at(0.975));
  result.coefficient = std::tan(result.angle);
  result.coefficient_error = deviation_[0] * (1 + result.coefficient * result.coefficient);
  result.axis = frame_ * Eigen::Vector3d(mean_[1], mean_[2], 1).normalized();
  result.axis_error = std::hypot(deviation_[1], deviation_[2]);
  result.tilt = std::atan(std::hypot(mean_[1], mean_[2]));
  return result;
}

}  // namespace palpate::probing
