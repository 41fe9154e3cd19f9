// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace palpate::probing {

// A hash of one record. Each number is mixed in whole by the finalizer of splitmix64 (Steele, Lea
// and Flood 2014), in which every bit changes about half of the others.
class RecordHash {
 public:
  explicit RecordHash(std::uint64_t kind) { add(kind); }

  void add(std::uint64_t value) {
    state_ += value + 0x9e3779b97f4a7c15ULL;
    state_ = (state_ ^ (state_ >> 30)) * 0xbf58476d1ce4e5b9ULL;
    state_ = (state_ ^ (state_ >> 27)) * 0x94d049bb133111ebULL;
    state_ ^= state_ >> 31;
  }
  void add(long long value) { add(static_cast<std::uint64_t>(value)); }
  void add(const Eigen::Vector3d& vector) {
    // 0 and -0 are one number.
    for (const double number : vector) add(std::bit_cast<std::uint64_t>(number + 0.0));
  }
  void add(std::string_view text) {
    add(static_cast<std::uint64_t>(text.size()));
    for (const char c : text) add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }
  /// In (0, 1).
  [[nodiscard]] double uniform() const {
    return (static_cast<double>(state_ >> 11) + 0.5) * 0x1p-53;
  }
  /// Sixteen hexadecimal digits.
  [[nodiscard]] std::string digits() const { return to_digits(state_); }

  [[nodiscard]] static std::string to_digits(std::uint64_t value) {
    std::string digits(17, '\0');
    std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(value));
    digits.pop_back();
    return digits;
  }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace palpate::probing
