// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "palpate/geometry/median.h"
#include "palpate/parallel_for.h"
#include "samples/pressing_statistics.h"

namespace palpate::haptics {
namespace {

// Contacts around a contact: in the search for the covariance, and for the result.
constexpr std::size_t kAroundInSearch = 12, kAroundInResult = 24;
// Largest numbers of contacts, evenly selected: whose prediction the search maximises, and from
// which the parameters follow.
constexpr std::size_t kMostInSearch = 96, kMostInSquares = 160;
// The search, in binary logarithms: length scale relative to the spacing of contacts, share of the
// variance that neighbours do not have in common, variance relative to that of the population,
// spread of tau relative to that of the population.
using Search = Eigen::Vector4d;
const Search kSearchFirst{2, -6, 1, 0};
const Search kSearchLow{-1, -20, -2, -6};
const Search kSearchHigh{6, 0, 8, 2};
constexpr double kFirstSearchStep = 2, kLastSearchStep = 0.5;
constexpr int kMaxSearchRounds = 12;
// Rounds of linearisation after the search.
constexpr int kLinearRounds = 3;
// The first of them search for the covariance.
constexpr int kSearches = 1;
// Steps of the search for the mean of tau and its slope, and its rounds.
constexpr double kTouchStepThere = 0.005, kSlopeStepThere = 0.05;
constexpr int kTouchRounds = 3;
constexpr double kMostTouchThere = 0.3;  // |tau|
// A variance counts as zero below this share of the force scale's square.
constexpr double kNoVariance = 1e-12;

struct Spatial {
  double length = 1;     // [mm]
  double nugget = 0;     // share of a coefficient's variance beside what varies smoothly
  double amplitude = 1;  // of the covariance of the population
  double touch_variance = 0;
};

double matern_at(double distance) {
  const double a = std::sqrt(5.0) * distance;
  return (1 + a + a * a / 3) * std::exp(-a);
}

// Indices of the contacts nearest to each, itself first, on the same side of the object.
std::vector<std::vector<std::size_t>> nearest_contacts(std::span<const PressedContact> contacts) {
  std::vector<std::vector<std::size_t>> result(contacts.size());
  parallel_for(contacts.size(), [&](std::size_t i) {
    std::vector<std::pair<double, std::size_t>> others;
    for (std::size_t j = 0; j < contacts.size(); ++j) {
      if (j == i || !(contacts[i].direction.dot(contacts[j].direction) > 0)) continue;
      others.emplace_back((contacts[j].position - contacts[i].position).squaredNorm(), j);
    }
    const std::size_t count = std::min(kAroundInResult, others.size());
    std::partial_sort(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(count),
                      others.end());
    result[i].push_back(i);
    for (std::size_t k = 0; k < count; ++k) result[i].push_back(others[k].second);
  });
  return result;
}

double spacing_of(std::span<const PressedContact> contacts,
                  const std::vector<std::vector<std::size_t>>& nearest) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    if (nearest[i].size() > 1)
      distances.push_back((contacts[nearest[i][1]].position - contacts[i].position).norm());
  }
  return distances.empty() ? 0 : geometry::median(std::move(distances));
}

// The linearised contacts, with curves in units of their standard deviations over the object.
struct Neighbourhood {
  std::span<const PressedContact> contacts;
  std::vector<LinearPress> presses;
  std::vector<RowBlock> white;  // curve times a root of the covariance
  RowBlock root;                // of the covariance
  double noise_variance = 0;
};

Neighbourhood neighbourhood_of(std::span<const CompressedPress> presses,
                               std::span<const PressedContact> contacts,
                               const PressingState& state) {
  Neighbourhood result;
  result.contacts = contacts;
  result.noise_variance = state.noise_variance;
  result.root = Eigen::LLT<Eigen::MatrixXd>(state.covariance).matrixL();
  result.presses.resize(presses.size());
  result.white.resize(presses.size());
  for (std::size_t i = 0; i < presses.size(); ++i) {
    result.presses[i] = linearized(presses[i], state, state.coefficients[i],
                                   expected_tau(state, presses[i].height));
    result.white[i] = result.presses[i].curve * result.root;
  }
  return result;
}

// Covariance of all data of some contacts, with their data and design.
struct Stack {
  Eigen::MatrixXd covariance, design;
  Eigen::VectorXd force;
  std::vector<Eigen::Index> begin;  // of each contact's rows, and the end
};

double correlation(const Neighbourhood& all, std::size_t i, std::size_t j, const Spatial& spatial) {
  if (i == j) return 1 + spatial.nugget;
  return matern_at((all.contacts[i].position - all.contacts[j].position).norm() / spatial.length);
}

Stack stack(const Neighbourhood& all, std::span<const std::size_t> members,
            const Spatial& spatial) {
  Stack result;
  result.begin = {0};
  for (const std::size_t i : members)
    result.begin.push_back(result.begin.back() + all.presses[i].force.size());
  const Eigen::Index rows = result.begin.back();
  const Eigen::Index columns = all.presses[members[0]].design.cols();
  result.covariance.resize(rows, rows);
  result.design.resize(rows, columns);
  result.force.resize(rows);
  for (std::size_t a = 0; a < members.size(); ++a) {
    const std::size_t i = members[a];
    const LinearPress& press = all.presses[i];
    const Eigen::Index at = result.begin[a], size = press.force.size();
    result.design.middleRows(at, size) = press.design;
    result.force.segment(at, size) = press.force;
    for (std::size_t b = 0; b <= a; ++b) {
      const std::size_t j = members[b];
      const double factor = spatial.amplitude * correlation(all, i, j, spatial);
      const RowBlock block = factor * all.white[i] * all.white[j].transpose();
      result.covariance.block(at, result.begin[b], size, block.cols()) = block;
    }
    result.covariance.block(at, at, size, size) +=
        spatial.touch_variance * press.touch * press.touch.transpose();
    result.covariance.diagonal().segment(at, size).array() += all.noise_variance;
  }
  return result;
}

// Sums for generalised least squares, and -2 log likelihood without its constant.
struct Squares {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd vector;
  double fit = 0;
};

// Of the data of the first member, given those of the others.
Squares conditional(const Neighbourhood& all, std::span<const std::size_t> members,
                    const Spatial& spatial) {
  // The first member goes last: its rows of the Cholesky factor are those given the others.
  std::vector<std::size_t> order(members.begin() + 1, members.end());
  order.push_back(members[0]);
  const Stack data = stack(all, order, spatial);
  const Eigen::LLT<Eigen::MatrixXd> factor(data.covariance);
  const Eigen::Index size = data.force.size() - data.begin[order.size() - 1];
  Eigen::MatrixXd both(data.force.size(), data.design.cols() + 1);
  both << data.design, data.force;
  factor.matrixL().solveInPlace(both);
  const Eigen::MatrixXd last = both.bottomRows(size);
  const Eigen::MatrixXd design = last.leftCols(data.design.cols());
  const Eigen::VectorXd force = last.rightCols(1);
  return {design.transpose() * design, design.transpose() * force,
          force.squaredNorm() + 2 * factor.matrixLLT().diagonal().tail(size).array().log().sum()};
}

std::vector<std::size_t> evenly_selected(std::size_t count, std::size_t most) {
  const std::size_t stride = (count + most - 1) / most;
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < count; i += stride) result.push_back(i);
  return result;
}

Spatial spatial_of(const Search& at, double spacing, double touch_variance) {
  return {.length = spacing * std::exp2(at(0)),
          .nugget = std::exp2(at(1)),
          .amplitude = std::exp2(at(2)),
          .touch_variance = touch_variance * std::exp2(2 * at(3))};
}

// What the search for the covariance needs.
struct Conditionals {
  std::span<const CompressedPress> presses;
  std::span<const PressedContact> contacts;
  const std::vector<std::vector<std::size_t>>& nearest;
  double force_scale;
  const BiasInformation& bias;
  std::vector<std::size_t> chosen;
};

// -2 log likelihood of the data of the chosen contacts, each given those around it.
double conditional_loss(const Conditionals& data, const Neighbourhood& all,
                        const PressingState& state, const Spatial& spatial) {
  std::vector<Squares> parts(data.chosen.size());
  parallel_for(data.chosen.size(), [&](std::size_t c) {
    const std::vector<std::size_t>& around = data.nearest[data.chosen[c]];
    const std::size_t count = std::min(around.size(), kAroundInSearch + 1);
    parts[c] = conditional(all, std::span(around).first(count), spatial);
  });
  Squares sum = parts[0];
  for (std::size_t c = 1; c < parts.size(); ++c) {
    sum.matrix += parts[c].matrix;
    sum.vector += parts[c].vector;
    sum.fit += parts[c].fit;
  }
  add_priors(state.variant, data.force_scale, data.bias, sum.matrix, sum.vector);
  return sum.fit - sum.vector.dot(sum.matrix.ldlt().solve(sum.vector)) + touch_prior(state);
}

Spatial learn_spatial(const Conditionals& data, const PressingState& state, double spacing) {
  const Neighbourhood all = neighbourhood_of(data.presses, data.contacts, state);
  const auto loss = [&](const Search& at) {
    return conditional_loss(data, all, state, spatial_of(at, spacing, state.touch_variance));
  };
  Search best = kSearchFirst;
  double least = loss(best);
  double step = kFirstSearchStep;
  const Eigen::Index axes = state.touch_variance > 0 ? 4 : 3;
  for (int round = 0; round < kMaxSearchRounds && step >= kLastSearchStep; ++round) {
    bool better = false;
    for (Eigen::Index axis = 0; axis < axes; ++axis) {
      for (const double sign : {1.0, -1.0}) {
        Search next = best;
        next(axis) = std::clamp(best(axis) + sign * step, kSearchLow(axis), kSearchHigh(axis));
        if (next(axis) == best(axis)) continue;
        const double value = loss(next);
        if (!(value < least)) continue;
        least = value;
        best = next;
        better = true;
        break;
      }
    }
    if (!better) step /= 2;
  }
  return spatial_of(best, spacing, state.touch_variance);
}

// The mean of tau and its slope, given the covariance.
void fit_touch(const Conditionals& data, const Spatial& spatial, PressingState& state) {
  if (!state.variant.touch) return;
  const auto step = [&](double PressingState::*value, double size) {
    double next = state.*value;
    const double error = newton_step(
        [&](double at) {
          PressingState there = state;
          there.*value = at;
          return conditional_loss(data, neighbourhood_of(data.presses, data.contacts, there), there,
                                  spatial);
        },
        size, next);
    state.*value = next;
    return error;
  };
  for (int round = 0; round < kTouchRounds; ++round) {
    state.touch_error = step(&PressingState::touch, kTouchStepThere);
    if (!state.variant.height) continue;
    state.height_slope_error = step(&PressingState::height_slope, kSlopeStepThere);
  }
}

// Generalised least squares over contacts that represent the object. `covariance` is optional.
Eigen::VectorXd solve_parameters(const Neighbourhood& all, const Spatial& spatial,
                                 double force_scale, const BiasInformation& bias,
                                 const PressingState& state, Eigen::MatrixXd* covariance) {
  const std::vector<std::size_t> chosen = evenly_selected(all.presses.size(), kMostInSquares);
  const Stack data = stack(all, chosen, spatial);
  const Eigen::LLT<Eigen::MatrixXd> factor(data.covariance);
  const Eigen::MatrixXd white = factor.matrixL().solve(data.design);
  const Eigen::VectorXd force = factor.matrixL().solve(data.force);
  Eigen::MatrixXd matrix = white.transpose() * white;
  Eigen::VectorXd vector = white.transpose() * force;
  add_priors(state.variant, force_scale, bias, matrix, vector);
  const Eigen::LDLT<Eigen::MatrixXd> solver(matrix);
  if (covariance)
    *covariance = solver.solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
  return solver.solve(vector);
}

// The parameters, with the part of their errors that comes from the mean of tau.
void fit_parameters(const Conditionals& data, const Spatial& spatial, PressingState& state) {
  const auto at = [&](const PressingState& there, Eigen::MatrixXd* covariance) {
    return solve_parameters(neighbourhood_of(data.presses, data.contacts, there), spatial,
                            data.force_scale, data.bias, there, covariance);
  };
  state.parameters = at(state, &state.parameter_covariance);
  if (!state.variant.touch || !std::isfinite(state.touch_error)) return;
  PressingState moved = state;
  moved.touch += state.touch_error;
  const Eigen::VectorXd change = at(moved, nullptr) - state.parameters;
  state.parameter_covariance += change * change.transpose();
}

// Coefficients and touch of a contact, from its data and those around it. Its own data are linear
// about what was found before.
void update_contact(const Neighbourhood& all, std::span<const std::size_t> members,
                    const CompressedPress& press, const Spatial& spatial, PressingState& state) {
  const int degree = state.variant.degree;
  const std::size_t self = members[0];
  const double tau = state.touches[self], expected = expected_tau(state, press.height);
  const LinearPress own = linearized(press, state, state.coefficients[self], tau);
  // Own data about the own tau, whose expected value lies (expected - tau) away.
  Stack data = stack(all, members, spatial);
  const Eigen::Index size = data.begin[1];
  const RowBlock white = own.curve * all.root;
  for (std::size_t a = 0; a < members.size(); ++a) {
    const double factor = spatial.amplitude * correlation(all, self, members[a], spatial);
    const RowBlock& other = a == 0 ? white : all.white[members[a]];
    data.covariance.block(data.begin[a], 0, other.rows(), size) =
        factor * other * white.transpose();
  }
  data.covariance.topLeftCorner(size, size) +=
      spatial.touch_variance * own.touch * own.touch.transpose();
  data.covariance.diagonal().head(size).array() += all.noise_variance;
  data.design.topRows(size) = own.design;
  Eigen::VectorXd residual = data.force - data.design * state.parameters;
  residual.head(size) -= (expected - tau) * own.touch;
  const Eigen::LLT<Eigen::MatrixXd> factor(data.covariance);
  Eigen::MatrixXd gain(degree + 1, data.force.size());
  gain.setZero();
  for (std::size_t a = 0; a < members.size(); ++a) {
    const double amount = spatial.amplitude * correlation(all, self, members[a], spatial);
    const RowBlock& other = a == 0 ? white : all.white[members[a]];
    gain.block(0, data.begin[a], degree, other.rows()) = amount * all.root * other.transpose();
  }
  gain.row(degree).head(size) = spatial.touch_variance * own.touch.transpose();
  const Eigen::VectorXd change = gain * factor.solve(residual);
  const Eigen::VectorXd half = factor.matrixL().solve(gain.row(degree).transpose());
  state.coefficients[self] = state.parameters.head(degree) + change.head(degree);
  if (!state.variant.touch) return;
  state.touches[self] = std::clamp(expected + change(degree), -kMostTouchThere, kMostTouchThere);
  // The expected touch is not known exactly; the contact's own data correct a part of its error.
  Eigen::VectorXd of_touch = Eigen::VectorXd::Zero(data.force.size());
  of_touch.head(size) = own.touch;
  const double kept = 1 - gain.row(degree).dot(factor.solve(of_touch));
  const double mean_variance =
      state.touch_error * state.touch_error + std::pow(state.height_slope_error * press.height, 2);
  state.touch_variances[self] =
      spatial.touch_variance - half.squaredNorm() + kept * kept * mean_variance;
}

}  // namespace

double fit_neighbourhood(std::span<const CompressedPress> presses,
                         std::span<const PressedContact> contacts, double force_scale,
                         const BiasInformation& bias, PressingState& state) {
  const std::vector<std::vector<std::size_t>> nearest = nearest_contacts(contacts);
  const double spacing = spacing_of(contacts, nearest);
  if (!(spacing > 0) || state.covariance.norm() < kNoVariance * force_scale * force_scale) return 0;
  const Conditionals data{presses,     contacts, nearest,
                          force_scale, bias,     evenly_selected(contacts.size(), kMostInSearch)};
  Spatial spatial;
  for (int round = 0; round < kLinearRounds; ++round) {
    if (round < kSearches) {
      spatial = learn_spatial(data, state, spacing);
      state.touch_variance = spatial.touch_variance;
      fit_touch(data, spatial, state);
    }
    const Neighbourhood all = neighbourhood_of(presses, contacts, state);
    fit_parameters(data, spatial, state);
    parallel_for(contacts.size(), [&](std::size_t i) {
      update_contact(all, nearest[i], presses[i], spatial, state);
    });
  }
  return spatial.length;
}

}  // namespace palpate::haptics
