// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>

namespace palpate::haptics {

/// A computed number with a bound of its distance from the exact result: running error analysis
/// (Higham 2002, sec. 3.3). Proofs use `lower` and `upper`, which hold for any rounding. An unknown
/// bound is infinite or NaN and implies nothing, so always test the claim itself (`lower() >= 0`),
/// never its negation.
struct RoundedNumber {
  double value = 0;
  double error = 0;  ///< |exact - value| <= error

  [[nodiscard]] double lower() const;
  [[nodiscard]] double upper() const;
};

namespace rounding {
/// The relative error of one operation is at most half of this. Error bounds are themselves rounded
/// sums of a few terms; the inflation covers that, and the smallest normal number covers underflow.
inline constexpr double kUnit = std::numeric_limits<double>::epsilon();
inline constexpr double kInflation = 1 + 4 * kUnit;
inline constexpr double kUnderflow = std::numeric_limits<double>::min();

/// The result of an operation to which the arguments' errors contribute `inherited`.
inline RoundedNumber rounded(double value, double inherited) {
  return {value, (inherited + kUnit * std::abs(value) + kUnderflow) * kInflation};
}
}  // namespace rounding

inline double RoundedNumber::lower() const {
  return value - error - 2 * rounding::kUnit * (std::abs(value) + error);
}
inline double RoundedNumber::upper() const {
  return value + error + 2 * rounding::kUnit * (std::abs(value) + error);
}

inline RoundedNumber operator-(const RoundedNumber& a) { return {-a.value, a.error}; }
inline RoundedNumber operator+(const RoundedNumber& a, const RoundedNumber& b) {
  return rounding::rounded(a.value + b.value, a.error + b.error);
}
inline RoundedNumber operator-(const RoundedNumber& a, const RoundedNumber& b) {
  return rounding::rounded(a.value - b.value, a.error + b.error);
}
inline RoundedNumber operator*(const RoundedNumber& a, const RoundedNumber& b) {
  return rounding::rounded(a.value * b.value, std::abs(a.value) * b.error +
                                                  std::abs(b.value) * a.error + a.error * b.error);
}
inline RoundedNumber operator/(const RoundedNumber& a, const RoundedNumber& b) {
  const double quotient = a.value / b.value;
  const double divisor =
      std::abs(b.value) - b.error;  // lower bound of the exact divisor, up to rounding
  const double inherited = divisor > 0 ? (a.error + std::abs(quotient) * b.error) / divisor
                                       : std::numeric_limits<double>::infinity();
  return rounding::rounded(quotient, inherited * rounding::kInflation);
}
/// Square root of a number whose exact value is known to be >= 0.
inline RoundedNumber sqrt(const RoundedNumber& a) {
  const double root = std::sqrt(a.value > 0 ? a.value : 0);
  // |sqrt(v) - sqrt(w)| = |v - w| / (sqrt(v) + sqrt(w)), and at most sqrt(|v - w|).
  const double inherited =
      std::fmin(a.error / root * rounding::kInflation, std::sqrt(a.error) * rounding::kInflation);
  return rounding::rounded(root, inherited);
}

}  // namespace palpate::haptics
