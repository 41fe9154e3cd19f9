// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Results are the same to the last bit for any number of threads, in a host whose locale writes
// commas and whose clock is elsewhere, whatever was in memory before, and wherever memory lies.
// There is no seed of hashes to vary: the libraries hash integers only, which are their own hashes.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <array>
#include <bit>
#include <clocale>
#include <cstdint>
#include <cstdlib>
#include <ctime>
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

/// Where blocks of memory lie.
enum class Blocks {
  usual,
  fresh,     ///< none where another was freed
  shifted,   ///< the same 48 bytes on, so that one of both is not where it usually is in a register
  own_pages  ///< large ones in pages of their own, the later at the lower address
};

struct Host {
  const char* name;
  int threads = 1;
  bool is_abroad = false;  ///< decimal commas, and another time zone
  int memory = 0;          ///< the byte with which fresh memory is filled
  Blocks blocks = Blocks::usual;
};

constexpr std::array kHosts = {Host{"2 threads, shifted memory", 2, false, 0, Blocks::shifted},
                               Host{"8 threads, fresh memory", 8, false, 0, Blocks::fresh},
                               Host{"commas, another time zone", 1, true},
                               Host{"perturbed memory", 1, false, 0xa5},
                               Host{"memory in other pages", 1, false, 0, Blocks::own_pages}};

/// Moves what is allocated from now on. The blocks are never freed: the process ends soon.
void move_blocks(Blocks blocks) {
  if (blocks == Blocks::usual) return;
  [[maybe_unused]] void* volatile block = nullptr;  // or the compiler omits the calls
  // Blocks that were freed before lie where they lay: use them up, the small ones by size.
  constexpr std::size_t kStep = 16, kHeader = 8, kLargest = 2048, kLeft = 1 << 14;
  constexpr int kOfEach = 16, kMost = 1 << 14;
  const auto is_free = [] {
    const auto info = mallinfo2();
    return info.fordblks > info.keepcost + kLeft;
  };
  for (std::size_t size = kStep; size <= kLargest; size += kStep)
    for (int i = 0; i < kOfEach; ++i) block = std::malloc(size);
  for (int i = 0; i < kMost && (i % kOfEach != 0 || is_free()); ++i)
    block = std::malloc(kLargest - kHeader);
  if (blocks == Blocks::own_pages) {
    constexpr int kPage = 4096;
    mallopt(M_MMAP_THRESHOLD, kPage);
    mallopt(M_TOP_PAD, 0);
    // What the end of the heap has room for does not get pages of its own.
    while (mallinfo2().keepcost >= kPage) block = std::malloc(kLargest - kHeader);
  }
  if (blocks == Blocks::shifted) block = std::malloc(2 * kLeft + 3 * kStep - kHeader);
}

/// Where a block of a vector of some thousand numbers lies in its page.
int place_in_page(Blocks blocks) {
  const std::vector<Outcome> outcomes = run_apart(1, [&](std::size_t) {
    move_blocks(blocks);
    void* volatile block = std::malloc(20'000);
    return std::to_string(std::bit_cast<std::uintptr_t>(block) % 4096);
  });
  return std::atoi(outcomes.front().text.c_str());
}

TEST(MovedBlocks, LieElsewhere) {
  if (is_sanitized()) GTEST_SKIP() << "sanitizers place blocks themselves";
  EXPECT_EQ((place_in_page(Blocks::shifted) - place_in_page(Blocks::fresh) + 4096) % 64, 48);
  EXPECT_EQ(place_in_page(Blocks::own_pages), 16);  // after its header
}

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
                     move_blocks(host.blocks);
                     if (host.is_abroad) {
                       setenv("TZ", "Asia/Kathmandu", 1);
                       tzset();
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
