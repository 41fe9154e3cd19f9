// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/haptics/build_model.h"

namespace palpate::apps {

// Text of the prose output for the codes in JSON.

/// "noise explains the errors", ...
[[nodiscard]] const char* in_words(haptics::FitStop stop);
/// The reason why friction is not determined: "no sample slipped", ...
[[nodiscard]] const char* in_words(haptics::FrictionStop stop);
/// "they already lie on the surface", ...
[[nodiscard]] const char* in_words(haptics::RegistrationOutcome outcome);
/// "passive everywhere", ...
[[nodiscard]] const char* in_words(haptics::Passivity passivity);

/// "1 mesh", "3 meshes". `many` is the plural if it is not `one` and an s.
template <std::integral Count>
[[nodiscard]] std::string counted(Count count, const std::string& one,
                                  const std::string& many = {}) {
  return std::to_string(count) + " " + (count == 1 ? one : many.empty() ? one + "s" : many);
}

/// "0.0344 N"; of a force below 0.01 N three significant digits, "0.000344 N". With other decimal
/// places, three digits as well below what these show.
[[nodiscard]] std::string newtons(double force, int decimals = 4);

/// "1.5 MB", of 10^6 bytes each.
[[nodiscard]] std::string megabytes(std::uintmax_t bytes);

/// The lines of a list that are printed: those with the largest errors, the largest first, and
/// their number of all; with -v, all in their order.
[[nodiscard]] std::string worst_lines(const std::vector<std::string>& lines,
                                      const std::vector<double>& errors);

}  // namespace palpate::apps
