// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "findings.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>

namespace palpate::extremes {
namespace {

constexpr std::string_view kExact = "exact", kRounding = "rounding ", kFinite = "finite",
                           kSaid = "said", kWrong = "wrong ";
/// A message with more digits in a row than this is not for people.
constexpr int kMostDigits = 25;

/// The reason why a message of a refusal is of no use; empty if it is.
std::string complaint(const std::string& message) {
  constexpr std::size_t kShortest = 15;
  if (message.size() < kShortest) return "says too little: " + message;
  int digits = 0;
  for (const char c : message) {
    digits = std::isdigit(static_cast<unsigned char>(c)) != 0 ? digits + 1 : 0;
    if (digits > kMostDigits) return "prints a number without end: " + message;
  }
  return {};
}

const KnownDeviation* known(std::string_view operation, std::string_view theme,
                            std::string_view name) {
  for (const KnownDeviation& one : known_deviations())
    if (one.operation == operation && one.theme == theme && name.starts_with(one.cases))
      return &one;
  return nullptr;
}

/// For the table: the worst of all cases.
std::string summary(std::string_view operation, std::string_view theme,
                    const std::vector<Finding>& findings) {
  double difference = 0;
  std::size_t refused = 0, exact = 0, finite = 0, said = 0;
  for (const Finding& finding : findings) {
    if (finding.verdict == Verdict::wrong) {
      const KnownDeviation* const deviation = known(operation, theme, finding.name);
      return deviation == nullptr ? "wrong" : fmt::format("known: {}", deviation->reason);
    }
    if (!finding.shown.empty()) return finding.shown;
    difference = std::max(difference, finding.difference);
    said += finding.verdict == Verdict::said ? 1 : 0;
    refused += finding.verdict == Verdict::refused ? 1 : 0;
    exact += finding.verdict == Verdict::exact ? 1 : 0;
    finite += finding.verdict == Verdict::finite ? 1 : 0;
  }
  if (refused == findings.size()) return "refused";
  if (said == findings.size()) return "said";
  std::string text = finite > 0                           ? "finite"
                     : exact + refused == findings.size() ? "exact"
                                                          : fmt::format("{:.0e}", difference);
  if (said > 0) text += fmt::format(", {} of {} said", said, findings.size());
  if (refused > 0) text += fmt::format(", {} of {} refused", refused, findings.size());
  return text;
}

}  // namespace

std::string report_of(const Agreement& agreement, bool must_be_exact) {
  if (agreement.exact) return std::string(kExact);
  if (must_be_exact || agreement.over_allowed > 1) {
    return fmt::format("{}{}: off by {:.3g}, which is {:.3g} of what is allowed", kWrong,
                       agreement.worst, agreement.difference, agreement.over_allowed);
  }
  return report_of_difference(agreement.difference);
}

std::string report_of_said() { return std::string(kSaid); }

std::string report_of_difference(double difference) {
  return fmt::format("{}{}", kRounding, difference);
}

std::string report_of_finite(const Results& results) {
  const std::string bad = not_finite(results);
  return bad.empty() ? std::string(kFinite) : report_of_wrong(bad);
}

std::string report_of_wrong(std::string_view what) { return fmt::format("{}{}", kWrong, what); }

Finding finding_of(std::string name, const Outcome& outcome) {
  Finding finding{.name = std::move(name), .text = outcome.text};
  const std::string& text = outcome.text;
  if (outcome.end == End::refused) {
    finding.text = complaint(text);
    finding.verdict = finding.text.empty() ? Verdict::refused : Verdict::wrong;
  } else if (outcome.end != End::finished) {
    finding.verdict = Verdict::wrong;
    finding.text = fmt::format("{}: {}", to_string(outcome.end), text);
  } else if (text == kExact) {
    finding.verdict = Verdict::exact;
  } else if (text == kFinite) {
    finding.verdict = Verdict::finite;
  } else if (text == kSaid) {
    finding.verdict = Verdict::said;
  } else if (text.starts_with(kRounding)) {
    finding.verdict = Verdict::within_rounding;
    finding.difference = std::strtod(text.c_str() + kRounding.size(), nullptr);
  } else {
    finding.verdict = Verdict::wrong;
  }
  return finding;
}

bool is_known(std::string_view operation, std::string_view theme, std::string_view name) {
  return known(operation, theme, name) != nullptr;
}

void judge(const Operation& operation, std::string_view theme,
           const std::vector<Finding>& findings) {
  std::vector<const KnownDeviation*> met;
  for (const Finding& finding : findings) {
    const KnownDeviation* const deviation = known(operation.name, theme, finding.name);
    if (finding.verdict != Verdict::wrong) continue;
    if (deviation == nullptr)
      ADD_FAILURE() << operation.name << ", " << finding.name << ": " << finding.text;
    else
      met.push_back(deviation);
  }
  for (const KnownDeviation& one : known_deviations()) {
    if (one.operation != operation.name || one.theme != theme) continue;
    if ((one.only_large && !is_large()) || is_sanitized()) continue;
    if (std::find(met.begin(), met.end(), &one) == met.end()) {
      ADD_FAILURE() << operation.name << ", " << one.cases << ": is right now; remove it from the "
                    << "known deviations (" << one.reason << ")";
    }
  }
  const char* const table = std::getenv("PALPATE_EXTREMES_TABLE");
  if (table == nullptr || findings.empty()) return;
  std::ofstream(table, std::ios::app) << operation.name << '\t' << theme << '\t'
                                      << summary(operation.name, theme, findings) << '\n';
}

std::string test_name(const Operation& operation) {
  std::string name;
  for (const char c : operation.name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
  return name;
}

const std::vector<KnownDeviation>& known_deviations() {
  constexpr std::string_view kPrior =
      "what is assumed of the curvature of displacements is in newton (0.6 N, length scales 1 and "
      "3 "
      "N^1/2)";
  constexpr std::string_view kCertified =
      "certified fits take seconds of processor time for each contact";
  constexpr std::string_view kReduced =
      "another selection of contacts and bases, with up to 2.5 times the largest difference; why "
      "is "
      "not known yet";
  constexpr std::string_view kNoEnd =
      "edges are split as often as the caller asks, until memory or an int's range is exhausted";
  constexpr std::string_view kVertexOrder =
      "the triangulation of contacts removes vertices in an order that depends on their numbers";
  constexpr std::string_view kEquals =
      "of places that are equally far, and of diagonals between four contacts on a circle, "
      "rounding "
      "chooses";
  static const std::vector<KnownDeviation> known = {
      {"farthest_points", "conditioning", "sheet nearly flat", kEquals},
      {"triangulate_contacts: delaunay", "conditioning", "sheet nearly flat", kEquals},
      {"BlendedField", "conditioning", "sheet nearly flat", kEquals},
      {"triangulate_contacts: delaunay", "orders", "", kVertexOrder},
      {"BlendedField", "orders", "", kVertexOrder},
      {"Playback", "orders", "order 1", kVertexOrder},
      {"C interface", "orders", "order 1", kVertexOrder},
      {"poisson_sample", "turns", "",
       "points are chosen by where they are along the axes, as its documentation says"},
      {"ForceSurrogate", "forces 2^30", "", kPrior},
      {"ForceSurrogate", "2^100", "length 2^0", kPrior},
      {"split_edges", "degenerate", "sheet: sizes from 1e-6 to 1e6", kNoEnd},
      {"split_edges", "degenerate", "sheet: coordinates of 1e300", kNoEnd},
      {"build_model", "options", "BuildOptions::passive = 1", kCertified, true},
      {"build_model", "options", "BuildOptions::compare_always = 1", kCertified, true},
      {"reduce_model", "forces 2^30", "length 2^0, force 2^-30", kReduced, true},
      {"reduce_model", "2^100", "length 2^0, force 2^-100", kReduced, true},
      {"reduce_model", "places", "", kReduced, true},
      {"simulate", "2^100", "",
       "light 1e60 times as weak or strong as at 1 m exceeds the single precision of its sums"},
  };
  return known;
}

}  // namespace palpate::extremes
