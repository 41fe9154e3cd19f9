// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/compliance_kriging.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "palpate/core/quantile.h"

namespace palpate::haptics {
namespace {

using Values = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Displacements and transverse compliances count as constant if they vary by less than this,
// relative to the largest.
constexpr double kNegligible = 1e-6;
// Bounds of length scales, relative to the spacing of contacts, and of the noise of a value,
// relative to the amplitude. Tens of contacts do not resolve more.
constexpr double kShortestLength = 0.5, kLongestLength = 64;
constexpr double kLeastNoise = 1e-3, kMostNoise = 0.3;
// Start of the search, in the same units.
constexpr double kFirstLength = 4, kFirstNoise = 1e-2;
// Steps of the search are factors of 2^kFirstStep, refined down to 2^kLastStep, which hardly
// changes the likelihood.
constexpr double kFirstStep = 2, kLastStep = 0.5;
constexpr int kMaxRounds = 30;  // the search takes fewer than ten
// Largest number of contacts, evenly selected, from which the covariance is learnt.
constexpr std::size_t kMaxLearntFrom = 64;

double matern(double distance) {
  const double a = std::sqrt(5.0) * distance;
  return (1 + a + a * a / 3) * std::exp(-a);
}

struct System {
  Eigen::LLT<Eigen::MatrixXd> factor;
  Eigen::VectorXd ones;  // K^-1 1
  double sum = 0;        // 1^T K^-1 1
};

System make_system(const Eigen::Matrix2Xd& places, const Covariance& covariance) {
  const Eigen::Matrix2Xd white = covariance.whiten * places;
  const Eigen::Index count = places.cols();
  Eigen::MatrixXd matrix(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      matrix(i, j) = matrix(j, i) = matern((white.col(i) - white.col(j)).norm());
    }
    matrix(i, i) += covariance.nugget;
  }
  System system;
  system.factor.compute(matrix);
  system.ones = system.factor.solve(Eigen::VectorXd::Ones(count));
  system.sum = system.ones.sum();
  return system;
}

// Scale of each of the six numbers: the largest displacement or transverse compliance.
Compliance sizes(const std::vector<Compliance>& values) {
  double displacement = 0, across = 0;
  for (const Compliance& value : values) {
    displacement = std::max(displacement, value.head<3>().norm());
    across = std::max(across, value(3) + value(5));
  }
  Compliance result;
  result << Eigen::Vector3d::Constant(displacement), Eigen::Vector3d::Constant(across);
  return result;
}

// The direction in which compliances change most, and its perpendicular, as rows.
Eigen::Matrix2d principal_directions(const std::vector<Surroundings>& around,
                                     const std::vector<Compliance>& values,
                                     const Compliance& size) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < around.size(); ++i) {
    for (Eigen::Index j = 0; j < around[i].places.cols(); ++j) {
      const Eigen::Vector2d step = around[i].places.col(j);
      const Compliance change = (around[i].values.col(j) - values[i]).cwiseQuotient(size);
      const double square = step.squaredNorm();
      if (square > 0) sum += change.squaredNorm() / (square * square) * step * step.transpose();
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(sum);
  Eigen::Matrix2d rows;
  rows << solver.eigenvectors().col(1).transpose(), solver.eigenvectors().col(0).transpose();
  return rows;
}

// Binary logarithms of: length scale along and across the principal direction, relative to the
// spacing; noise.
using Parameters = Eigen::Vector3d;

Covariance to_covariance(const Parameters& parameters, const Eigen::Matrix2d& directions,
                         double spacing) {
  Covariance covariance;
  const Eigen::Vector2d lengths(spacing * std::exp2(parameters(0)),
                                spacing * std::exp2(parameters(1)));
  covariance.whiten = directions.transpose() * lengths.cwiseInverse().asDiagonal() * directions;
  const double noise = std::exp2(parameters(2));
  covariance.nugget = noise * noise;
  return covariance;
}

// Sets the most likely amplitudes. Returns the negative log-likelihood per value of each contact
// and its surroundings, with the unknown mean integrated out.
double fit_amplitudes(const std::vector<Surroundings>& around,
                      const std::vector<Compliance>& values, const Compliance& size,
                      Covariance& covariance) {
  Compliance squares = Compliance::Zero();
  double logarithms = 0, count = 0;
  for (std::size_t i = 0; i < around.size(); ++i) {
    const Eigen::Index others = around[i].places.cols();
    Eigen::Matrix2Xd places(2, others + 1);
    places << Eigen::Vector2d::Zero(), around[i].places;
    Values all(6, others + 1);
    all << values[i], around[i].values;
    const System system = make_system(places, covariance);
    all.colwise() -= Compliance(all * system.ones / system.sum);
    const Eigen::MatrixXd white = system.factor.matrixL().solve(all.transpose());
    squares += white.colwise().squaredNorm().transpose();
    const Eigen::MatrixXd lower = system.factor.matrixL();
    logarithms += 2 * lower.diagonal().array().log().sum() + std::log(system.sum);
    count += static_cast<double>(others);
  }
  // Use one amplitude for the values that a rotation about z mixes: u_x and u_y; u_z; c, by its
  // norm.
  squares /= count;
  const double sideways = (squares(0) + squares(1)) / 2;
  const double across = (squares(3) + 2 * squares(4) + squares(5)) / 4;
  squares << sideways, sideways, squares(2), across, across, across;
  const Compliance least = kNegligible * kNegligible * size.cwiseAbs2();
  covariance.amplitude = squares.cwiseMax(least).cwiseSqrt();
  // Constant values carry no information on length scales.
  const double varying = (squares.array() > least.array()).cast<double>().sum();
  return covariance.amplitude.array().log().sum() + varying / 2 * logarithms / count;
}

}  // namespace

std::optional<Compliance> kriged_value(const ContactModel& contact, BlendRule rule) {
  if (rule == BlendRule::compliances) {
    if (!contact.compliance) return std::nullopt;
    return contact.compliance->values;
  }
  if (!contact.strength) return std::nullopt;
  Compliance value;
  value << 0, 0, contact.strength->value, 1, 0, 1;
  return value;
}

Eigen::Matrix3d kriged_frame(const ContactModel& contact, BlendRule rule) {
  return rule == BlendRule::compliances ? pressing_frame(contact) : contact.frame;
}

std::vector<std::vector<int>> contact_neighbours(const Model& model) {
  std::vector<std::set<int>> sets(model.contacts.size());
  const auto join = [&](const Eigen::Vector3i& group) {
    for (const int a : group) {
      for (const int b : group) {
        if (a >= 0 && b >= 0 && a != b) sets[static_cast<std::size_t>(a)].insert(b);
      }
    }
  };
  for (const auto& triangle : model.triangles.colwise()) join(triangle);
  for (const auto& group : model.surface_weights.contacts.colwise()) join(group);
  std::vector<std::vector<int>> result;
  result.reserve(sets.size());
  for (const std::set<int>& set : sets) result.emplace_back(set.begin(), set.end());
  return result;
}

Surroundings surroundings(const Model& model, const std::vector<std::vector<int>>& neighbours,
                          std::vector<int> from, const Eigen::Vector3d& place,
                          const Eigen::Matrix3d& frame, int excluded) {
  std::set<int> found(from.begin(), from.end());
  for (int ring = 0; ring < 2; ++ring) {
    std::vector<int> next;
    for (const int contact : from) {
      for (const int other : neighbours[static_cast<std::size_t>(contact)]) {
        if (found.insert(other).second) next.push_back(other);
      }
    }
    from = std::move(next);
  }
  std::vector<std::pair<double, int>> nearest;
  for (const int contact : found) {
    const ContactModel& other = model.contacts[static_cast<std::size_t>(contact)];
    if (contact == excluded || !kriged_value(other, model.interpolation.rule)) continue;
    nearest.emplace_back((other.position - place).norm(), contact);
  }
  std::ranges::sort(nearest);
  if (nearest.size() > kMaxSurroundings) nearest.resize(kMaxSurroundings);
  Surroundings result;
  const auto count = static_cast<Eigen::Index>(nearest.size());
  result.places.resize(2, count);
  result.values.resize(6, count);
  for (Eigen::Index j = 0; j < count; ++j) {
    const int contact = nearest[static_cast<std::size_t>(j)].second;
    const ContactModel& other = model.contacts[static_cast<std::size_t>(contact)];
    result.contacts.push_back(contact);
    result.places.col(j) = frame.leftCols<2>().transpose() * (other.position - place);
    const BlendRule rule = model.interpolation.rule;
    result.values.col(j) =
        turned(*kriged_value(other, rule), turn_between(kriged_frame(other, rule), frame));
  }
  return result;
}

KrigingPrediction predict_compliance(const Surroundings& around, const Covariance& covariance) {
  const System system = make_system(around.places, covariance);
  Eigen::VectorXd to_place = (covariance.whiten * around.places).colwise().norm().transpose();
  to_place = to_place.unaryExpr(&matern);
  // Weights of the values, with sum 1: K^-1 (k + 1 (1 - 1^T K^-1 k) / 1^T K^-1 1)
  const double lack = 1 - system.ones.dot(to_place);
  const Eigen::VectorXd weights = system.factor.solve(to_place) + lack / system.sum * system.ones;
  const double variance =
      1 - to_place.dot(system.factor.solve(to_place)) + lack * lack / system.sum;
  return {around.values * weights, std::max(variance, 0.0)};
}

Eigen::Matrix<double, 6, 5> kriging_trend(const Surroundings& around, const Compliance& value,
                                          const Covariance& covariance) {
  Eigen::Matrix<double, 6, 5> trend = Eigen::Matrix<double, 6, 5>::Zero();
  const Eigen::Index count = around.places.cols();
  if (count == 0) return trend;
  Eigen::Matrix2Xd places(2, count + 1);
  places << Eigen::Vector2d::Zero(), around.places;
  Values values(6, count + 1);
  values << value, around.values;
  const System system = make_system(places, covariance);
  const Compliance mean = values * system.ones / system.sum;
  const Values weights = system.factor.solve((values.colwise() - mean).transpose()).transpose();
  for (Eigen::Index j = 0; j <= count; ++j) {
    const Eigen::Vector2d step = -(covariance.whiten * places.col(j));
    const double a = std::sqrt(5.0) * step.norm(), decay = 5.0 / 3 * std::exp(-a);
    const Eigen::Vector2d gradient = covariance.whiten.transpose() * (-decay * (1 + a) * step);
    const Eigen::Matrix2d second =
        covariance.whiten.transpose() *
        (decay * (5 * step * step.transpose() - (1 + a) * Eigen::Matrix2d::Identity())) *
        covariance.whiten;
    Eigen::Vector<double, 5> derivatives;
    derivatives << gradient, second(0, 0), second(0, 1), second(1, 1);
    trend += weights.col(j) * derivatives.transpose();
  }
  return trend;
}

Covariance learn_covariance(const std::vector<Surroundings>& around,
                            const std::vector<Compliance>& values, double spacing) {
  const Compliance size = sizes(values);
  const Eigen::Matrix2d directions = principal_directions(around, values, size);
  const Parameters low(std::log2(kShortestLength), std::log2(kShortestLength),
                       std::log2(kLeastNoise));
  const Parameters high(std::log2(kLongestLength), std::log2(kLongestLength),
                        std::log2(kMostNoise));
  const auto evaluate = [&](const Parameters& parameters, Covariance& covariance) {
    covariance = to_covariance(parameters, directions, spacing);
    return fit_amplitudes(around, values, size, covariance);
  };
  // Compass search suffices: the likelihood is smooth, and its few parameters need not be accurate.
  Parameters best(std::log2(kFirstLength), std::log2(kFirstLength), std::log2(kFirstNoise));
  Covariance covariance;
  double least = evaluate(best, covariance);
  double step = kFirstStep;
  for (int round = 0; round < kMaxRounds && step >= kLastStep; ++round) {
    bool better = false;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {1.0, -1.0}) {
        Parameters next = best;
        next(axis) = std::clamp(best(axis) + sign * step, low(axis), high(axis));
        if (next(axis) == best(axis)) continue;
        Covariance candidate;
        const double value = evaluate(next, candidate);
        if (!(value < least)) continue;
        least = value;
        best = next;
        covariance = candidate;
        better = true;
        break;
      }
    }
    if (!better) step /= 2;
  }
  return covariance;
}

ComplianceKriging learn_kriging(const Model& model) {
  ComplianceKriging result;
  result.neighbours = contact_neighbours(model);
  std::vector<Compliance> values;
  std::vector<double> distances;
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    const ContactModel& contact = model.contacts[i];
    const std::optional<Compliance> value = kriged_value(contact, model.interpolation.rule);
    if (!value) continue;
    const auto index = static_cast<int>(i);
    Surroundings found = surroundings(model, result.neighbours, {index}, contact.position,
                                      kriged_frame(contact, model.interpolation.rule), index);
    if (found.contacts.empty()) continue;
    const ContactModel& nearest = model.contacts[static_cast<std::size_t>(found.contacts.front())];
    distances.push_back((nearest.position - contact.position).norm());
    result.known.push_back(index);
    result.around.push_back(std::move(found));
    values.push_back(*value);
  }
  if (result.known.empty()) return result;
  result.spacing = median(distances);
  const std::size_t stride = (values.size() + kMaxLearntFrom - 1) / kMaxLearntFrom;
  std::vector<Surroundings> some_around;
  std::vector<Compliance> some_values;
  for (std::size_t i = 0; i < values.size(); i += stride) {
    some_around.push_back(result.around[i]);
    some_values.push_back(values[i]);
  }
  result.covariance = learn_covariance(some_around, some_values, result.spacing);
  return result;
}

}  // namespace palpate::haptics
