// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Compares finite elements with closed forms and with another program, on larger meshes than tests
// have time for, and counts how random paths end. Prints the figures of docs/probing-validation.md.
#include "validation.h"

#include <cstdio>
#include <exception>
#include <map>
#include <string>

int main(int count, char** arguments) {
  using namespace palpate::bench;
  const std::map<std::string, void (*)()> parts{{"calculix", compare_with_calculix},
                                                {"half-space-model", compare_with_half_space_model},
                                                {"halved-mesh", compare_with_halved_mesh},
                                                {"hertz", compare_with_hertz},
                                                {"loops", measure_sticking_loops},
                                                {"mindlin", compare_with_mindlin},
                                                {"paths", count_random_paths},
                                                {"slides", measure_slides}};
  for (int i = 1; i < count; ++i) {
    if (parts.contains(arguments[i])) continue;
    std::fprintf(stderr, "usage: finite_element_validation [PART...]; all parts, or some of");
    for (const auto& [name, part] : parts) std::fprintf(stderr, " %s", name.c_str());
    std::fprintf(stderr, "\n'%s' is none of them\n", arguments[i]);
    return 2;
  }
  try {
    if (count == 1)
      for (const auto& [name, part] : parts) part();
    for (int i = 1; i < count; ++i) parts.at(arguments[i])();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
  return 0;
}
