// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/nested_factor.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <limits>

namespace palpate::probing {
namespace {

constexpr std::size_t kLeafNodes =
    24;                              // groups of so few nodes are not divided further: 72 unknowns
constexpr int kCandidates = 9;       // places of a cut that are compared, along each axis
constexpr double kLeastShare = 0.3;  // of the nodes on the smaller side of a cut

enum : int { kNoFront = -1 };

// Adjacency of nodes through elements, as lists of elements at each node.
std::vector<std::vector<int>> elements_at_nodes(const NestedProblem& problem) {
  std::vector<std::vector<int>> result(static_cast<std::size_t>(problem.nodes.cols()));
  for (Eigen::Index e = 0; e < problem.elements.cols(); ++e) {
    for (const int node : problem.elements.col(e))
      result[static_cast<std::size_t>(node)].push_back(static_cast<int>(e));
  }
  return result;
}

class Dissection {
 public:
  explicit Dissection(const NestedProblem& problem)
      : problem_(problem),
        at_(elements_at_nodes(problem)),
        side_(at_.size(), 0),
        front_of_(at_.size(), kNoFront) {}

  FrontTree run() {
    std::vector<bool> taken = problem_.fixed;
    for (const int node : problem_.root) taken[static_cast<std::size_t>(node)] = true;
    std::vector<int> far;
    for (std::size_t n = 0; n < taken.size(); ++n)
      if (!taken[n]) far.push_back(static_cast<int>(n));
    std::vector<int> roots;
    if (!far.empty()) roots.push_back(divide(std::move(far)));
    add(problem_.root, std::move(roots));
    find_borders();
    return std::move(tree_);
  }

 private:
  struct Cut {
    std::vector<int> low, high, between;
  };

  int add(std::vector<int> own, std::vector<int> children) {
    const int front = static_cast<int>(tree_.fronts.size());
    for (const int node : own) front_of_[static_cast<std::size_t>(node)] = front;
    tree_.fronts.push_back({std::move(own), {}, std::move(children), {}});
    return front;
  }

  int divide(std::vector<int> nodes) {
    if (nodes.size() <= kLeafNodes) return add(std::move(nodes), {});
    Cut cut = best_cut(nodes);
    if (cut.low.empty() || cut.high.empty()) return add(std::move(nodes), {});
    std::vector<int> children{divide(std::move(cut.low)), divide(std::move(cut.high))};
    return add(std::move(cut.between), std::move(children));
  }

  // The cut with the fewest nodes between its sides; the more even one of equals.
  Cut best_cut(const std::vector<int>& nodes) {
    Cut best;
    auto least = std::numeric_limits<std::size_t>::max();
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<int> sorted = nodes;
      std::sort(sorted.begin(), sorted.end(), [&](int a, int b) {
        const double u = problem_.nodes(axis, a), v = problem_.nodes(axis, b);
        return u != v ? u < v : a < b;
      });
      for (int c = 0; c < kCandidates; ++c) {
        const double share = kLeastShare + (1 - 2 * kLeastShare) * c / (kCandidates - 1);
        const auto split = static_cast<std::size_t>(share * static_cast<double>(sorted.size()));
        for (const bool from_low : {true, false}) {
          Cut cut = cut_at(sorted, split, from_low);
          const std::size_t larger = std::max(cut.low.size(), cut.high.size());
          // Nodes between are eliminated last and cost most.
          const std::size_t cost = 16 * cut.between.size() + larger;
          if (cost >= least || cut.low.empty() || cut.high.empty()) continue;
          least = cost;
          best = std::move(cut);
        }
      }
    }
    return best;
  }

  // Nodes of one side that share an element with the other side are between.
  Cut cut_at(const std::vector<int>& sorted, std::size_t split, bool from_low) {
    ++mark_;
    const int mine = 2 * mark_, other = 2 * mark_ + 1;
    for (std::size_t i = 0; i < sorted.size(); ++i)
      side_[static_cast<std::size_t>(sorted[i])] = (i < split) == from_low ? mine : other;
    Cut cut;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      const int node = sorted[i];
      const bool low = i < split;
      if (low == from_low && touches(node, other)) {
        cut.between.push_back(node);
      } else {
        (low ? cut.low : cut.high).push_back(node);
      }
    }
    return cut;
  }

  bool touches(int node, int side) const {
    for (const int e : at_[static_cast<std::size_t>(node)]) {
      for (const int neighbour : problem_.elements.col(e))
        if (side_[static_cast<std::size_t>(neighbour)] == side) return true;
    }
    return false;
  }

  void find_borders() {
    std::vector<int> order(at_.size(), -1);  // of elimination
    int next = 0;
    for (const FrontTree::Front& front : tree_.fronts)
      for (const int node : front.own) order[static_cast<std::size_t>(node)] = next++;
    for (Eigen::Index e = 0; e < problem_.elements.cols(); ++e) {
      int first = -1;
      for (const int node : problem_.elements.col(e)) {
        const int front = front_of_[static_cast<std::size_t>(node)];
        if (front != kNoFront && (first < 0 || front < first)) first = front;
      }
      if (first >= 0)
        tree_.fronts[static_cast<std::size_t>(first)].elements.push_back(static_cast<int>(e));
    }
    for (std::size_t f = 0; f < tree_.fronts.size(); ++f) {
      FrontTree::Front& front = tree_.fronts[f];
      std::vector<int> border;
      const auto take = [&](int node) {
        const int other = front_of_[static_cast<std::size_t>(node)];
        if (other > static_cast<int>(f)) border.push_back(node);
      };
      for (const int e : front.elements)
        for (const int node : problem_.elements.col(e)) take(node);
      for (const int child : front.children)
        for (const int node : tree_.fronts[static_cast<std::size_t>(child)].border) take(node);
      std::sort(border.begin(), border.end(), [&](int a, int b) {
        return order[static_cast<std::size_t>(a)] < order[static_cast<std::size_t>(b)];
      });
      border.erase(std::unique(border.begin(), border.end()), border.end());
      front.border = std::move(border);
    }
  }

  const NestedProblem& problem_;
  std::vector<std::vector<int>> at_;
  std::vector<int> side_;
  int mark_ = 0;
  std::vector<int> front_of_;
  FrontTree tree_;
};

// Adds a block of a symmetric matrix to the lower half of a front: to the columns of its own nodes,
// or behind them to the part of its border.
void add_block(const Eigen::Ref<const Eigen::Matrix3d>& block, int row, int column, int own,
               FrontFactor& front) {
  const int low = std::max(row, column), left = std::min(row, column);
  auto entries = left < own ? front.columns.block<3, 3>(3 * low, 3 * left)
                            : front.update.block<3, 3>(3 * (low - own), 3 * (left - own));
  if (row >= column) {
    entries += block;
  } else {
    entries += block.transpose();
  }
}

// Eliminates the own unknowns of a symmetric matrix, given by its lower half.
void eliminate(FrontFactor& factor, double& shift) {
  constexpr double kFirstShift = 1e-3;  // of the mean diagonal entry, added where the matrix is not
                                        // positive definite; then four times as much each time
  const Eigen::Index own = factor.columns.cols(), rest = factor.update.rows();
  if (own == 0) return;
  auto pivot = factor.columns.topRows(own);
  double added = kFirstShift * pivot.diagonal().cwiseAbs().mean();
  Eigen::LLT<Eigen::MatrixXd> cholesky(pivot);
  while (cholesky.info() != Eigen::Success && std::isfinite(added)) {
    cholesky.compute(pivot + added * Eigen::MatrixXd::Identity(own, own));
    shift = std::max(shift, added);
    added *= 4;
  }
  pivot = cholesky.matrixLLT();
  if (rest == 0) return;
  auto coupling = factor.columns.bottomRows(rest);
  pivot.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(coupling);
  factor.update.selfadjointView<Eigen::Lower>().rankUpdate(coupling, -1);
}

}  // namespace

FrontTree nested_dissection(const NestedProblem& problem) { return Dissection(problem).run(); }

void factor_fronts(const FrontTree& tree, const NestedProblem& problem,
                   const ElementTangents& tangents, NestedFactors& factors) {
  factors.fronts.resize(tree.fronts.size());
  factors.shift = 0;
  std::vector<int> place(static_cast<std::size_t>(problem.nodes.cols()), -1);
  for (int f = 0; f <= tree.root_front(); ++f) {
    const FrontTree::Front& front = tree.fronts[static_cast<std::size_t>(f)];
    int next = 0;
    for (const std::vector<int>* group : {&front.own, &front.border})
      for (const int node : *group) place[static_cast<std::size_t>(node)] = next++;
    // The root eliminates nothing.
    const int own = f == tree.root_front() ? 0 : static_cast<int>(front.own.size());
    FrontFactor& factor = factors.fronts[static_cast<std::size_t>(f)];
    factor.columns.setZero(3 * next, 3 * own);
    factor.update.setZero(3 * (next - own), 3 * (next - own));
    for (const int e : front.elements) {
      const ElementMatrix element = tangents(e);
      for (int a = 0; a < 10; ++a) {
        const int row = place[static_cast<std::size_t>(problem.elements(a, e))];
        if (row < 0) continue;
        for (int b = 0; b <= a; ++b) {
          const int column = place[static_cast<std::size_t>(problem.elements(b, e))];
          if (column >= 0) add_block(element.block<3, 3>(3 * a, 3 * b), row, column, own, factor);
        }
      }
    }
    for (const int child : front.children) {
      Eigen::MatrixXd& update = factors.fronts[static_cast<std::size_t>(child)].update;
      const std::vector<int>& border = tree.fronts[static_cast<std::size_t>(child)].border;
      for (std::size_t b = 0; b < border.size(); ++b) {
        // Borders are in the order of elimination, so that rows stay below columns.
        const int column = place[static_cast<std::size_t>(border[b])];
        const auto from = static_cast<Eigen::Index>(3 * b);
        for (std::size_t a = b; a < border.size(); ++a) {
          const int row = place[static_cast<std::size_t>(border[a])];
          add_block(update.block<3, 3>(static_cast<Eigen::Index>(3 * a), from), row, column, own,
                    factor);
        }
      }
      update.resize(0, 0);
    }
    if (f == tree.root_front()) {
      factor.update.triangularView<Eigen::StrictlyUpper>() = factor.update.transpose();
    } else {
      eliminate(factor, factors.shift);
    }
    for (const std::vector<int>* group : {&front.own, &front.border})
      for (const int node : *group) place[static_cast<std::size_t>(node)] = -1;
  }
}

void substitute_forward(const FrontTree& tree, const NestedFactors& factors,
                        Eigen::VectorXd& vector) {
  Eigen::VectorXd own, border;
  for (int f = 0; f < tree.root_front(); ++f) {
    const FrontTree::Front& front = tree.fronts[static_cast<std::size_t>(f)];
    const FrontFactor& factor = factors.fronts[static_cast<std::size_t>(f)];
    const auto n = static_cast<Eigen::Index>(3 * front.own.size());
    if (n == 0) continue;
    own.resize(n);
    for (std::size_t i = 0; i < front.own.size(); ++i)
      own.segment<3>(static_cast<Eigen::Index>(3 * i)) = vector.segment<3>(3 * front.own[i]);
    factor.columns.topRows(n).triangularView<Eigen::Lower>().solveInPlace(own);
    for (std::size_t i = 0; i < front.own.size(); ++i)
      vector.segment<3>(3 * front.own[i]) = own.segment<3>(static_cast<Eigen::Index>(3 * i));
    if (front.border.empty()) continue;
    border.noalias() = factor.columns.bottomRows(factor.columns.rows() - n) * own;
    for (std::size_t i = 0; i < front.border.size(); ++i)
      vector.segment<3>(3 * front.border[i]) -= border.segment<3>(static_cast<Eigen::Index>(3 * i));
  }
}

void substitute_backward(const FrontTree& tree, const NestedFactors& factors,
                         Eigen::VectorXd& vector) {
  Eigen::VectorXd own, border;
  for (int f = tree.root_front() - 1; f >= 0; --f) {
    const FrontTree::Front& front = tree.fronts[static_cast<std::size_t>(f)];
    const FrontFactor& factor = factors.fronts[static_cast<std::size_t>(f)];
    const auto n = static_cast<Eigen::Index>(3 * front.own.size());
    if (n == 0) continue;
    own.resize(n);
    border.resize(static_cast<Eigen::Index>(3 * front.border.size()));
    for (std::size_t i = 0; i < front.own.size(); ++i)
      own.segment<3>(static_cast<Eigen::Index>(3 * i)) = vector.segment<3>(3 * front.own[i]);
    for (std::size_t i = 0; i < front.border.size(); ++i)
      border.segment<3>(static_cast<Eigen::Index>(3 * i)) = vector.segment<3>(3 * front.border[i]);
    own.noalias() -= factor.columns.bottomRows(factor.columns.rows() - n).transpose() * border;
    factor.columns.topRows(n).triangularView<Eigen::Lower>().transpose().solveInPlace(own);
    for (std::size_t i = 0; i < front.own.size(); ++i)
      vector.segment<3>(3 * front.own[i]) = own.segment<3>(static_cast<Eigen::Index>(3 * i));
  }
}

}  // namespace palpate::probing
