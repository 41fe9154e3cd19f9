// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/document_contact.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "model/field_document_format.h"
#include "model/stored_form.h"

namespace palpate::haptics {
namespace {

using documents::kLargestDocumentNumber;
using Node = documents::DocumentNode;

template <std::size_t N>
std::array<double, N> numbers(const Node& node, const char* right) {
  std::array<double, N> result;
  node.read(result, right);
  return result;
}

std::optional<double> figure(const std::optional<Node>& node) {
  if (!node) return std::nullopt;
  return node->number_at_least_zero();
}

Multiquadric to_base(const Node& node) {
  const auto of = numbers<5>(node, "five numbers: weight, epsilon, three of the center");
  if (!(of[1] > 0)) static_cast<void>(node.items()[1].number_above_zero());
  return {of[0], of[1], {of[2], of[3], of[4]}};
}

Multiquadric ridge_of(const Node& node) {
  const auto of = numbers<5>(node, "five numbers: weight, offset, three of the slope");
  const StoredRidge ridge{of[0], of[1], {of[2], of[3], of[4]}};
  // Epsilon is the inverse of the slope's length and must not exceed the largest number.
  if (!(length_of(ridge.slope) >= 1 / kLargestDocumentNumber))
    node.refuse("the last three numbers to be a vector of a length of at least 1e-12");
  return to_ridge(ridge);
}

ForceField read_field(const Node& contact) {
  ForceField field;
  const std::vector<Node> bases = contact.at("bases").items(),
                          ridges = contact.at("ridges").items();
  field.bases.reserve(bases.size() + ridges.size());
  for (const Node& base : bases) field.bases.push_back(to_base(base));
  for (const Node& ridge : ridges) field.bases.push_back(ridge_of(ridge));
  return field;
}

Eigen::Matrix3d frame_of(const Node& node) {
  const auto of = numbers<4>(node, "four numbers of a quaternion: w, x, y, z");
  const Eigen::Vector4d quaternion(of.data());
  if (quaternion.isZero(0)) node.refuse("four numbers that are not all zero");
  return to_frame(quaternion);
}

Eigen::Vector3d to_unit_vector(const Node& node) {
  const Eigen::Vector3d direction = node.vector();
  if (direction.isZero(0)) node.refuse("three numbers that are not all zero");
  return to_direction(direction).normalized();
}

ContactCompliance to_compliance(const Node& node) {
  ContactCompliance compliance;
  compliance.direction = node.at("direction").vector();
  node.at("values").read({compliance.values.data(), 6}, "six numbers");
  const std::vector<Node> derivatives = node.at("trend").items();
  if (derivatives.size() != 5) node.at("trend").refuse("five derivatives of the six values");
  for (Eigen::Index i = 0; i < 5; ++i) {
    derivatives[static_cast<std::size_t>(i)].read({compliance.trend.col(i).data(), 6},
                                                  "six numbers");
  }
  return compliance;
}

ContactStrength to_strength(const Node& node) {
  ContactStrength strength{.value = node.at("value").number_at_least_zero()};
  node.at("trend").read({strength.trend.data(), 5}, "five numbers");
  return strength;
}

double load_exponent_of(const Node& node) {
  const double exponent = node.number();
  if (!(std::abs(exponent) <= kLargestLoadExponent)) node.refuse("a number from -0.5 to 0.5");
  return exponent;
}

ContactUncertainty to_uncertainty(const Node& node) {
  return {.force = node.at("force").number_at_least_zero(),
          .displacement = node.at("displacement").number_at_least_zero(),
          .across = node.at("across").number_at_least_zero(),
          .between = node.at("between").number_at_least_zero()};
}

}  // namespace

ContactModel to_contact(const Node& node) {
  ContactModel contact;
  contact.id = node.at("id").integer();
  contact.position = node.at("position").vector();
  contact.frame = frame_of(node.at("rotation"));
  contact.field = read_field(node);
  if (const auto compliance = node.find("compliance"))
    contact.compliance = to_compliance(*compliance);
  if (const auto strength = node.find("strength")) contact.strength = to_strength(*strength);
  if (const auto uncertainty = node.find("uncertainty"))
    contact.uncertainty = to_uncertainty(*uncertainty);
  const Node friction = node.at("friction"), fit = node.at("fit");
  contact.friction = friction.at("coefficient").number_at_least_zero();
  contact.friction_error = figure(friction.find("error"));
  if (const auto exponent = friction.find("load_exponent"))
    contact.load_exponent = load_exponent_of(*exponent);
  contact.friction_lower_bound = friction.at("lower_bound").number_at_least_zero();
  contact.friction_source = choice(friction.at("source"), kFrictionSources);
  contact.friction_axis = to_unit_vector(friction.at("axis"));
  contact.samples = fit.at("samples").integer_between(0, std::numeric_limits<int>::max());
  contact.rms = fit.at("rms").number_at_least_zero();
  contact.fit_stop = choice(fit.find("stop"), kFitStops);
  contact.fit_mode = choice(fit.find("mode"), kFitModes);
  contact.passivity = choice(fit.find("passivity"), kPassivities);
  contact.chi2 = figure(fit.find("chi2"));
  contact.noise_floor = figure(fit.find("noise_floor"));
  contact.condition = figure(fit.find("condition"));
  if (const auto shared = fit.find("shared_local")) contact.shared_local = shared->truth();
  return contact;
}

}  // namespace palpate::haptics
