// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/texture.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "mesh/same_places.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

constexpr const char* kCoordinates = "texcoord";
constexpr const char* kNumber = "texnumber";
constexpr int kListSize = 6;

/// A triangle by its corners in ascending order.
struct NamedTriangle {
  std::array<int, 3> corners;
  int triangle;
};

std::array<int, 3> ascending(const Eigen::Vector3i& corners) {
  std::array<int, 3> sorted = {corners[0], corners[1], corners[2]};
  std::ranges::sort(sorted);
  return sorted;
}

std::vector<NamedTriangle> sorted_triangles(const Eigen::Matrix3Xi& triangles) {
  std::vector<NamedTriangle> sorted;
  for (int t = 0; t < static_cast<int>(triangles.cols()); ++t)
    sorted.push_back({.corners = ascending(triangles.col(t)), .triangle = t});
  std::ranges::stable_sort(sorted, {}, &NamedTriangle::corners);
  return sorted;
}

}  // namespace

std::optional<CornerTexture> corner_texture(const Attributes& triangle_attributes) {
  const Attribute* lists = find_attribute(triangle_attributes, kCoordinates);
  if (lists != nullptr && lists->list_sizes.empty()) lists = nullptr;
  const std::optional<Eigen::VectorXd> number = scalars(triangle_attributes, kNumber);
  if (lists == nullptr && !number) return std::nullopt;
  CornerTexture texture;
  if (number) texture.number = number->cast<int>();
  texture.coordinates.setConstant(kListSize,
                                  lists != nullptr ? element_count(*lists) : texture.number.size(),
                                  std::numeric_limits<double>::quiet_NaN());
  if (lists == nullptr) return texture;
  std::visit(
      [&](const auto& numbers) {
        std::size_t first = 0;
        for (Eigen::Index t = 0; t < texture.coordinates.cols(); ++t) {
          const int size = lists->list_sizes[static_cast<std::size_t>(t)];
          for (int i = 0; i < kListSize && size == kListSize; ++i)
            texture.coordinates(i, t) =
                static_cast<double>(numbers[first + static_cast<std::size_t>(i)]);
          first += static_cast<std::size_t>(size);
        }
      },
      lists->values);
  return texture;
}

void set_corner_texture(Attributes& triangle_attributes, const CornerTexture& texture) {
  std::vector<int> sizes;
  std::vector<double> numbers;
  for (const auto& corners : texture.coordinates.colwise()) {
    const bool is_known = corners.allFinite();
    sizes.push_back(is_known ? kListSize : 0);
    if (is_known) numbers.insert(numbers.end(), corners.begin(), corners.end());
  }
  if (!numbers.empty()) {
    Attribute lists{.name = kCoordinates, .values = {}, .list_sizes = std::move(sizes)};
    if (std::ranges::all_of(numbers, [](double x) { return double{static_cast<float>(x)} == x; }))
      lists.values = std::vector<float>(numbers.begin(), numbers.end());
    else
      lists.values = std::move(numbers);
    set_attribute(triangle_attributes, std::move(lists));
  }
  if (texture.number.size() == 0) return;
  set_attribute(triangle_attributes,
                {.name = kNumber,
                 .values = std::vector<std::int32_t>(texture.number.begin(), texture.number.end()),
                 .list_sizes = {}});
}

CornerTexture carried_texture(const CornerTexture& texture, const TriangleMesh& before,
                              const TriangleMesh& after, std::span<const int> source) {
  if (texture.coordinates.cols() != before.triangles.cols() ||
      static_cast<Eigen::Index>(source.size()) != after.vertices.cols())
    throw InvalidInput(
        "carried_texture: the texture has " + std::to_string(texture.coordinates.cols()) +
        " triangles of " + std::to_string(before.triangles.cols()) + ", and source " +
        std::to_string(source.size()) + " vertices of " + std::to_string(after.vertices.cols()));
  const bool has_numbers = texture.number.size() > 0;
  // Repair joins vertices at the same place. Corners of a defective mesh may be no vertices.
  const std::vector<int> place = first_at_same_place(before.vertices);
  const auto joined = [&](int v) {
    return v >= 0 && v < before.vertices.cols() ? place[static_cast<std::size_t>(v)] : v;
  };
  const Eigen::Matrix3Xi joined_before = before.triangles.unaryExpr(joined);
  const std::vector<NamedTriangle> former = sorted_triangles(joined_before);
  CornerTexture carried;
  carried.coordinates.setConstant(kListSize, after.triangles.cols(),
                                  std::numeric_limits<double>::quiet_NaN());
  if (has_numbers) carried.number.setConstant(after.triangles.cols(), -1);
  for (Eigen::Index t = 0; t < after.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = after.triangles.col(t).unaryExpr(
        [&](int v) { return joined(source[static_cast<std::size_t>(v)]); });
    const std::array<int, 3> name = ascending(corners);
    const auto found = std::ranges::lower_bound(former, name, {}, &NamedTriangle::corners);
    if (found == former.end() || found->corners != name) continue;
    const Eigen::Vector3i as_before = joined_before.col(found->triangle);
    for (int k = 0; k < 3; ++k) {
      const auto corner = std::find(as_before.begin(), as_before.end(), corners[k]);
      carried.coordinates.block<2, 1>(2 * k, t) =
          texture.coordinates.block<2, 1>(2 * (corner - as_before.begin()), found->triangle);
    }
    if (has_numbers) carried.number[t] = texture.number[found->triangle];
  }
  return carried;
}

}  // namespace palpate::geometry
