// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Memory and time grow with the size of the input as stated. Bytes are asserted always; processor
// times only where nothing else runs: in the large size, and for the page of docs.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>

#include "findings.h"
#include "growth.h"

namespace palpate::extremes {
namespace {

/// [bytes] The most memory that this process had (VmHWM), or what it has (VmRSS).
double memory(std::string_view of) {
  std::ifstream file("/proc/self/status");
  for (std::string word; file >> word;) {
    if (word != of) continue;
    double kilobytes = 0;
    file >> kilobytes;
    return 1024 * kilobytes;
  }
  return 0;
}

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// What a call of an operation takes.
struct Cost {
  double bytes = 0;    ///< at most, beside the input
  double seconds = 0;  ///< [s] of processor time: the least of some calls
};

/// Returns true if times are asserted, too.
bool is_timed() { return is_large() || std::getenv("PALPATE_EXTREMES_TABLE") != nullptr; }

/// [s] of processor time of a call: the mean of as many calls as the clock needs, and the least of
/// some such means.
double least_seconds(const std::function<void()>& call) {
  constexpr double kEnough = 0.15;  // [s] beside which a tick of the clock of 4 ms is little
  constexpr int kMeans = 3;
  double least = std::numeric_limits<double>::infinity();
  for (int mean = 0; mean < kMeans; ++mean) {
    const double begin = processor_seconds();
    double passed = 0;
    int calls = 0;
    for (; passed < kEnough; passed = processor_seconds() - begin, ++calls) call();
    least = std::min(least, passed / calls);
  }
  return least;
}

/// The cost for an input, measured in a process of its own: two numbers, or why there are none.
Outcome cost_of(const Operation& operation, const Input& input) {
  malloc_trim(0);  // or the process works in memory that this one has freed, which is not seen
  return run_apart(1,
                   [&](std::size_t) {
                     prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0);  // pages of 2 MB would be counted
                     const auto call = [&] {
                       static_cast<void>(operation.run(input, no_change()));
                     };
                     const double before = memory("VmRSS:");
                     call();
                     const double bytes = memory("VmHWM:") - before;
                     return fmt::format("{} {}", bytes, is_timed() ? least_seconds(call) : 0);
                   },
                   {.seconds = 60})
      .front();
}

Cost cost_from(const Outcome& outcome) {
  Cost cost;
  std::istringstream(outcome.text) >> cost.bytes >> cost.seconds;
  return cost;
}

/// Two digits, without an exponent.
std::string kilobytes(double bytes) {
  const double rounded = std::strtod(fmt::format("{:.1e}", std::max(bytes, 0.0)).c_str(), nullptr);
  return fmt::format("{}", rounded / 1000);
}

/// Compares what was measured with what is stated.
Finding finding_of(const Growth& stated, const Cost& small, const Cost& large) {
  const double from = elements_of(stated.element, stated.from);
  const double to = elements_of(stated.element, stated.to);
  const double bytes = (large.bytes - small.bytes) / (to - from);
  const double exponent = std::log(large.seconds / small.seconds) / std::log(to / from);
  Finding finding{.name = "cost", .verdict = Verdict::within_rounding};
  finding.shown = fmt::format("{} | {:.0f} to {:.0f} | {:.1f} | {:.1f} | {} | {}",
                              stated.element.name, from, to, std::max(exponent, 0.0),
                              stated.exponent, kilobytes(bytes), kilobytes(stated.bytes));
  if (bytes > stated.bytes)
    finding.text = fmt::format("takes {:.0f} bytes for each further {}, more than the stated {}",
                               bytes, stated.element.name, stated.bytes);
  if (is_timed() && exponent > stated.exponent)
    finding.text += fmt::format("processor time grows with the power {:.2f}, more than {}",
                                exponent, stated.exponent);
  if (!finding.text.empty()) finding.verdict = Verdict::wrong;
  return finding;
}

class StatedGrowth : public ::testing::TestWithParam<Growth> {};

TEST_P(StatedGrowth, IsNotExceeded) {
  if (is_sanitized()) GTEST_SKIP() << "sanitizers take memory of their own";
  const Growth& stated = GetParam();
  const auto operation =
      std::find_if(all_operations().begin(), all_operations().end(),
                   [&](const Operation& one) { return one.name == stated.operation; });
  ASSERT_NE(operation, all_operations().end());
  if ((operation->only_large || stated.only_large) && !is_timed()) GTEST_SKIP() << "takes long";
  const Outcome small = cost_of(*operation, wide_input(stated.from));
  const Outcome large = cost_of(*operation, wide_input(stated.to));
  for (const Outcome& outcome : {small, large})
    ASSERT_EQ(outcome.end, End::finished) << outcome.text;
  judge(*operation, "growth", {finding_of(stated, cost_from(small), cost_from(large))});
}

INSTANTIATE_TEST_SUITE_P(All, StatedGrowth, ::testing::ValuesIn(stated_growth()),
                         [](const auto& one) {
                           return test_name({.name = std::string(one.param.operation)});
                         });

TEST(StatedGrowths, AreOfAllOperationsThatCanHaveMoreToDo) {
  // The work of these does not depend on the size of the input, and the strip is a model of one
  // narrow sheet.
  std::set<std::string_view> missing = {"design_pattern", "certify_passivity", "identify_strip"};
  for (const Growth& stated : stated_growth())
    EXPECT_TRUE(missing.insert(stated.operation).second) << stated.operation;
  for (const Operation& operation : all_operations())
    EXPECT_EQ(missing.erase(operation.name), 1U) << operation.name;
  EXPECT_TRUE(missing.empty());
}

TEST(WideInput, HasAsManyMoreElementsAsItIsLarger) {
  const Input &input = standard_input(), &wide = wide_input(2);
  EXPECT_EQ(wide_input(1).sheet.vertices, input.sheet.vertices);
  EXPECT_EQ(wide.ball.triangles.cols(), 4 * input.ball.triangles.cols());
  EXPECT_EQ(wide.sheet.triangles.cols() + 4, 4 * (input.sheet.triangles.cols() + 4));  // a hole
  EXPECT_EQ(wide.contacts.size(), 4 * input.contacts.size());
  EXPECT_EQ(wide.acquisition.samples.size(), 4 * input.acquisition.samples.size());
  EXPECT_EQ(wide.trials.size(), 4 * input.trials.size());
  EXPECT_EQ(wide.frame.total(), 4 * input.frame.total());
}

}  // namespace
}  // namespace palpate::extremes
