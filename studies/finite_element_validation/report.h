// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

#include "palpate/probing/contact_equilibrium.h"

// The table that the validation prints, line by line since it takes minutes.
namespace palpate::bench {

inline void print_title(const std::string& title) {
  std::printf("\n%s\n%-76s %12s %12s %9s\n", title.c_str(), "", "found", "exact", "error");
  std::fflush(stdout);
}

inline void print_line(const std::string& what, double found, double exact) {
  std::printf("%-76s %12.6g %12.6g %+7.2f %%\n", what.c_str(), found, exact,
              100 * (found / exact - 1));
  std::fflush(stdout);
}

// Something whose exact value is zero.
inline void print_line(const std::string& what, double found) {
  std::printf("%-76s %12.3g\n", what.c_str(), found);
  std::fflush(stdout);
}

inline std::string short_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// The state of a result; says so if it is not an equilibrium under the force that was asked for.
inline const probing::ContactState& converged(const probing::ContactResult& result) {
  if (result.stop != probing::ContactStop::converged)
    std::printf("no equilibrium: %s\n", to_string(result.stop));
  return result.state;
}

}  // namespace palpate::bench
