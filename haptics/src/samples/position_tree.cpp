// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "samples/position_tree.h"

// Boost 1.74 itself includes a header that it calls deprecated, and says so in every build.
#define BOOST_ALLOW_DEPRECATED_HEADERS
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#undef BOOST_ALLOW_DEPRECATED_HEADERS
#include <boost/iterator/function_output_iterator.hpp>
#include <limits>
#include <utility>

namespace palpate::haptics {
namespace {

namespace bgi = boost::geometry::index;
using TreePoint = boost::geometry::model::point<double, 3, boost::geometry::cs::cartesian>;
using TreeValue = std::pair<TreePoint, std::size_t>;
constexpr std::size_t kMostInNode = 16;
// Distances are rounded otherwise than those that callers compute; relative.
constexpr double kDistanceRounding = 1e-9;
using Tree = bgi::rtree<TreeValue, bgi::linear<kMostInNode>>;

TreePoint tree_point(const Eigen::Vector3d& at) { return {at.x(), at.y(), at.z()}; }

std::vector<TreeValue> tree_values(const Eigen::Matrix3Xd& positions) {
  std::vector<TreeValue> values;
  for (Eigen::Index i = 0; i < positions.cols(); ++i)
    values.emplace_back(tree_point(positions.col(i)), static_cast<std::size_t>(i));
  return values;
}

}  // namespace

struct PositionTree::Impl {
  Tree tree;

  template <typename Predicates>
  [[nodiscard]] std::vector<std::size_t> found(const Predicates& predicates) const {
    std::vector<std::size_t> result;
    tree.query(predicates, boost::make_function_output_iterator(
                               [&](const TreeValue& value) { result.push_back(value.second); }));
    return result;
  }
};

PositionTree::PositionTree(const Eigen::Matrix3Xd& positions)
    : impl_(std::make_unique<const Impl>(Impl{Tree(tree_values(positions))})) {}
PositionTree::~PositionTree() = default;

std::vector<std::size_t> PositionTree::nearest(
    const Eigen::Vector3d& place, std::size_t count,
    const std::function<bool(std::size_t)>& is_wanted) const {
  const auto wanted =
      bgi::satisfies([&](const TreeValue& value) { return is_wanted(value.second); });
  return impl_->found(bgi::nearest(tree_point(place), static_cast<unsigned>(count)) && wanted);
}

std::vector<std::size_t> PositionTree::in_cube(const Eigen::Vector3d& place, double reach) const {
  const Eigen::Vector3d corner = Eigen::Vector3d::Constant((1 + kDistanceRounding) * reach +
                                                           std::numeric_limits<double>::min());
  return impl_->found(bgi::intersects(boost::geometry::model::box<TreePoint>(
      tree_point(place - corner), tree_point(place + corner))));
}

}  // namespace palpate::haptics
