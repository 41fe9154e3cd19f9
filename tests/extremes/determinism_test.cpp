// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Results are the same to the last bit for any number of threads, in a host whose locale writes
// commas, and whatever was in memory before.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <array>
#include <bit>
#include <clocale>
#include <cstdint>
#include <locale>
#include <sstream>

#include "findings.h"

namespace palpate::extremes {
namespace {

/// Writes 1,5 and 1.000.
struct Commas : std::numpunct<char> {
  [[nodiscard]] char do_decimal_point() const override { return ','; }
  [[nodiscard]] char do_thousands_sep() const override { return '.'; }
  [[nodiscard]] std::string do_grouping() const override { return "\3"; }
};

struct Host {
  const char* name;
  int threads = 1;
  bool has_commas = false;
  int memory = 0;  ///< the byte with which fresh memory is filled
};

constexpr std::array kHosts = {Host{"4 threads", 4}, Host{"commas", 1, true},
                               Host{"perturbed memory", 1, false, 0xa5}};

/// A line with the name and a hash (FNV-1a) of the bits of each result.
std::string fingerprint(const Results& results) {
  std::string text;
  for (const Result& result : results) {
    std::uint64_t hash = 0xcbf29ce484222325;
    for (const double value : result.values.reshaped()) {
      auto bits = std::isnan(value) ? ~std::uint64_t{0} : std::bit_cast<std::uint64_t>(value);
      for (int byte = 0; byte < 8; ++byte, bits >>= 8U)
        hash = (hash ^ (bits & 0xffU)) * 0x100000001b3;
    }
    text += fmt::format("{:016x} {} {}\n", hash, result.values.size(), result.name);
  }
  return text;
}

Outcome outcome_in(const Host& host, const Operation& operation) {
  return run_apart(1,
                   [&](std::size_t) {
                     if (host.has_commas) {
                       std::locale::global(std::locale(std::locale::classic(), new Commas));
                       static_cast<void>(std::setlocale(LC_ALL, "de_DE.UTF-8"));
                     }
                     if (host.memory != 0) mallopt(M_PERTURB, host.memory);
                     return fingerprint(operation.run(standard_input(), no_change()));
                   },
                   {.seconds = 4 * operation.seconds, .threads = host.threads})
      .front();
}

class Determinism : public ::testing::TestWithParam<Operation> {};

TEST_P(Determinism, ResultsAreTheSameInAnyHost) {
  const Operation& operation = GetParam();
  const Outcome alone = outcome_in({"one thread"}, operation);
  std::vector<Finding> findings;
  for (const Host& host : kHosts) {
    const Outcome outcome = outcome_in(host, operation);
    Finding finding{.name = host.name};
    if (outcome.end != alone.end || outcome.text != alone.text) {
      finding.verdict = Verdict::wrong;
      finding.text = fmt::format("\n{}instead of\n{}", outcome.text, alone.text);
    }
    findings.push_back(finding);
  }
  judge(operation, "hosts", findings);
}

INSTANTIATE_TEST_SUITE_P(All, Determinism, ::testing::ValuesIn(operations()),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace palpate::extremes
