// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Prints the figures of docs/probing-validation.md on touches, slips, forces and faults, which need
// more trials than tests have time for. Without arguments all; otherwise those that are named.
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "validation.h"

int main(int argc, char** argv) {
  using namespace palpate::bench;
  const std::array<std::pair<const char*, void (*)()>, 4> parts{{
      {"touches", [] { validate_touches(1250); }},
      {"slips", [] { validate_slips(100000); }},
      {"forces", validate_forces},
      {"faults", [] { validate_faults(100); }},
  }};
  const std::vector<std::string> wanted(argv + 1, argv + argc);
  for (const std::string& name : wanted) {
    if (std::none_of(parts.begin(), parts.end(), [&](const auto& p) { return name == p.first; })) {
      std::fprintf(stderr, "'%s' is unknown; there are touches, slips, forces, faults\n",
                   name.c_str());
      return 2;
    }
  }
  try {
    for (const auto& [name, run] : parts) {
      if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), name) == wanted.end())
        continue;
      run();
      std::fflush(stdout);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
