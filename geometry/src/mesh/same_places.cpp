// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mesh/same_places.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <utility>

namespace palpate::geometry {

std::vector<int> first_at_same_place(const Eigen::Matrix3Xd& vertices) {
  std::vector<int> order(static_cast<std::size_t>(vertices.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::vector<int> place = order;
  std::erase_if(order, [&](int v) { return !vertices.col(v).allFinite(); });
  const auto key = [&](int v) {
    return std::array{vertices(0, v), vertices(1, v), vertices(2, v)};
  };
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (key(order[i]) == key(order[i - 1]))
      place[static_cast<std::size_t>(order[i])] = place[static_cast<std::size_t>(order[i - 1])];
  }
  return place;
}

}  // namespace palpate::geometry
