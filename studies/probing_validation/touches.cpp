// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "detect/touch_figures.h"
#include "validation.h"

namespace palpate::bench {

void validate_touches(int runs) {
  using probing::support::TouchFigures;
  std::printf(
      "Touches, %d approaches each: wrong (false, missed, no estimate); place of the estimate and\n"
      "highest force. Thesis' rule on the same objects, pushed with a constant 0.2 N\n",
      runs);
  std::printf("%9s | %5s %9s %9s %9s | %5s %9s %9s %9s\n", "k [N/mm]", "wrong", "bias [mm]",
              "sd [mm]", "p99 [N]", "wrong", "bias [mm]", "sd [mm]", "p99 [N]");
  int wrong = 0, approaches = 0;
  for (const double stiffness : {0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0}) {
    const TouchFigures f = probing::support::touch_figures(stiffness, runs);
    const TouchFigures thesis = probing::support::touch_figures_of_thesis(stiffness, runs);
    wrong += f.wrong;
    approaches += runs;
    std::printf("%9.2f | %5d %9.3f %9.3f %9.2f | %5d %9.3f %9.3f %9.2f\n", stiffness, f.wrong,
                f.bias, f.deviation, f.force, thesis.wrong, thesis.bias, thesis.deviation,
                thesis.force);
    std::fflush(stdout);
  }
  int alarms = 0;
  const int free = approaches / 4;
  for (int seed = 1; seed <= free; ++seed) {
    probing::support::Approach approach =
        probing::support::random_approach(0, static_cast<unsigned>(seed));
    approach.free_path = 6;
    alarms += probing::support::approach_until_touch(approach, 2).touched ? 1 : 0;
  }
  std::printf("wrong: %d of %d; alarms in free space: %d of %d\n\n", wrong, approaches, alarms,
              free);
}

}  // namespace palpate::bench
