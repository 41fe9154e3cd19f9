// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "palpate/core/parallel_for.h"
#include "palpate/core/quantile.h"
#include "samples/nearest_contacts.h"
#include "samples/pressing_stack.h"

namespace palpate::haptics {
namespace {

// Contacts around a contact: in the search for the covariance, and for the result.
constexpr std::size_t kAroundInSearch = 12, kAroundInResult = 24;
// Largest number of contacts, evenly selected, whose prediction the search maximises.
constexpr std::size_t kMostInSearch = 96;
// The search, in binary logarithms: length scale relative to the spacing of contacts, share of the
// variance that neighbours do not have in common, variance relative to that of the population,
// spread of tau and noise relative to those of the population.
using Search = Eigen::Vector<double, 5>;
const Search kSearchFirst{{2, -6, 1, 0, 0}};
// The same if the samples of a contact do not tell noise from its curve: then all that neighbours
// do not have in common counts as noise.
const Search kSearchFirstOfNoise{{2, -20, 1, -6, 0}};
constexpr std::array kFirstNoises = {1.0, 3.0, 5.0};
const Search kSearchLow{{-1, -20, -2, -6, -8}};
const Search kSearchHigh{{6, 0, 8, 2, 8}};
// Along a long valley: curves that are smooth over a larger length with a larger variance look
// alike at neighbours.
const Search kSmoother{{0.5, 0, 1.5, 0, 0}};
constexpr double kFirstSearchStep = 2, kLastSearchStep = 0.5;
constexpr int kMaxSearchRounds = 12;
// Rounds of linearisation after the search.
constexpr int kLinearRounds = 3;
// The first of them search for the covariance.
constexpr int kSearches = 1;
constexpr double kMostTouchThere = 0.3;  // |tau|
// A variance counts as zero below this share of the force scale's square.
constexpr double kNoVariance = 1e-12;

double spacing_of(std::span<const PressedContact> contacts,
                  const std::vector<std::vector<std::size_t>>& nearest) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    if (nearest[i].size() > 1)
      distances.push_back((contacts[nearest[i][1]].position - contacts[i].position).norm());
  }
  return distances.empty() ? 0 : median(distances);
}

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

// The data that the search for the covariance needs.
struct Conditionals {
  const PressingData& all;
  bool finds_noise;
  const std::vector<std::vector<std::size_t>>& nearest;
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
  for (std::size_t c = 1; c < parts.size(); ++c) parts[0] += parts[c];
  return profiled_loss(data.all, state, std::move(parts[0]));
}

// The directions in which the search goes.
std::vector<Search> search_directions(bool finds_touches, bool finds_noise) {
  std::vector<Search> directions = {Search::Unit(0)};
  if (!finds_noise) directions.push_back(Search::Unit(1));
  directions.push_back(Search::Unit(2));
  if (finds_touches) directions.push_back(Search::Unit(3));
  if (finds_noise) directions.insert(directions.end(), {Search::Unit(4), kSmoother});
  return directions;
}

struct Found {
  Search at;
  double loss = 0;
};

Found descend(const std::function<double(const Search&)>& loss,
              const std::vector<Search>& directions, const Search& first) {
  Found best{first, loss(first)};
  double step = kFirstSearchStep;
  for (int round = 0; round < kMaxSearchRounds && step >= kLastSearchStep; ++round) {
    bool better = false;
    for (const Search& direction : directions) {
      for (const double sign : {1.0, -1.0}) {
        const Search next =
            (best.at + sign * step * direction).cwiseMax(kSearchLow).cwiseMin(kSearchHigh);
        if (next == best.at) continue;
        const double value = loss(next);
        if (!(value < best.loss)) continue;
        best = {next, value};
        better = true;
        break;
      }
    }
    if (!better) step /= 2;
  }
  return best;
}

// Sets the noise as well if that is searched for.
Spatial learn_spatial(const Conditionals& data, double spacing, PressingState& state) {
  Neighbourhood all = neighbourhood_of(data.all.presses, data.all.contacts, state);
  const auto noise_variance = [&](const Search& at) {
    return state.noise_variance * std::exp2(2 * at(4));
  };
  const auto loss = [&](const Search& at) {
    all.noise_variance = noise_variance(at);
    return conditional_loss(data, all, state, spatial_of(at, spacing, state.touch_variance));
  };
  const std::vector<Search> directions =
      search_directions(state.touch_variance > 0, data.finds_noise);
  Found best;
  if (!data.finds_noise) best = descend(loss, directions, kSearchFirst);
  // Little noise on curves that change over short lengths is a minimum as well as much noise on
  // smooth ones.
  for (std::size_t i = 0; data.finds_noise && i < kFirstNoises.size(); ++i) {
    Search first = kSearchFirstOfNoise;
    first(4) = kFirstNoises[i];
    Found found = descend(loss, directions, first);
    if (i == 0 || found.loss < best.loss) best = found;
  }
  state.noise_variance = noise_variance(best.at);
  return spatial_of(best.at, spacing, state.touch_variance);
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
  const Eigen::Vector2d by(1, press.height);
  const double mean_variance = by.dot(state.touch_covariance * by);
  state.touch_variances[self] =
      spatial.touch_variance - half.squaredNorm() + kept * kept * mean_variance;
}

}  // namespace

double fit_neighbourhood(std::span<const CompressedPress> presses,
                         std::span<const PressedContact> contacts, double force_scale,
                         const BiasInformation& bias, bool estimate_noise, PressingState& state) {
  const std::vector<std::vector<std::size_t>> nearest = nearest_contacts(contacts, kAroundInResult);
  const double spacing = spacing_of(contacts, nearest);
  if (!(spacing > 0) || state.covariance.norm() < kNoVariance * force_scale * force_scale) return 0;
  const PressingData data{presses, contacts, force_scale, bias};
  const bool one_sample_a_coefficient = std::ranges::all_of(
      presses, [&](const auto& press) { return press.samples <= state.variant.degree; });
  const bool finds_noise =
      estimate_noise && one_sample_a_coefficient && contacts.size() > kAroundInResult;
  const Conditionals chosen{data, finds_noise, nearest,
                            evenly_selected(contacts.size(), kMostInSearch)};
  Spatial spatial;
  for (int round = 0; round < kLinearRounds; ++round) {
    if (round < kSearches) {
      spatial = learn_spatial(chosen, spacing, state);
      state.touch_variance = spatial.touch_variance;
      fit_offsets(data, spatial, state);
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
