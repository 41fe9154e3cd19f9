// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/attribute.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <type_traits>

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"
#include "palpate/core/require.h"

namespace palpate::geometry {
namespace {

constexpr std::array<const char*, 3> kNormalNames{"nx", "ny", "nz"};
constexpr std::array<const char*, 4> kColorNames{"red", "green", "blue", "alpha"};

/// Value of full colour intensity in the type of `values`.
double full_intensity(const AttributeValues& values) {
  return std::visit(
      [](const auto& numbers) -> double {
        using Number = typename std::decay_t<decltype(numbers)>::value_type;
        if constexpr (std::is_integral_v<Number>)
          return static_cast<double>(std::numeric_limits<Number>::max());
        else
          return 1;
      },
      values);
}

std::size_t number_count(const AttributeValues& values) {
  return std::visit([](const auto& numbers) { return numbers.size(); }, values);
}

}  // namespace

Eigen::Index element_count(const Attribute& attribute) {
  return static_cast<Eigen::Index>(attribute.list_sizes.empty() ? number_count(attribute.values)
                                                                : attribute.list_sizes.size());
}

const Attribute* find_attribute(const Attributes& attributes, std::string_view name) {
  const auto found = std::find_if(attributes.begin(), attributes.end(),
                                  [&](const Attribute& a) { return a.name == name; });
  return found == attributes.end() ? nullptr : &*found;
}

std::optional<Eigen::VectorXd> scalars(const Attributes& attributes, std::string_view name) {
  const Attribute* attribute = find_attribute(attributes, name);
  if (attribute == nullptr || !attribute->list_sizes.empty()) return std::nullopt;
  Eigen::VectorXd result(element_count(*attribute));
  std::visit(
      [&](const auto& numbers) {
        std::transform(numbers.begin(), numbers.end(), result.begin(),
                       [](auto number) { return static_cast<double>(number); });
      },
      attribute->values);
  return result;
}

std::optional<Eigen::Matrix3Xd> normals(const Attributes& attributes) {
  Eigen::Matrix3Xd result;
  for (std::size_t axis = 0; axis < kNormalNames.size(); ++axis) {
    const std::optional<Eigen::VectorXd> column = scalars(attributes, kNormalNames[axis]);
    if (!column || (axis > 0 && column->size() != result.cols())) return std::nullopt;
    if (axis == 0) result.resize(3, column->size());
    result.row(static_cast<Eigen::Index>(axis)) = column->transpose();
  }
  return result;
}

std::optional<Eigen::Matrix4Xd> colors(const Attributes& attributes) {
  Eigen::Matrix4Xd result;
  for (std::size_t channel = 0; channel < kColorNames.size(); ++channel) {
    const auto row = static_cast<Eigen::Index>(channel);
    const std::optional<Eigen::VectorXd> column = scalars(attributes, kColorNames[channel]);
    if (channel == 0 && column) result.resize(4, column->size());
    if (column && column->size() == result.cols())
      result.row(row) = column->transpose() /
                        full_intensity(find_attribute(attributes, kColorNames[channel])->values);
    else if (channel == 3)
      result.row(row).setOnes();
    else
      return std::nullopt;
  }
  return result;
}

std::optional<Eigen::Matrix<std::uint8_t, 4, Eigen::Dynamic>> color_bytes(
    const Attributes& attributes) {
  const std::optional<Eigen::Matrix4Xd> shares = colors(attributes);
  if (!shares) return std::nullopt;
  constexpr double kFull = std::numeric_limits<std::uint8_t>::max();
  return shares->unaryExpr([](double share) {
    return static_cast<std::uint8_t>(std::lround(kFull * std::min(1.0, std::max(0.0, share))));
  });
}

void set_attribute(Attributes& attributes, Attribute attribute) {
  const auto same = std::find_if(attributes.begin(), attributes.end(),
                                 [&](const Attribute& a) { return a.name == attribute.name; });
  if (same == attributes.end())
    attributes.push_back(std::move(attribute));
  else
    *same = std::move(attribute);
}

void set_normals(Attributes& attributes, const Eigen::Ref<const Eigen::Matrix3Xd>& normals) {
  for (std::size_t axis = 0; axis < kNormalNames.size(); ++axis) {
    const auto row = normals.row(static_cast<Eigen::Index>(axis));
    set_attribute(attributes,
                  {kNormalNames[axis], std::vector<double>(row.begin(), row.end()), {}});
  }
}

void set_colors(Attributes& attributes, const Eigen::Ref<const Eigen::MatrixXd>& colors) {
  if (colors.rows() != 3 && colors.rows() != 4)
    throw InvalidInput("set_colors(): colors has " + std::to_string(colors.rows()) +
                       " rows; red, green, blue and perhaps alpha are needed");
  for (Eigen::Index row = 0; row < colors.rows(); ++row) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(static_cast<std::size_t>(colors.cols()));
    for (const double value : colors.row(row)) {
      require([&] { return "set_colors(): a colour of column " + std::to_string(bytes.size()); },
              value, at_least(0).at_most(1));
      bytes.push_back(
          static_cast<std::uint8_t>(std::lround(value * std::numeric_limits<std::uint8_t>::max())));
    }
    set_attribute(attributes, {kColorNames[static_cast<std::size_t>(row)], std::move(bytes), {}});
  }
}

void check_attributes(const Attributes& attributes, Eigen::Index elements, const char* what) {
  std::set<std::string_view> names;
  for (const Attribute& attribute : attributes) {
    const auto refuse = [&](const std::string& reason) {
      throw InvalidInput(std::string(what) + ": attribute \"" + attribute.name + "\" " + reason);
    };
    std::string_view rest = attribute.name;
    if (attribute.name.empty() || next_word(rest) != attribute.name)
      refuse("needs a name that is one word");
    if (!names.insert(attribute.name).second) refuse("is there twice");
    std::size_t numbers = attribute.list_sizes.empty() ? number_count(attribute.values) : 0;
    for (const int size : attribute.list_sizes) {
      if (size < 0) refuse("has a list of size " + std::to_string(size));
      numbers += static_cast<std::size_t>(size);
    }
    if (numbers != number_count(attribute.values))
      refuse("has " + std::to_string(number_count(attribute.values)) +
             " numbers, but its lists are of " + std::to_string(numbers));
    if (element_count(attribute) != elements)
      refuse("has values of " + std::to_string(element_count(attribute)) + " elements; there are " +
             std::to_string(elements));
  }
}

}  // namespace palpate::geometry
