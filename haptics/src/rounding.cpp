// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/rounding.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace palpate::haptics {
namespace {

constexpr int kAxisPlaces = 10;  // F^T F is then off by at most 2e-10
constexpr int kFrictionDigits = 6;
constexpr int kReportDigits = 4;  // of errors and other figures that nothing is computed from

// The decimal that `std::to_chars` writes is the nearest, and reading it gives the double that a
// file's reader will get: neither is true of multiplying by powers of ten.
double through_text(double value, std::chars_format format, int precision) {
  constexpr std::size_t kLongest = 512;  // the greatest double with some decimal places takes 330
  std::array<char, kLongest> text;
  const auto written =
      std::to_chars(text.data(), text.data() + text.size(), value, format, precision);
  double result = value;
  std::from_chars(text.data(), written.ptr, result);
  return result;
}

Multiquadric rounded(const Multiquadric& base) {
  Multiquadric result;
  result.weight = round_to_digits(base.weight, kFieldDigits);
  result.epsilon = round_to_digits(base.epsilon, kFieldDigits);
  for (int i = 0; i < 3; ++i) result.ridge[i] = round_to_places(base.ridge[i], kFieldDigits);
  if (result.ridge.isZero(0)) {
    for (int i = 0; i < 3; ++i) result.center[i] = round_to_digits(base.center[i], kFieldDigits);
    return result;
  }
  int axis = 0;
  result.ridge.cwiseAbs().maxCoeff(&axis);
  result.center[axis] =
      round_to_digits(base.ridge.dot(base.center) / result.ridge[axis], kFieldDigits);
  return result;
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
  for (Multiquadric& base : field.bases) base = rounded(base);
  return field;
}

ContactModel rounded(ContactModel contact) {
  for (double& entry : contact.frame.reshaped()) entry = round_to_places(entry, kAxisPlaces);
  for (double& entry : contact.friction_axis) entry = round_to_places(entry, kAxisPlaces);
  contact.field = rounded(std::move(contact.field));
  contact.friction = round_to_digits(contact.friction, kFrictionDigits);
  for (double* figure : {&contact.friction_error, &contact.friction_lower_bound, &contact.rms,
                         &contact.chi2, &contact.noise_floor, &contact.condition}) {
    *figure = round_to_digits(*figure, kReportDigits);
  }
  return contact;
}

}  // namespace palpate::haptics
