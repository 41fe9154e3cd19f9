// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/packed_image.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::geometry {
namespace {

/// Predicts a code from those before it, row by row.
class Prediction {
 public:
  explicit Prediction(const CodeImage& codes) : codes_(codes) {}

  [[nodiscard]] std::int32_t at(Eigen::Index row, Eigen::Index col) const {
    const std::int32_t left = col > 0 ? codes_(row, col - 1) : kUnknownCode;
    const std::int32_t above = row > 0 ? codes_(row - 1, col) : kUnknownCode;
    const std::int32_t corner = row > 0 && col > 0 ? codes_(row - 1, col - 1) : kUnknownCode;
    if (left == kUnknownCode) return above == kUnknownCode ? last_ : above;
    if (above == kUnknownCode || corner == kUnknownCode) return left;
    const auto [low, high] = std::minmax(left, above);
    return std::clamp(left + above - corner, low, high);  // the median of the three
  }
  void learn(std::int32_t code) { last_ = code; }

 private:
  const CodeImage& codes_;
  std::int32_t last_ = 0;
};

constexpr std::uint32_t folded(std::int32_t difference) {
  return difference >= 0 ? 1U + 2U * static_cast<std::uint32_t>(difference)
                         : 2U * static_cast<std::uint32_t>(-difference);
}

constexpr std::int32_t unfolded(std::uint32_t stored) {
  const auto half = static_cast<std::int32_t>(stored / 2);
  return stored % 2 == 1 ? half : -half;
}

}  // namespace

CodeImage codes_of(const Eigen::Ref<const ImageD>& values, double step) {
  require("codes_of(): the step", step, above(0).finite());
  CodeImage codes(values.rows(), values.cols());
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    for (Eigen::Index col = 0; col < values.cols(); ++col) {
      const double value = values(row, col), code = std::round(value / step);
      if (std::abs(code) >= kCodeLimit && std::isfinite(value)) {
        throw InvalidInput("codes_of(): the value " + std::to_string(value) + " is " +
                           std::to_string(std::abs(code)) + " steps from zero; fewer than " +
                           std::to_string(kCodeLimit) + " can be stored. Choose a larger step.");
      }
      codes(row, col) = std::isfinite(value) ? static_cast<std::int32_t>(code) : kUnknownCode;
    }
  }
  return codes;
}

double round_step(double most) {
  require("round_step(): the largest step", most, above(0).finite());
  const auto power = static_cast<int>(std::floor(std::log10(most)));
  // Powers of ten are exact as divisors only: 0.001 is 1 / 1000, rounded once.
  const auto times = [](double digit, int tens) {
    return tens < 0 ? digit / std::pow(10, -tens) : digit * std::pow(10, tens);
  };
  // The logarithm may be rounded up to a whole number; then a step of the power below is right.
  for (const int tens : {power, power - 1}) {
    for (const double digit : {5.0, 2.0, 1.0}) {
      if (times(digit, tens) <= most) return times(digit, tens);
    }
  }
  return most;  // denormal: no power of ten is below it
}

std::vector<std::byte> pack(const CodeImage& codes) {
  const auto count = static_cast<std::size_t>(codes.size());
  std::vector<std::byte> bytes(kPackedBytes * count);
  Prediction prediction(codes);
  std::size_t i = 0;
  for (Eigen::Index row = 0; row < codes.rows(); ++row) {
    for (Eigen::Index col = 0; col < codes.cols(); ++col, ++i) {
      const std::int32_t code = codes(row, col);
      if (code == kUnknownCode) continue;
      if (code <= -kCodeLimit || code >= kCodeLimit) {
        throw InvalidInput("pack(): the code " + std::to_string(code) + " is not below " +
                           std::to_string(kCodeLimit) + " in magnitude.");
      }
      const std::uint32_t stored = folded(code - prediction.at(row, col));
      for (std::size_t k = 0; k < kPackedBytes; ++k)
        bytes[k * count + i] = static_cast<std::byte>(stored >> (8 * k) & 255U);
      prediction.learn(code);
    }
  }
  return bytes;
}

CodeImage unpack(std::span<const std::byte> bytes, Eigen::Index rows, Eigen::Index cols) {
  if (rows < 0 || cols < 0)
    throw InvalidInput("unpack(): the size of the image is negative: " + std::to_string(rows) +
                       " x " + std::to_string(cols));
  const auto count = static_cast<std::size_t>(rows * cols);
  if (bytes.size() != kPackedBytes * count) {
    throw InvalidInput("unpack(): got " + std::to_string(bytes.size()) + " bytes; " +
                       std::to_string(count) + " codes have " +
                       std::to_string(kPackedBytes * count));
  }
  CodeImage codes(rows, cols);
  Prediction prediction(codes);
  std::size_t i = 0;
  for (Eigen::Index row = 0; row < rows; ++row) {
    for (Eigen::Index col = 0; col < cols; ++col, ++i) {
      std::uint32_t stored = 0;
      for (std::size_t k = 0; k < kPackedBytes; ++k)
        stored |= std::to_integer<std::uint32_t>(bytes[k * count + i]) << (8 * k);
      codes(row, col) = kUnknownCode;
      if (stored == 0) continue;
      const std::int32_t code = prediction.at(row, col) + unfolded(stored);
      if (code <= -kCodeLimit || code >= kCodeLimit) {
        throw InvalidInput("unpack(): the bytes of code " + std::to_string(i) +
                           " are damaged: they give " + std::to_string(code));
      }
      codes(row, col) = code;
      prediction.learn(code);
    }
  }
  return codes;
}

}  // namespace palpate::geometry
