// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/pressing_estimate.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "samples/pressing_data.h"
#include "samples/pressing_statistics.h"

namespace palpate::haptics {
namespace {

// Largest number of contacts, evenly selected, from which degree and offsets are chosen.
constexpr std::size_t kMostInChoice = 400;
// Fewer contacts do not distinguish offsets from the shape of their curves.
constexpr std::size_t kFewestContacts = 12;
// The forces on the way back differ if the difference exceeds its standard error by this factor,
// and this share of the force.
constexpr double kHysteresisErrors = 4, kLeastHysteresis = 0.01;
// Pressing within this tangent of the direction shows nothing about the stiffness across: rounding
// and noise of positions look the same.
constexpr double kLeastSlope = 0.05;
// Added to the diagonal of normal equations relative to their trace: far below the information of
// any measurement, it sets to zero what nothing determines.
constexpr double kRidge = 1e-9;
// Rounds in which hysteresis, curves and offsets are fitted to each other.
constexpr int kHysteresisRounds = 4;

double curve_force(const Rows& coefficients, double zeta) {
  double sum = 0;
  for (Eigen::Index k = coefficients.size() - 1; k >= 0; --k) sum = (sum + coefficients(k)) * zeta;
  return sum;
}

// Forces across the pressing: they are the error of the force plus `ratio` times what the object's
// normal stiffness would give for the displacement across.
struct Across {
  BiasInformation bias;
  double ratio = kHalfSpaceRatio, ratio_error = kHalfSpaceRatioError;
};

Across across_forces(std::span<const PressedContact> contacts, const std::vector<Press>& presses,
                     const Scales& scales, const PressingState& state) {
  Across result;
  const Eigen::Index biases = scales.along ? 1 : 3;
  result.bias = {Eigen::MatrixXd::Zero(biases, biases), Eigen::VectorXd::Zero(biases)};
  if (scales.along) return result;
  // Unknowns: the error of the force, and the ratio with the half-space's as its prior.
  constexpr double kPrecision = 1 / (kHalfSpaceRatioError * kHalfSpaceRatioError);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d vector = Eigen::Vector4d::Zero();
  std::vector<Eigen::Matrix<double, 3, 4>> designs;
  for (std::size_t i = 0; i < presses.size(); ++i) {
    const Eigen::Vector3d along = contacts[i].direction.normalized();
    double force = 0;  // mean of the object's, along
    for (const double depth : presses[i].depth)
      force +=
          std::max(curve_force(state.coefficients[i], depth / scales.length + state.touches[i]),
                   0.0) /
          static_cast<double>(presses[i].depth.size());
    Eigen::Matrix<double, 3, 4> design;
    design << Eigen::Matrix3d::Identity() - along * along.transpose(),
        (presses[i].across_slope.norm() > kLeastSlope ? force : 0) * presses[i].across_slope;
    designs.push_back(design);
    matrix += design.transpose() * design;
    vector += design.transpose() * presses[i].across_force;
  }
  // Without the prior first, to know the scatter of the forces.
  const Eigen::Matrix4d tiny =
      (kRidge * matrix.trace() + std::numeric_limits<double>::min()) * Eigen::Matrix4d::Identity();
  const Eigen::Vector4d first = (matrix + tiny).ldlt().solve(vector);
  double squares = 0;
  for (std::size_t i = 0; i < presses.size(); ++i)
    squares += (presses[i].across_force - designs[i] * first).squaredNorm();
  const double least = std::pow(kAlongOnly * scales.force, 2);
  const double free = std::max(2.0 * static_cast<double>(presses.size()) - 4, 1.0);
  const double variance = std::max(squares / free, least);
  matrix /= variance;
  vector /= variance;
  matrix(3, 3) += kPrecision;
  vector(3) += kPrecision * kHalfSpaceRatio;
  const Eigen::Matrix4d covariance =
      (matrix + kRidge * matrix.trace() * Eigen::Matrix4d::Identity()).inverse();
  const double ratio = (covariance * vector)(3);
  // No object pulls the tool further across: such forces come from elsewhere.
  if (ratio > 0) {
    result.ratio = ratio;
    result.ratio_error = std::sqrt(covariance(3, 3));
  }
  // The part that remains for the error of the force once the ratio is integrated out.
  const Eigen::Vector3d mixed = matrix.block<3, 1>(0, 3);
  result.bias.matrix = matrix.topLeftCorner<3, 3>() - mixed * mixed.transpose() / matrix(3, 3);
  result.bias.vector = vector.head<3>() - mixed * vector(3) / matrix(3, 3);
  return result;
}

// Share of the force that is missing on the way back, with its standard error.
std::pair<double, double> hysteresis_of(std::span<const PressedContact> contacts,
                                        const std::vector<Press>& presses, const Scales& scales,
                                        const PressingState& state) {
  const int degree = state.variant.degree;
  std::vector<std::pair<double, double>> sums;  // per contact: force * curve, curve^2
  double product = 0, square = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (contacts[i].unloading.empty()) continue;
    double bias = 0;
    if (state.variant.force) {
      bias = scales.along
                 ? state.parameters(degree)
                 : contacts[i].direction.normalized().dot(state.parameters.segment<3>(degree));
    }
    double p = 0, s = 0;
    for (Eigen::Index j = 0; j < presses[i].depth.size(); ++j) {
      if (!contacts[i].unloading[static_cast<std::size_t>(j)]) continue;
      const double expected = curve_force(state.coefficients[i],
                                          presses[i].depth(j) / scales.length + state.touches[i]);
      p += (presses[i].force(j) - bias) * expected;
      s += expected * expected;
    }
    product += p;
    square += s;
    sums.emplace_back(p, s);
  }
  if (!(square > 0) || sums.size() < 2) return {0, 0};
  const double ratio = product / square;
  double scatter = 0;
  for (const auto& [p, s] : sums) scatter += (p - ratio * s) * (p - ratio * s);
  return {1 - ratio, std::sqrt(scatter) / square};
}

void weigh(std::span<const PressedContact> contacts, double hysteresis,
           std::vector<Press>& presses) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    for (std::size_t j = 0; j < contacts[i].unloading.size(); ++j) {
      if (contacts[i].unloading[j])
        presses[i].weight(static_cast<Eigen::Index>(j)) = 1 - hysteresis;
    }
  }
}

// The path to the deepest point alone, from which hysteresis starts.
std::vector<PressedContact> only_loading(std::span<const PressedContact> contacts) {
  std::vector<PressedContact> result(contacts.begin(), contacts.end());
  for (PressedContact& contact : result) {
    std::vector<Eigen::Index> kept;
    for (std::size_t j = 0; j < contact.unloading.size(); ++j)
      if (!contact.unloading[j]) kept.push_back(static_cast<Eigen::Index>(j));
    if (kept.empty()) continue;
    contact.displacements = Eigen::Matrix3Xd(contact.displacements(Eigen::all, kept));
    contact.forces = Eigen::Matrix3Xd(contact.forces(Eigen::all, kept));
    contact.unloading.clear();
  }
  return result;
}

// Degree and offsets by the Bayesian information criterion, over contacts that represent the
// acquisition.
PressingVariant choose_variant(std::span<const PressedContact> contacts,
                               const std::vector<Press>& presses, const Scales& scales,
                               double noise, const PressingOptions& options) {
  const std::size_t stride = (contacts.size() + kMostInChoice - 1) / kMostInChoice;
  std::vector<PressedContact> some;
  std::vector<Press> some_presses;
  double heights = 0;
  for (std::size_t i = 0; i < contacts.size(); i += stride) {
    some.push_back(contacts[i]);
    some_presses.push_back(presses[i]);
    heights = std::max(heights, std::abs(contacts[i].height));
  }
  const BiasInformation nothing{Eigen::MatrixXd::Zero(scales.along ? 1 : 3, scales.along ? 1 : 3),
                                Eigen::VectorXd::Zero(scales.along ? 1 : 3)};
  const bool offsets = options.estimate_offsets && some.size() >= kFewestContacts;
  double least = std::numeric_limits<double>::infinity();
  PressingState best;
  for (int degree = 1; degree <= std::min(kMaxDegree, scales.depths); ++degree) {
    const PressingVariant variant{.degree = degree,
                                  .force = offsets && scales.depths > 1,
                                  .touch = offsets && scales.depths > 2};
    PressingState state = fit_population(compressed(some, some_presses, scales, degree), variant,
                                         scales.force, noise, nothing);
    const double criterion = information_criterion(state, some.size());
    if (!(criterion < least)) break;
    least = criterion;
    best = std::move(state);
  }
  if (!offsets) return best.variant;
  const Across across = across_forces(some, some_presses, scales, best);
  const std::vector<CompressedPress> data =
      compressed(some, some_presses, scales, best.variant.degree);
  least = std::numeric_limits<double>::infinity();
  PressingVariant chosen = best.variant;
  for (const auto& [force, touch, height] : {std::array{false, false, false},
                                             {true, false, false},
                                             {false, true, false},
                                             {true, true, false},
                                             {false, true, true},
                                             {true, true, true}}) {
    // At fewer depths the intercepts do not separate late touches from soft places; heights may.
    if ((height && !(heights > 0)) || (force && scales.depths < 2) ||
        (touch && !height && scales.depths < 3))
      continue;
    const PressingVariant variant{best.variant.degree, force, touch, height};
    const PressingState state = fit_population(data, variant, scales.force, noise, across.bias);
    const double criterion = information_criterion(state, some.size());
    if (!(criterion < least)) continue;
    least = criterion;
    chosen = variant;
  }
  return chosen;
}

PressingOffsets offsets_of(const PressingState& state, const Scales& scales) {
  PressingOffsets offsets;
  const PressingVariant& variant = state.variant;
  offsets.along_direction = scales.along;
  offsets.force_found = variant.force;
  offsets.touch_found = variant.touch;
  const auto error = [&](Eigen::Index i) {
    return std::sqrt(std::max(state.parameter_covariance(i, i), 0.0));
  };
  if (variant.force && scales.along) {
    offsets.force.z() = state.parameters(variant.degree);
    offsets.force_error.z() = error(variant.degree);
  } else if (variant.force) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      offsets.force(i) = state.parameters(variant.degree + i);
      offsets.force_error(i) = error(variant.degree + i);
    }
  }
  if (variant.touch) {
    offsets.touch = scales.length * state.touch;
    offsets.touch_error = scales.length * std::sqrt(state.touch_covariance(0, 0));
    offsets.touch_spread = scales.length * std::sqrt(state.touch_variance);
  }
  if (variant.height) {
    offsets.height_slope = state.height_slope;
    offsets.height_slope_error = std::sqrt(state.touch_covariance(1, 1));
  }
  return offsets;
}

}  // namespace

double expected_touch(const PressingOffsets& offsets, double height) {
  return offsets.touch + offsets.height_slope * height;
}

double force_at(const PressingCurve& curve, double depth) {
  double sum = 0;
  for (Eigen::Index k = curve.coefficients.size() - 1; k >= 0; --k)
    sum = (sum + curve.coefficients(k)) * depth;
  return sum;
}

PressingEstimate estimate_pressing(std::span<const PressedContact> contacts,
                                   const PressingOptions& options) {
  require("PressingOptions::force_noise", options.force_noise, above(0).finite(), "N");
  if (contacts.empty())
    throw InvalidInput("estimate_pressing(): there is no contact; pass at least one");
  for (std::size_t i = 0; i < contacts.size(); ++i) check_pressed(contacts[i], i);
  const double noise = options.force_noise.value_or(0);
  const bool returns = std::ranges::any_of(
      contacts, [](const PressedContact& contact) { return !contact.unloading.empty(); });

  // The way in alone determines degree and offsets; the way back would look like an offset.
  const std::vector<PressedContact> loading =
      returns ? only_loading(contacts) : std::vector<PressedContact>();
  const std::span<const PressedContact> inwards = returns ? std::span(loading) : contacts;
  std::vector<Press> presses = presses_of(inwards);
  const Scales scales = scales_of(inwards, presses);
  const PressingVariant variant = choose_variant(inwards, presses, scales, noise, options);
  const BiasInformation nothing{Eigen::MatrixXd::Zero(scales.along ? 1 : 3, scales.along ? 1 : 3),
                                Eigen::VectorXd::Zero(scales.along ? 1 : 3)};
  std::vector<CompressedPress> data = compressed(inwards, presses, scales, variant.degree);
  PressingState state = fit_population(data, variant, scales.force, noise, nothing);
  Across across = across_forces(inwards, presses, scales, state);
  state = fit_population(data, variant, scales.force, noise, across.bias);

  double hysteresis = 0, hysteresis_error = 0;
  if (returns) {
    presses = presses_of(contacts);
    for (int round = 0; round < kHysteresisRounds; ++round) {
      std::tie(hysteresis, hysteresis_error) = hysteresis_of(contacts, presses, scales, state);
      if (std::abs(hysteresis) < std::max(kHysteresisErrors * hysteresis_error, kLeastHysteresis))
        hysteresis = 0;
      weigh(contacts, hysteresis, presses);
      data = compressed(contacts, presses, scales, variant.degree);
      state = fit_population(data, variant, scales.force, noise, across.bias);
    }
  }
  PressingEstimate estimate;
  estimate.length_scale =
      fit_neighbourhood(data, contacts, scales.force, across.bias, !options.force_noise, state);
  across = across_forces(contacts, presses, scales, state);
  estimate.offsets = offsets_of(state, scales);
  estimate.offsets.hysteresis = hysteresis;
  estimate.offsets.hysteresis_error = hysteresis_error;
  estimate.force_noise = std::sqrt(state.noise_variance);
  estimate.noise_was_estimated = !options.force_noise;
  estimate.lateral_ratio = across.ratio;
  estimate.lateral_ratio_error = across.ratio_error;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    PressingCurve curve;
    curve.coefficients = state.coefficients[i];
    for (Eigen::Index k = 0; k < curve.coefficients.size(); ++k)
      curve.coefficients(k) /= std::pow(scales.length, k + 1);
    curve.touch = scales.length * state.touches[i];
    curve.touch_error = scales.length * std::sqrt(std::max(state.touch_variances[i], 0.0));
    curve.reach = presses[i].depth.maxCoeff() + curve.touch;
    estimate.curves.push_back(std::move(curve));
  }
  return estimate;
}

}  // namespace palpate::haptics
