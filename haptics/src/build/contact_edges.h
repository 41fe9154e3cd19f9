// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// [mm] Lengths of the three edges of each triangle of contacts.
[[nodiscard]] inline std::vector<double> contact_edge_lengths(const Model& model) {
  const auto position = [&](int i) { return model.contacts[static_cast<std::size_t>(i)].position; };
  std::vector<double> lengths;
  for (const auto& t : model.triangles.colwise()) {
    for (int k = 0; k < 3; ++k)
      lengths.push_back((position(t[k]) - position(t[(k + 1) % 3])).norm());
  }
  return lengths;
}

}  // namespace palpate::haptics
