// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <benchmark/benchmark.h>

#include <chrono>
#include <ctime>

namespace palpate::bench {

/// The processor time of all threads of this program.
struct ProcessorClock {
  using duration = std::chrono::duration<double>;
  using time_point = std::chrono::time_point<ProcessorClock, duration>;
  static time_point now() {
    return time_point(duration(static_cast<double>(std::clock()) / CLOCKS_PER_SEC));
  }
};

template <typename Clock = std::chrono::steady_clock>
double seconds(auto&& work) {
  const auto start = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Measures ours and a peer alternately, changing the order each time, and reports our time [ms],
/// the peer's time [ms] and their ratio (< 1: ours is faster).
template <typename Clock = std::chrono::steady_clock>
void run_paired(benchmark::State& state, auto&& ours, auto&& peer) {
  double ours_total = 0, peer_total = 0;
  bool ours_first = true;
  for (auto _ : state) {
    if (ours_first) ours_total += seconds<Clock>(ours);
    peer_total += seconds<Clock>(peer);
    if (!ours_first) ours_total += seconds<Clock>(ours);
    ours_first = !ours_first;
  }
  const auto runs = static_cast<double>(state.iterations());
  state.counters["ours_ms"] = 1e3 * ours_total / runs;
  state.counters["peer_ms"] = 1e3 * peer_total / runs;
  state.counters["ours/peer"] = ours_total / peer_total;
}

}  // namespace palpate::bench
