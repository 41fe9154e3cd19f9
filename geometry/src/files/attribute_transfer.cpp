// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/attribute_transfer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

bool is_color(std::string_view name) {
  return name == "red" || name == "green" || name == "blue" || name == "alpha";
}

Attribute selected(const Attribute& attribute, std::span<const int> elements) {
  Attribute result{.name = attribute.name, .values = {}, .list_sizes = {}};
  std::vector<std::size_t> first = {0};  // number of each list
  for (const int size : attribute.list_sizes)
    first.push_back(first.back() + static_cast<std::size_t>(size));
  std::visit(
      [&](const auto& numbers) {
        std::decay_t<decltype(numbers)> chosen;
        for (const int element : elements) {
          const auto i = static_cast<std::size_t>(element);
          if (attribute.list_sizes.empty()) {
            chosen.push_back(numbers[i]);
            continue;
          }
          result.list_sizes.push_back(attribute.list_sizes[i]);
          const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(first[i]);
          chosen.insert(chosen.end(), begin, begin + attribute.list_sizes[i]);
        }
        result.values = std::move(chosen);
      },
      attribute.values);
  return result;
}

int nearest_corner(const SurfacePoint& place) {
  Eigen::Index k = 0;
  place.barycentric.maxCoeff(&k);
  return static_cast<int>(k);
}

/// A mean of the known corners; the value of the nearest corner if that is NaN.
template <typename Number>
Number mean_at(const std::vector<Number>& numbers, const TriangleMesh& mesh,
               const SurfacePoint& place) {
  const auto at = [&](int k) {
    return numbers[static_cast<std::size_t>(mesh.triangles(k, place.triangle))];
  };
  const Number nearest = at(nearest_corner(place));
  double sum = 0, weights = 0;
  for (int k = 0; k < 3; ++k) {
    const auto number = static_cast<double>(at(k));
    const double weight = std::max(0.0, place.barycentric[k]);
    if (std::isnan(number) || weight == 0) continue;
    sum += weight * number;
    weights += weight;
  }
  if constexpr (std::is_integral_v<Number>) {
    return static_cast<Number>(std::round(sum / weights));
  } else {
    return std::isnan(nearest) ? nearest : static_cast<Number>(sum / weights);
  }
}

Attribute interpolated(const Attribute& attribute, const TriangleMesh& mesh,
                       std::span<const SurfacePoint> places) {
  Attribute result{.name = attribute.name, .values = {}, .list_sizes = {}};
  std::visit(
      [&](const auto& numbers) {
        std::decay_t<decltype(numbers)> means;
        for (const SurfacePoint& place : places) means.push_back(mean_at(numbers, mesh, place));
        result.values = std::move(means);
      },
      attribute.values);
  return result;
}

}  // namespace

Attributes selected_attributes(const Attributes& attributes, std::span<const int> elements) {
  Attributes result;
  for (const Attribute& attribute : attributes) {
    const Eigen::Index count = element_count(attribute);
    for (const int element : elements) {
      if (element >= 0 && element < count) continue;
      throw InvalidInput("selected_attributes: element " + std::to_string(element) +
                         " is not one of the " + std::to_string(count) + " of " + attribute.name);
    }
    result.push_back(selected(attribute, elements));
  }
  return result;
}

Attributes interpolated_attributes(const Attributes& attributes, const TriangleMesh& mesh,
                                   std::span<const SurfacePoint> places) {
  check_attributes(attributes, mesh.vertices.cols(), "interpolated_attributes");
  std::vector<int> nearest;
  for (const SurfacePoint& place : places) {
    check_surface_point(mesh, place, "interpolated_attributes");
    nearest.push_back(mesh.triangles(nearest_corner(place), place.triangle));
  }
  Attributes result;
  for (const Attribute& attribute : attributes) {
    const bool is_real = std::visit(
        [](const auto& numbers) {
          return std::is_floating_point_v<typename std::decay_t<decltype(numbers)>::value_type>;
        },
        attribute.values);
    const bool is_linear = attribute.list_sizes.empty() && (is_real || is_color(attribute.name));
    result.push_back(is_linear ? interpolated(attribute, mesh, places)
                               : selected(attribute, nearest));
  }
  return result;
}

}  // namespace palpate::geometry
