// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/rounding.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "model/stored_form.h"

namespace palpate::haptics {
namespace {

constexpr int kPositionDigits = 9;  // of the size of the object
constexpr int kFrictionDigits = 6;
constexpr int kRateDigits = 6;
constexpr int kReportDigits = 4;  // of errors and other figures that nothing is computed from

// `std::to_chars` writes the nearest decimal, and reading it gives the same double as reading the
// file will. Multiplying by powers of ten guarantees neither.
double through_text(double value, std::chars_format format, int precision) {
  constexpr std::size_t kLongest = 512;  // the largest double with some decimal places takes 330
  std::array<char, kLongest> text;
  const auto written =
      std::to_chars(text.data(), text.data() + text.size(), value, format, precision);
  double result = value;
  std::from_chars(text.data(), written.ptr, result);
  return result;
}

Multiquadric rounded_base(Multiquadric base) {
  if (!base.ridge.isZero(0)) return to_ridge(rounded(to_stored(base)));
  for (double* number :
       {&base.weight, &base.epsilon, &base.center[0], &base.center[1], &base.center[2]}) {
    *number = round_to_digits(*number, kFieldDigits);
  }
  return base;
}

}  // namespace

double round_to_digits(double value, int digits) {
  if (!std::isfinite(value) || value == 0) return value;
  return through_text(value, std::chars_format::scientific, digits - 1);
}

double round_to_places(double value, int places) {
  if (!std::isfinite(value)) return value;
  return through_text(value, std::chars_format::fixed, places) + 0.0;  // -0 + 0 = 0
}

ForceField rounded(ForceField field) {
  for (Multiquadric& base : field.bases) base = rounded_base(base);
  std::stable_partition(field.bases.begin(), field.bases.end(),
                        [](const Multiquadric& base) { return base.ridge.isZero(0); });
  return field;
}

ContactModel rounded(ContactModel contact) {
  contact.frame = to_frame(rounded(to_quaternion(contact.frame)));
  contact.friction_axis = rounded(to_direction(contact.friction_axis)).normalized();
  contact.field = rounded(std::move(contact.field));
  contact.friction = round_to_digits(contact.friction, kFrictionDigits);
  contact.load_exponent = round_to_digits(contact.load_exponent, kFrictionDigits);
  for (double* figure : {&contact.friction_lower_bound, &contact.rms})
    *figure = round_to_digits(*figure, kReportDigits);
  for (std::optional<double>* figure :
       {&contact.friction_error, &contact.chi2, &contact.noise_floor, &contact.condition}) {
    if (*figure) *figure = round_to_digits(**figure, kReportDigits);
  }
  if (contact.uncertainty) {
    ContactUncertainty& own = *contact.uncertainty;
    for (double* figure : {&own.force, &own.displacement, &own.across, &own.between})
      *figure = round_to_digits(*figure, kReportDigits);
  }
  return contact;
}

Eigen::Vector3d rounded_position(const Eigen::Vector3d& position, double size) {
  if (!(size > 0)) return position;
  const int before_point = static_cast<int>(std::floor(std::log10(size))) + 1;
  const int places = std::max(kPositionDigits - before_point, 0);
  return position.unaryExpr([&](double entry) { return round_to_places(entry, places); });
}

std::vector<RateTerm> rounded(std::vector<RateTerm> rate) {
  for (RateTerm& term : rate) {
    term.share = round_to_digits(term.share, kRateDigits);
    term.time = round_to_digits(term.time, kRateDigits);
  }
  return rate;
}

}  // namespace palpate::haptics
