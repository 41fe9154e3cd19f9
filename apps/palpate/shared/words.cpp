// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>

namespace palpate::apps {

const char* in_words(haptics::FitStop stop) {
  switch (stop) {
    case haptics::FitStop::accurate:
      return "as accurate as asked for";
    case haptics::FitStop::explained:
      return "noise explains the errors";
    case haptics::FitStop::unexplained:
      return "noise does not explain the errors";
    case haptics::FitStop::rigid:
      return "practically rigid";
    case haptics::FitStop::max_bases:
      return "more bases are not allowed, or the samples do not determine them";
    case haptics::FitStop::no_gain:
      return "more bases would not fit better";
    case haptics::FitStop::not_converged:
      return "the solver did not converge with more bases";
    case haptics::FitStop::not_determined:
      return "forces without any displacement, so that nothing elastic shows";
  }
  return "";
}

const char* in_words(haptics::FrictionStop stop) {
  switch (stop) {
    case haptics::FrictionStop::converged:
      return "determined";
    case haptics::FrictionStop::too_few_directions:
      return "too few directions of tangential forces, or all on one side";
    case haptics::FrictionStop::too_few_levels:
      return "too few levels of the normal force";
    case haptics::FrictionStop::never_slipped:
      return "no sample slipped";
    case haptics::FrictionStop::frictionless:
      return "too slippery: what held is within the noise";
    case haptics::FrictionStop::not_converged:
      return "no friction cone agrees with the samples";
  }
  return "";
}

const char* in_words(haptics::RegistrationOutcome outcome) {
  switch (outcome) {
    case haptics::RegistrationOutcome::not_needed:
      return "they were left where they are";
    case haptics::RegistrationOutcome::accepted:
      return "they were moved onto it, all together";
    case haptics::RegistrationOutcome::too_far:
      return "they were left there, as moving them onto it would move them too far";
    case haptics::RegistrationOutcome::not_converged:
      return "they were left there, as no motion onto it was found";
  }
  return "";
}

const char* in_words(haptics::Passivity passivity) {
  switch (passivity) {
    case haptics::Passivity::convex:
      return "passive everywhere";
    case haptics::Passivity::certified:
      return "proven passive within reach";
    case haptics::Passivity::violated:
      return "not passive";
    case haptics::Passivity::undecided:
      return "not proven passive";
  }
  return "";
}

std::string newtons(double force, int decimals) {
  constexpr int kDigits = 3;
  // A force below this would show fewer digits.
  const double least = std::pow(10.0, kDigits - 1 - decimals);
  return std::abs(force) >= least ? fmt::format("{:.{}f} N", force, decimals)
                                  : fmt::format("{:.{}g} N", force, kDigits);
}

std::string megabytes(std::uintmax_t bytes) {
  constexpr double kMegabyte = 1e6;  // bytes
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) / kMegabyte);
}

std::string worst_lines(const std::vector<std::string>& lines, const std::vector<double>& errors) {
  constexpr std::size_t kPrinted = 3;
  if (lines.size() <= kPrinted || spdlog::should_log(spdlog::level::info))
    return fmt::format("{}", fmt::join(lines, ""));
  std::vector<std::size_t> order(lines.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) { return errors[i]; });
  std::string worst = fmt::format("The {} worst of {} (-v prints all):\n", kPrinted, lines.size());
  for (std::size_t i = 0; i < kPrinted; ++i) worst += lines[order[i]];
  return worst;
}

}  // namespace palpate::apps
