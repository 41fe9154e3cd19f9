// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_selection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "base/numbers.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

void check_cloud(const PointCloud& cloud) {
  if (cloud.width * cloud.height != cloud.points.cols())
    throw InvalidInput("point cloud: is " + std::to_string(cloud.width) + " x " +
                       std::to_string(cloud.height) + ", but has " +
                       std::to_string(cloud.points.cols()) + " points");
  check_attributes(cloud.attributes, cloud.points.cols(), "point cloud");
}

void check_indices(std::span<const int> indices, Eigen::Index points, int lowest) {
  for (const int i : indices) {
    if (i < lowest || i >= points)
      throw InvalidInput("point cloud: there is no " + std::to_string(i) + " among " +
                         std::to_string(points));
  }
}

/// The elements of a list at `indices`; of attributes with lists, their lists.
Attribute chosen(const Attribute& attribute, std::span<const int> indices) {
  Attribute result{.name = attribute.name, .values = {}, .list_sizes = {}};
  const bool has_lists = !attribute.list_sizes.empty();
  std::vector<std::size_t> begin;
  if (has_lists) {
    begin.resize(attribute.list_sizes.size());
    std::exclusive_scan(attribute.list_sizes.begin(), attribute.list_sizes.end(), begin.begin(),
                        std::size_t{0});
  }
  std::visit(
      [&](const auto& values) {
        std::remove_cvref_t<decltype(values)> kept;
        kept.reserve(indices.size());
        for (const int index : indices) {
          const auto i = static_cast<std::size_t>(index);
          if (!has_lists) {
            kept.push_back(values[i]);
            continue;
          }
          const int size = attribute.list_sizes[i];
          result.list_sizes.push_back(size);
          const auto first = values.begin() + static_cast<std::ptrdiff_t>(begin[i]);
          kept.insert(kept.end(), first, first + size);
        }
        result.values = std::move(kept);
      },
      attribute.values);
  return result;
}

/// Means of the known values of each group, in their type; NaN if none is known.
Attribute mean_of_groups(const Attribute& attribute, std::span<const int> group,
                         std::size_t groups) {
  Attribute result{.name = attribute.name, .values = {}, .list_sizes = {}};
  std::visit(
      [&](const auto& values) {
        using Value = typename std::remove_cvref_t<decltype(values)>::value_type;
        std::vector<double> sums(groups, 0), count(groups, 0);
        for (std::size_t i = 0; i < group.size(); ++i) {
          const auto value = static_cast<double>(values[i]);
          if (group[i] == kNone || std::isnan(value)) continue;
          sums[static_cast<std::size_t>(group[i])] += value;
          ++count[static_cast<std::size_t>(group[i])];
        }
        std::vector<Value> means(groups);
        for (std::size_t g = 0; g < sums.size(); ++g) {
          const double mean = sums[g] / count[g];
          // A mean of 64-bit integers may round to just above the largest.
          if constexpr (std::is_integral_v<Value>)
            means[g] = mean >= static_cast<double>(std::numeric_limits<Value>::max())
                           ? std::numeric_limits<Value>::max()
                           : static_cast<Value>(std::round(mean));
          else
            means[g] = static_cast<Value>(mean);
        }
        result.values = std::move(means);
      },
      attribute.values);
  return result;
}

void normalise_normals(Attributes& attributes) {
  std::optional<Eigen::Matrix3Xd> mean = normals(attributes);
  if (!mean) return;
  // Opposite normals have no mean.
  constexpr double kCancelled = 1e-6;
  for (auto normal : mean->colwise())
    normal = normal.norm() > kCancelled ? Eigen::Vector3d(normal.normalized())
                                        : Eigen::Vector3d(Eigen::Vector3d::Constant(kNan));
  set_normals(attributes, *mean);
}

/// Returns true if all clouds have an attribute of this name and type, without lists.
bool all_have(std::span<const PointCloud> clouds, const Attribute& wanted) {
  return std::all_of(clouds.begin(), clouds.end(), [&](const PointCloud& cloud) {
    const Attribute* const found = find_attribute(cloud.attributes, wanted.name);
    return found != nullptr && found->values.index() == wanted.values.index() &&
           found->list_sizes.empty();
  });
}

void append(Attribute& to, const Attribute& from) {
  std::visit(
      [&](auto& values) {
        const auto& more = std::get<std::remove_cvref_t<decltype(values)>>(from.values);
        values.insert(values.end(), more.begin(), more.end());
      },
      to.values);
}

}  // namespace

std::vector<int> points_in_box(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                               const Eigen::AlignedBox3d& box) {
  std::vector<int> inside;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (points.col(i).allFinite() && box.contains(points.col(i)))
      inside.push_back(static_cast<int>(i));
  }
  return inside;
}

PointCloud selected(const PointCloud& cloud, std::span<const int> indices) {
  check_cloud(cloud);
  check_indices(indices, cloud.points.cols(), 0);
  PointCloud result;
  result.points.resize(3, static_cast<Eigen::Index>(indices.size()));
  for (std::size_t i = 0; i < indices.size(); ++i)
    result.points.col(static_cast<Eigen::Index>(i)) = cloud.points.col(indices[i]);
  result.width = result.points.cols();
  for (const Attribute& attribute : cloud.attributes)
    result.attributes.push_back(chosen(attribute, indices));
  result.comments = cloud.comments;
  result.unit = cloud.unit;
  return result;
}

PointCloud with_only(const PointCloud& cloud, std::span<const int> indices) {
  check_cloud(cloud);
  check_indices(indices, cloud.points.cols(), 0);
  PointCloud result = cloud;
  result.points.setConstant(kNan);
  for (const int i : indices) result.points.col(i) = cloud.points.col(i);
  return result;
}

PointCloud averaged(const PointCloud& cloud, std::span<const int> group,
                    const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  check_cloud(cloud);
  if (static_cast<Eigen::Index>(group.size()) != cloud.points.cols())
    throw InvalidInput("point cloud: " + std::to_string(cloud.points.cols()) + " points, but " +
                       std::to_string(group.size()) + " have a group");
  check_indices(group, points.cols(), kNone);
  std::vector<int> count(static_cast<std::size_t>(points.cols()), 0);
  for (const int g : group) {
    if (g != kNone) ++count[static_cast<std::size_t>(g)];
  }
  if (const auto empty = std::find(count.begin(), count.end(), 0); empty != count.end())
    throw InvalidInput("point cloud: no point is in group " +
                       std::to_string(empty - count.begin()));
  PointCloud result;
  result.points = points;
  result.width = points.cols();
  for (const Attribute& attribute : cloud.attributes) {
    if (attribute.list_sizes.empty())
      result.attributes.push_back(mean_of_groups(attribute, group, count.size()));
  }
  normalise_normals(result.attributes);
  result.comments = cloud.comments;
  result.unit = cloud.unit;
  return result;
}

PointCloud joined(std::span<const PointCloud> clouds) {
  if (clouds.empty()) throw InvalidInput("point clouds: there is none to join");
  for (const PointCloud& cloud : clouds) check_cloud(cloud);
  if (clouds.size() == 1) return clouds.front();
  PointCloud result;
  result.comments = clouds.front().comments;
  result.unit = clouds.front().unit;
  for (const Attribute& attribute : clouds.front().attributes) {
    if (all_have(clouds, attribute)) result.attributes.push_back(attribute);
  }
  for (const PointCloud& cloud : clouds) result.width += cloud.points.cols();
  result.points.resize(3, result.width);
  Eigen::Index begin = 0;
  for (const PointCloud& cloud : clouds) {
    result.points.middleCols(begin, cloud.points.cols()) = cloud.points;
    begin += cloud.points.cols();
    if (&cloud == &clouds.front()) continue;
    for (Attribute& attribute : result.attributes)
      append(attribute, *find_attribute(cloud.attributes, attribute.name));
  }
  return result;
}

}  // namespace palpate::geometry
