// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Measures on specimens how wrong a model is that was measured with one tool, where several tools
// touch the object or one of another size. Prints the tables of docs/trade-playback.md.
#include <cstdio>
#include <exception>
#include <map>
#include <string>

#include "trade.h"

int main(int count, char** arguments) {
  using namespace palpate::bench;
  const std::map<std::string, void (*)()> parts{{"near-tools", measure_near_tools},
                                                {"tool-radius", measure_tool_radius}};
  for (int i = 1; i < count; ++i) {
    if (parts.contains(arguments[i])) continue;
    std::fprintf(stderr, "usage: playback_trade [near-tools] [tool-radius]\n'%s' is neither\n",
                 arguments[i]);
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
