// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/stripe_sequence.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string>

#include "palpate/core/error.h"

namespace palpate::sensing {
namespace {

/// Two colours that may be neighbours, in either order.
struct Pair {
  int a = 0;
  int b = 0;
};

void check_separation(const Eigen::Ref<const Eigen::MatrixXd>& separation) {
  if (separation.rows() != separation.cols() || separation.rows() < 2) {
    throw InvalidInput("stripe_sequence: separation is " + std::to_string(separation.rows()) +
                       " x " + std::to_string(separation.cols()) +
                       "; a square matrix over at least 2 colours is expected");
  }
  if (separation.hasNaN() || separation != separation.transpose()) {
    throw InvalidInput("stripe_sequence: separation must be symmetric and free of NaN");
  }
}

/// All pairs, those that are easiest to distinguish first.
std::vector<Pair> ranked_pairs(const Eigen::Ref<const Eigen::MatrixXd>& separation) {
  std::vector<Pair> pairs;
  const int colors = static_cast<int>(separation.rows());
  for (int a = 0; a < colors; ++a) {
    for (int b = a + 1; b < colors; ++b) pairs.push_back({a, b});
  }
  std::stable_sort(pairs.begin(), pairs.end(), [&](const Pair& left, const Pair& right) {
    return separation(left.a, left.b) > separation(right.a, right.b);
  });
  return pairs;
}

/// Connected sets of colours.
class Components {
 public:
  explicit Components(int colors) : parent_(static_cast<std::size_t>(colors)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  /// Connects two colours; returns whether they were not connected before.
  bool join(int a, int b) {
    const int root_a = root(a);
    const int root_b = root(b);
    parent_[static_cast<std::size_t>(root_a)] = root_b;
    return root_a != root_b;
  }

 private:
  [[nodiscard]] int root(int color) const {
    while (parent_[static_cast<std::size_t>(color)] != color)
      color = parent_[static_cast<std::size_t>(color)];
    return color;
  }
  std::vector<int> parent_;
};

/// The best `count` pairs that connect all colours: a spanning tree of the best ones (Kruskal),
/// then the best of the rest.
std::vector<Pair> choose_pairs(const Eigen::Ref<const Eigen::MatrixXd>& separation,
                               std::size_t count) {
  Components components(static_cast<int>(separation.rows()));
  std::vector<Pair> tree;
  std::vector<Pair> rest;
  for (const Pair& pair : ranked_pairs(separation)) {
    (components.join(pair.a, pair.b) ? tree : rest).push_back(pair);
  }
  const std::size_t more = count > tree.size() ? count - tree.size() : 0;
  tree.insert(tree.end(), rest.begin(),
              rest.begin() + static_cast<std::ptrdiff_t>(std::min(more, rest.size())));
  return tree;
}

/// Hierholzer's circuit from colour 0 through every pair once in each direction. It exists because
/// each colour is left as often as it is reached.
std::vector<int> eulerian_circuit(const std::vector<Pair>& pairs, int colors) {
  std::vector<std::vector<int>> unused(static_cast<std::size_t>(colors));
  for (const Pair& pair : pairs) {
    unused[static_cast<std::size_t>(pair.a)].push_back(pair.b);
    unused[static_cast<std::size_t>(pair.b)].push_back(pair.a);
  }
  std::vector<int> circuit;
  std::vector<int> path = {0};
  while (!path.empty()) {
    std::vector<int>& next = unused[static_cast<std::size_t>(path.back())];
    if (next.empty()) {
      circuit.push_back(path.back());
      path.pop_back();
    } else {
      path.push_back(next.back());
      next.pop_back();
    }
  }
  std::reverse(circuit.begin(), circuit.end());
  return circuit;
}

}  // namespace

int longest_stripe_sequence(int colors) { return colors * (colors - 1) + 1; }

std::vector<int> stripe_sequence(const Eigen::Ref<const Eigen::MatrixXd>& separation,
                                 std::optional<int> stripes) {
  check_separation(separation);
  const int colors = static_cast<int>(separation.rows());
  const int longest = longest_stripe_sequence(colors);
  if (stripes && (*stripes < 2 || *stripes > longest)) {
    throw InvalidInput("stripe_sequence: " + std::to_string(*stripes) + " stripes of " +
                       std::to_string(colors) + " colours; 2 to " + std::to_string(longest) +
                       " have every ordered pair of neighbours at most once");
  }
  const int transitions = stripes.value_or(longest) - 1;
  // Each pair gives two transitions.
  const auto wanted = static_cast<std::size_t>((transitions + 1) / 2);
  std::vector<int> sequence = eulerian_circuit(choose_pairs(separation, wanted), colors);
  sequence.resize(static_cast<std::size_t>(transitions) + 1);
  return sequence;
}

}  // namespace palpate::sensing
