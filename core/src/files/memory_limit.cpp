// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/memory_limit.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "palpate/core/error.h"

namespace palpate {
namespace {

constexpr double kMegabyte = 1e6;
constexpr double kGigabyte = 1e9;

/// The limit that the user sets [bytes]; 0 if the variable is not set.
double allowed_by_user() {
  const char* const value = std::getenv(kMemoryVariable);
  if (value == nullptr) return 0;
  const std::string_view text = value;
  double gigabytes = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), gigabytes);
  if (error != std::errc() || end != text.data() + text.size() || !(gigabytes > 0)) {
    throw InvalidInput("environment variable " + std::string(kMemoryVariable) + ": is \"" +
                       std::string(text) + "\"; it must be a number above 0, in GB");
  }
  return kGigabyte * gigabytes;
}

}  // namespace

std::optional<std::string> beyond_memory_limit(double needed, double file_size) {
  const double usual = kMemoryOfFile * file_size + kMemoryAllowance;
  if (needed <= usual) return std::nullopt;
  const double most = std::max(usual, allowed_by_user());
  if (needed <= most) return std::nullopt;
  return "its content is so compressed that reading it takes " +
         std::to_string(std::llround(needed / kMegabyte)) + " MB; the limit is " +
         std::to_string(std::llround(most / kMegabyte)) +
         " MB, 64 times the file and 512 MB more. Write it without compression, or set the "
         "environment variable " +
         kMemoryVariable + " to " + std::to_string(std::llround(std::ceil(needed / kGigabyte))) +
         " if it is right";
}

}  // namespace palpate
