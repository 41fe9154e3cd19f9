// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <string>

#include "arm/faulty_arm.h"
#include "validation.h"

namespace palpate::bench {

void validate_faults(unsigned seeds) {
  using probing::support::FaultOutcome;
  std::printf("Faults, %u seeds each\n%-28s %12s %8s %8s %8s %8s\n", seeds, "found as",
              "ticks, most", "named", "safe", "stays", "resumed");
  for (const auto& [fault, name] : probing::support::kInjectedFaults) {
    int ticks = 0;
    unsigned named = 0, safe = 0, stays = 0, resumed = 0;
    for (unsigned seed = 1; seed <= seeds; ++seed) {
      const FaultOutcome outcome = probing::support::outcome_of_fault(fault, seed);
      ticks = std::max(ticks, outcome.ticks);
      named += outcome.found == name && outcome.before == devices::DeviceFault::none ? 1 : 0;
      safe += outcome.is_safe ? 1 : 0;
      stays += outcome.stays ? 1 : 0;
      resumed += outcome.resumed ? 1 : 0;
    }
    std::printf("%-28s %12d %8u %8u %8u %8u\n", std::string(to_string(name)).c_str(), ticks, named,
                safe, stays, resumed);
    std::fflush(stdout);
  }
  std::printf("\n");
}

}  // namespace palpate::bench
