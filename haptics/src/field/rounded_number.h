// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>

namespace palpate::haptics {

/// A number as computed, and a bound of how far the exact result is from it: running error analysis
/// (Higham 2002, sec. 3.3). Proofs take `lower` and `upper`, which hold whatever was rounded on
/// the way. A bound that cannot be given is infinite or NaN: nothing follows from it, so compare
/// with the claim itself (`lower() >= 0`), never with its negation.
struct RoundedNumber {
  double value = 0;
  double error = 0;  ///< |exact - value| <= error

  [[nodiscard]] double lower() const;
  [[nodiscard]] double upper() const;
};

namespace rounding {
/// One operation is off by at most half of this, relatively; bounds of errors are themselves sums
/// of a few terms, rounded. The inflation makes up for that, the smallest normal number for
/// underflow.
inline constexpr double kUnit = std::numeric_limits<double>::epsilon();
inline constexpr double kInflation = 1 + 4 * kUnit;
inline constexpr double kUnderflow = std::numeric_limits<double>::min();

/// The result of an operation whose arguments' errors alone put it off by `inherited`.
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
  const double divisor = std::abs(b.value) - b.error;  // exact one is not smaller but for rounding
  const double inherited = divisor > 0 ? (a.error + std::abs(quotient) * b.error) / divisor
                                       : std::numeric_limits<double>::infinity();
  return rounding::rounded(quotient, inherited * rounding::kInflation);
}
/// Of a number whose exact value is known not to be negative.
inline RoundedNumber sqrt(const RoundedNumber& a) {
  const double root = std::sqrt(a.value > 0 ? a.value : 0);
  // |sqrt(v) - sqrt(w)| = |v - w| / (sqrt(v) + sqrt(w)), and at most sqrt(|v - w|).
  const double inherited =
      std::fmin(a.error / root * rounding::kInflation, std::sqrt(a.error) * rounding::kInflation);
  return rounding::rounded(root, inherited);
}

}  // namespace palpate::haptics
